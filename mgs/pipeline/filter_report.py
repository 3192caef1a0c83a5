"""How far the whole robot's ZMP is from the planned one, before and after the dynamic filter."""

from __future__ import annotations

from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class ZmpError:
    """Distance of the whole robot's ZMP from the planned one over a motion [m]."""

    mean: float
    max: float


@dataclass(frozen=True)
class FilterReport:
    """What the dynamic filter found in its first pass, and what its best pass leaves."""

    before: ZmpError
    after: ZmpError
    passes: int  # corrections that are part of the motion

    def to_dict(self) -> dict[str, object]:
        """The report as plain data."""
        return asdict(self)
