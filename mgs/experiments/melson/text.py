"""Text of measured values of the scenarios."""

from __future__ import annotations


def show(values: dict[str, float], unit: str, digits: int = 3) -> str:
    """Values of the scenarios, such as "S1 1.000, S2 0.900, S3 0.800 N m"."""
    return ", ".join(f"{name} {value:.{digits}f}" for name, value in values.items()) + f" {unit}"


def below(values: dict[str, float]) -> dict[str, float]:
    """Relative reduction of the value of S3 below those of S1 and S2."""
    return {name: 1.0 - values["S3"] / values[name] for name in ("S1", "S2")}


def show_below(values: dict[str, float]) -> str:
    """Differences in per cent, such as "26.2 % below S1, 0.1 % above S2"."""
    return ", ".join(
        f"{abs(100.0 * part):.1f} % {'below' if part >= 0.0 else 'above'} {name}"
        for name, part in below(values).items()
    )
