"""Picture and page of a search for the parameters of a walk: before, after, and what mattered."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mgs.report.canvas import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    TICK,
    legend_above,
    new_figure,
    style_axes,
)
from mgs.robot import leg_length
from mgs.search.tune.compare import Assessment
from mgs.search.tune.evaluate import STAGES, Column
from mgs.search.tune.objective import UNITS, froude_number
from mgs.search.tune.space import value_at
from mgs.search.tune.study import Search

N_REASONS = 3  # of failure that the page names for each stage
ROWS = {  # figure of a plan: words, factor, digits
    "speed": ("speed [m/s]", 1.0, 4),
    "zmp_margin": ("least ZMP margin [mm]", 1e3, 3),
    "clearance": ("least height of the swing sole at its highest [mm]", 1e3, 3),
    "cost_of_transport": ("cost of transport", 1.0, 3),
    "positive_work": ("positive joint work [J]", 1.0, 3),
    "torque_rms": ("RMS of all joint torques together [N m]", 1.0, 3),
    "duration": ("duration [s]", 1.0, 4),
}


def plot_tuning(search: Search) -> Figure:
    """Draw the score of every walk in the order of the search, and the importance of each key."""
    figure = new_figure(9.0, 4.2)
    left, right = figure.subplots(1, 2, width_ratios=(1.35, 1.0))
    _draw_scores(left, search)
    _draw_importance(right, search)
    legend_above(figure, [left], columns=4)
    return figure


def _draw_scores(axes: Axes, search: Search) -> None:
    unit = UNITS[search.task.objective]
    style_axes(axes, title="walks of the search", xlabel="walk", ylabel=f"score: {unit}")
    trials = [t for t in search.trials if t.found.stage != STAGES[0]]
    passed = [t for t in trials if t.found.passed]
    pruned = [t for t in trials if t.found.pruned]
    failed = [t for t in trials if not t.found.passed and not t.found.pruned]
    low = -0.12 * max((t.found.score for t in [*passed, *pruned]), default=1.0)
    for kind, marker, colour, label in (
        (passed, "o", GREEN, "passes"),
        (pruned, ".", ORANGE, "given up: not the best"),
    ):
        xy = [(t.number, t.found.score) for t in kind]
        axes.plot(*_columns(xy), marker, color=colour, linestyle="none", markersize=4, label=label)
    xy = [(t.number, low) for t in failed]
    axes.plot(*_columns(xy), "x", color=FAINT, linestyle="none", markersize=4, label="fails")
    if passed:
        numbers = [t.number for t in passed]
        best = np.maximum.accumulate([t.found.score for t in passed])
        axes.step(numbers, best, color=INK, linewidth=1.0, where="post", label="best so far")
    axes.set_ylim(bottom=1.6 * low)


def _columns(xy: list[tuple[int, float]]) -> tuple[list[int], list[float]]:
    return [x for x, _ in xy], [y for _, y in xy]


def _draw_importance(axes: Axes, search: Search) -> None:
    style_axes(axes, title="importance of the parameters for the score", xlabel="part of the sum")
    items = sorted(search.importance.items(), key=lambda item: item[1])
    axes.barh([key for key, _ in items], [value for _, value in items], color=BLUE, height=0.65)
    axes.tick_params(axis="y", labelsize=TICK)
    if not items:
        axes.set(xticks=[], yticks=[])
        axes.text(0.5, 0.5, "too few walks", transform=axes.transAxes, ha="center", color=FAINT)


def tuning_page(
    search: Search, before: Assessment, after: Assessment, title: str, picture: str
) -> str:
    """Page in Markdown: before and after, the values that were varied, and what failed.

    Args:
        search: the search.
        before: the start gait.
        after: the best walk.
        title: heading of the page.
        picture: file of the picture, relative to the page.
    """
    task = search.task
    minutes = sum(trial.seconds for trial in search.trials) / 60.0
    lines = [
        f"# {title}",
        "",
        f"Objective: {task.objective} ({UNITS[task.objective]}). {len(search.trials)} walks were "
        f"judged in {minutes:.1f} min of one process. Random conditions of the search: "
        f"{task.n_draws} draws of `{task.ranges}` in each column, seed {task.seed}; the rates "
        "below are of other draws.",
        "",
        f"![Scores of all walks and importance of the parameters]({picture})",
        "",
        "## Before and after",
        "",
        "| figure | before | after |",
        "| --- | ---: | ---: |",
        *(f"| {name} | {a} | {b} |" for name, a, b in comparison(search, before, after)),
        "",
        "## Values",
        "",
        "| key | before | after | searched | importance |",
        "| --- | ---: | ---: | --- | ---: |",
        *_value_rows(search, before, after),
        "",
        "Importance is that of PED-ANOVA: the part of the variance of the score, among the better "
        "walks, that goes with one parameter alone.",
        "",
        "## Where walks failed",
        "",
        "| stage | walks | most frequent reasons |",
        "| --- | ---: | --- |",
        *_stage_rows(search),
    ]
    return "\n".join(lines) + "\n"


def comparison(
    search: Search, before: Assessment, after: Assessment
) -> Iterator[tuple[str, str, str]]:
    """Rows of the comparison: name, figure before, figure after."""
    return ((name, told(before), told(after)) for name, told in _rows(search).items())


def _rows(search: Search) -> dict[str, Callable[[Assessment], str]]:
    """Names of figures, and how each one is told."""
    task, leg = search.task, leg_length(search.task.robot)
    rows: dict[str, Callable[[Assessment], str]] = {
        "all nominal replays pass": lambda found: "yes" if found.passed else "no"
    }
    for name, (words, factor, digits) in ROWS.items():
        rows[words] = partial(_figure, name=name, factor=factor, digits=digits)
    rows["Froude number"] = lambda found: (
        f"{froude_number(found.figures['speed'], leg):.3g}" if found.figures else "-"
    )
    for engine in sorted(task.engines):
        rows[f"PD replays that pass, {engine}"] = partial(_pd_passed, engine=engine)
        if "model" in task.servos:
            words = f"replays with wrong feed-forward that pass, {engine}"
            rows[words] = partial(_wrong_passed, engine=engine)
    for column in task.columns:
        rows[f"survives `{task.ranges}`, {column}"] = partial(_survival, column=column)
    return rows


def _pd_passed(found: Assessment, engine: str) -> str:
    return _passed(found.pd_passed, engine)


def _wrong_passed(found: Assessment, engine: str) -> str:
    return _passed(found.wrong_passed, engine)


def _passed(counts: dict[str, tuple[int, int]] | None, engine: str) -> str:
    passed = (counts or {}).get(engine)
    return "-" if passed is None else f"{passed[0]} of {passed[1]}"


def _survival(found: Assessment, column: Column) -> str:
    for result in found.survival:
        if (result.engine, result.servo) == (column.engine, column.servo):
            low, high = result.interval
            return f"{result.survived} of {result.n} ({low:.2f} to {high:.2f})"
    return "-"


def _figure(found: Assessment, name: str, factor: float, digits: int) -> str:
    return "-" if found.figures is None else f"{factor * found.figures[name]:.{digits}g}"


def _value_rows(search: Search, before: Assessment, after: Assessment) -> Iterator[str]:
    for parameter in search.task.space.parameters:
        values = [value_at(a.gait, parameter.key) for a in (before, after)]
        told = ["robot's own" if value is None else _short(value) for value in values]
        importance = search.importance.get(parameter.key)
        share = "-" if importance is None else f"{importance:.2f}"
        yield f"| `{parameter.key}` | {told[0]} | {told[1]} | {parameter.in_words()} | {share} |"


def _short(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _stage_rows(search: Search) -> Iterator[str]:
    for stage in STAGES:
        found = [trial.found for trial in search.trials if trial.found.stage == stage]
        reasons = Counter(_kind(f.reason) for f in found if f.reason)
        told = "; ".join(f"{reason} ({n})" for reason, n in reasons.most_common(N_REASONS))
        yield f"| {stage} | {len(found)} | {told} |"


def _kind(reason: str) -> str:
    """Reason without the figures that differ from walk to walk."""
    return reason.partition(";")[0].partition(" at ")[0][:90].replace("|", "/")
