"""Panels of figures as plain data, so that experiments need no plotting library."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from mgs.core.contact import Support
from mgs.report.canvas import (
    BLUE,
    FAINT,
    INK,
    TICK,
    VERMILION,
    legend_above,
    new_figure,
    style_axes,
)

Array = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class Line:
    """Curve; x and y are (N,), NaN gives a gap."""

    x: Array
    y: Array
    label: str = ""
    colour: str = INK
    style: str = "-"
    width: float = 1.5
    marker: str = ""


@dataclass(frozen=True, eq=False)
class Band:
    """Area between two curves; x, low and high are (N,)."""

    x: Array
    low: Array
    high: Array
    label: str = ""


@dataclass(frozen=True, eq=False)
class Shade:
    """Background over the samples where `mask` (N,) is set; x is (N,)."""

    x: Array
    mask: NDArray[np.bool_]
    colour: str
    label: str = ""


@dataclass(frozen=True, eq=False)
class Panel:
    """Contents of one pair of axes."""

    lines: tuple[Line, ...]
    ylabel: str
    title: str = ""
    note: str = ""
    xlabel: str = "time [s]"
    band: Band | None = None
    shades: tuple[Shade, ...] = ()
    limits: tuple[tuple[float, str], ...] = ()  # level and colour of dashed lines inside the axes
    ylim: tuple[float, float] | None = None
    xlim: tuple[float, float] | None = None
    logarithmic: bool = False
    equal: bool = False  # equal scales of both axes


def shade_single_support(times: Array, support: NDArray[np.int8]) -> tuple[Shade, ...]:
    """Backgrounds of single supports; `times` and `support` are (N,)."""
    return (
        Shade(times, support == Support.LEFT, BLUE, "left SSP"),
        Shade(times, support == Support.RIGHT, VERMILION, "right SSP"),
    )


def draw_panels(
    panels: Sequence[Panel | None],
    *,
    columns: int = 1,
    width: float = 9.0,
    height: float = 2.2,
    caption: str = "",
) -> Figure:
    """Draw panels row by row, with one legend for all.

    Args:
        panels: panels to draw; None leaves a place empty.
        columns: number of panels per row.
        width: width of the figure [inch].
        height: height of a row [inch].
        caption: remark at the top right, beside the legend.
    """
    rows = math.ceil(len(panels) / columns)
    figure = new_figure(width, rows * height + 0.5)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for k, axes in enumerate(grid):
        panel = panels[k] if k < len(panels) else None
        if panel is None:
            axes.set_axis_off()
            continue
        below = panels[k + columns] if k + columns < len(panels) else None
        left = panels[k - 1] if k % columns else None
        draw_panel(axes, panel)
        if (
            below is not None and below.xlabel == panel.xlabel
        ):  # label the lowest panel of a column only
            axes.set_xlabel("")
        if left is not None and left.ylabel == panel.ylabel:  # and the first panel of a row only
            axes.set_ylabel("")
    legend_above(figure, grid)
    if caption:
        figure.text(
            0.995,
            1.0 - 0.1 / figure.get_figheight(),
            caption,
            ha="right",
            va="top",
            fontsize=TICK,
            color=FAINT,
        )
    return figure


def draw_panel(axes: Axes, panel: Panel) -> None:
    """Draw one panel into given axes."""
    style_axes(axes, title=panel.title, note=panel.note, xlabel=panel.xlabel, ylabel=panel.ylabel)
    _draw_background(axes, panel)
    for line in panel.lines:
        axes.plot(
            line.x,
            line.y,
            label=line.label or None,
            color=line.colour,
            linestyle=line.style,
            linewidth=line.width,
            marker=line.marker or None,
            markersize=4,
        )
    _scale(axes, panel)


def _draw_background(axes: Axes, panel: Panel) -> None:
    for shade in panel.shades:
        until_next = shade.mask.copy()
        until_next[1:] |= shade.mask[:-1]
        axes.fill_between(
            shade.x,
            0.0,
            1.0,
            where=until_next.tolist(),
            step="post",
            transform=axes.get_xaxis_transform(),
            color=shade.colour,
            alpha=0.11,
            linewidth=0,
            label=shade.label,
        )
    if panel.band is not None:
        band = panel.band
        axes.fill_between(
            band.x,
            band.low,
            band.high,
            step="post",
            color="0.45",
            alpha=0.22,
            linewidth=0,
            label=band.label,
        )


def _scale(axes: Axes, panel: Panel) -> None:
    x = np.concatenate([line.x for line in panel.lines])
    if not any(line.marker for line in panel.lines) and np.ptp(x) > 0.0:
        axes.set_xlim(float(x.min()), float(x.max()))
    if panel.xlim is not None:
        axes.set_xlim(*panel.xlim)
    if panel.equal:
        axes.set_aspect("equal")
    if panel.logarithmic:
        axes.set_yscale("log")
    if panel.limits:
        for level, colour in panel.limits:
            axes.axhline(level, color=colour, linestyle=(0, (5, 3)), linewidth=0.9)
        levels = [level for level, _ in panel.limits]
        margin = 0.06 * (max(levels) - min(levels))
        axes.set_ylim(min(levels) - margin, max(levels) + margin)
    if panel.ylim is not None:
        axes.set_ylim(*panel.ylim)
