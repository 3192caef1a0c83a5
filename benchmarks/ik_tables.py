"""Markdown tables of the results of `ik_methods.py`."""

from __future__ import annotations

from typing import Any

from tables import table

from mgs.core.plugins import IK_SOLVERS


def report(figures: dict[str, Any]) -> str:
    """All tables of the results."""
    found = figures["machine"]
    head = (
        f"{found['cores']} cores, {found['architecture']}, Python {found['python']}, NumPy "
        f"{found['numpy']}, SciPy {found['scipy']}, Pinocchio {found['pin']}; "
        f"{figures['rounds']} rounds, BLAS threads: {found['blas_threads']}."
    )
    sections = [head, _solvers(figures["solvers"]), _same(figures["same_problem"])]
    return "\n\n".join([*sections, _pink(figures["pink"], figures["solvers"])])


def _us(seconds: float) -> str:
    return f"{1e6 * seconds:.0f}"


def _solvers(found: dict[str, Any]) -> str:
    header, names = ["time per solve [us]"], list(found)
    for name in names:
        freedom = found[name]["freedom"]
        header += [f"{name} ({freedom} DoF): minimum", "median", "p99", "iterations"]
    labels: list[str] = []
    for name in names:
        labels += [label for label in found[name]["times"] if label not in labels]
    rows, notes = [], []
    for label in sorted(
        labels, key=lambda label: list(IK_SOLVERS.own).index(label.partition(",")[0])
    ):
        row = [label]
        for name in names:
            times = found[name]["times"].get(label)
            if times is None:
                row += ["-"] * 4
                continue
            spread_of = times["single"] or times["run_mean"]
            row += [_us(spread_of["least"]), _us(spread_of["median"])]
            single = times["single"] is not None
            row += [_us(spread_of["p99"]) if single else "-"]
            row += [f"{times['iterations']:.1f}" if single else "-"]
        rows.append(row)
    for name in names:
        notes += [f"{label} on {name} {note}." for label, note in found[name]["notes"].items()]
    text = (
        "Times of ik1 to ik5 are those of single solves; times of the others, without p99, are "
        "the time of a whole solve divided by the samples."
    )
    return f"{table(header, rows)}\n\n{' '.join([text, *notes])}"


def _same(found: dict[str, Any]) -> str:
    header = [
        "solver of the ik4 problem", "minimum [ms]", "median [ms]", "p99 [ms]",
        "time / time of ik4, n = 3",
        "ratio in the best round", "iterations: median, maximum", "slack [mm]",
        "slack minus slack of ik4 [um]: minimum", "median",
        "maximum", "hard-row error [um, urad]", "region excess",
    ]  # fmt: skip
    rows = []
    for name, way in found["ways"].items():
        seconds, (iterations, most) = way["seconds"], way["iterations"]
        rows.append(
            [
                name,
                *(f"{1e3 * seconds[key]:.3f}" for key in ("least", "median", "p99")),
                f"{way['ratio']:.1f}",
                f"{way['ratio_of_best']:.1f}",
                f"{iterations:g}, {most}",
                f"{1e3 * way['slack']:.3f}",
                *(f"{1e6 * gap:.2f}" for gap in way["gap"]),
                f"{1e6 * way['hard_error']:.2g}",
                f"{way['region_excess']:.1g}",
            ]
        )
    text = (
        f"{found['gait']}, {found['samples']} samples, {found['stretched']} of them close to a "
        "stretched knee. Slack and iterations are medians; hard-row error and region excess are "
        "those of the worst sample."
    )
    missing = f" Ipopt: {found['missing']}." if found["missing"] else ""
    return f"{table(header, rows)}\n\n{text}{missing}"


def _pink(found: dict[str, Any] | str, solvers: dict[str, Any]) -> str:
    if isinstance(found, str):
        return f"pink: {found}."
    rows = []
    for name, pink in found.items():
        for label, ratio in pink["ratio"].items():
            times = solvers[name]["times"][label]["run_mean"]
            cells = [_us(times["least"]), _us(times["median"]), f"{ratio:.2f}"]
            rows.append([f"{name}: mgs {label}", *cells])
        times = pink["run_mean"]
        label = f"{name}: pink {pink['version']}"
        rows.append([label, _us(times["least"]), _us(times["median"]), "1.00"])
    errors = ", ".join(
        f"{name}: soles {1e6 * pink['sole_error']:.0f} um, CoM {1e3 * pink['com_error']:.2f} mm"
        for name, pink in found.items()
    )
    ratio_column = "time of pink / time in this row"
    header = ["mean step of a run [us]", "minimum", "median", ratio_column]
    return f"{table(header, rows)}\n\nLargest errors of pink after a step: {errors}."
