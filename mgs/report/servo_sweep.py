"""The map of a servo sweep: sag of PD servos against friction, what passes and what fails."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mgs.judge.servo_cases import Outcome, ServoSweep
from mgs.report.canvas import (
    GREEN,
    ORANGE,
    TICK,
    VERMILION,
    legend_above,
    new_figure,
    style_axes,
)

KINDS = {  # label: marker and colour
    "passes": ("o", GREEN),
    "stays up, fails a check": ("v", ORANGE),
    "falls": ("x", VERMILION),
}


def plot_servo_sweep(sweeps: Sequence[ServoSweep], title: str = "") -> Figure:
    """One row of maps for each engine, one map for each kind of commands."""
    columns = list(
        dict.fromkeys(o.case.assumed_stiffness for sweep in sweeps for o in sweep.outcomes)
    )
    figure = new_figure(3.2 * max(len(columns), 1) + 0.4, 1.9 * max(len(sweeps), 1) + 0.9)
    grid = figure.subplots(
        max(len(sweeps), 1), max(len(columns), 1), squeeze=False, sharex=True, sharey=True
    )
    for sweep, row in zip(sweeps, grid, strict=False):
        for assumed, axes in zip(columns, row, strict=True):
            outcomes = [o for o in sweep.outcomes if o.case.assumed_stiffness == assumed]
            _draw(axes, outcomes, f"{sweep.engine}, {_commands(assumed)}", axes is row[0])
    for axes in grid[-1]:
        axes.set_xlabel("sag at stall torque [deg]")
    figure.suptitle(f"{title}: plain PD servos" if title else "Plain PD servos", fontsize=10)
    legend_above(figure, grid.flat, columns=3)
    return figure


def _commands(assumed: float | None) -> str:
    return "planned angles" if assumed is None else f"feed-forward, {assumed:g} of stiffness"


def _draw(axes: Axes, outcomes: Sequence[Outcome], title: str, is_first: bool) -> None:
    style_axes(axes, title=title, ylabel="friction" if is_first else "")
    groups: dict[str, list[Outcome]] = {kind: [] for kind in KINDS}
    for outcome in outcomes:
        groups[_kind(outcome)].append(outcome)
    for kind, (marker, colour) in KINDS.items():
        axes.plot(
            [o.case.sag_deg for o in groups[kind]],
            [o.case.friction for o in groups[kind]],
            marker,
            color=colour,
            label=kind,
            linestyle="none",
        )
    sags = sorted({o.case.sag_deg for o in outcomes})
    frictions = sorted({o.case.friction for o in outcomes})
    axes.set_xscale("log")
    axes.set_xticks(sags, [f"{sag:g}" for sag in sags], fontsize=TICK)
    axes.set_xticks([], minor=True)
    axes.set_yticks(frictions, [f"{friction:g}" for friction in frictions], fontsize=TICK)
    axes.margins(0.12, 0.25)


def _kind(outcome: Outcome) -> str:
    if not outcome.failed:
        return "passes"
    return "falls" if outcome.fell else "stays up, fails a check"
