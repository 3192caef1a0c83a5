"""Plot of zero-moment point (ZMP) and centre of mass (CoM) over time, with the support polygon."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from mgs.core.arrays import Array
from mgs.motion import Motion
from mgs.report.canvas import BLACK, GREEN, PURPLE
from mgs.report.panels import Band, Line, Panel, draw_panels, shade_single_support
from mgs.robot.support_polygon import support_polygon, support_spans

MM = 1e3  # millimetres per metre


def plot_balance(motion: Motion) -> Figure:
    """Draw two panels over time: x and y."""
    bounds = support_bounds(motion)
    return draw_panels([_panel(motion, bounds, axis) for axis in (0, 1)], height=2.7)


def _panel(motion: Motion, bounds: Array, axis: int) -> Panel:
    t = motion.times
    return Panel(
        lines=(
            Line(t, MM * motion.com[:, axis], "CoM", PURPLE, width=2.0),
            Line(t, MM * motion.zmp[:, axis], "ZMP, whole body", GREEN, width=1.6),
            Line(t, MM * motion.zmp_ref[:, axis], "ZMP, reference", BLACK, "--", width=1.0),
        ),
        ylabel=f"{'xy'[axis]} [mm]",
        title=("forward", "to the left")[axis],
        band=Band(t, MM * bounds[:, axis, 0], MM * bounds[:, axis, 1], "support polygon"),
        shades=shade_single_support(t, motion.support),
    )


def support_bounds(motion: Motion) -> Array:
    """Bounds (N, 2, 2) of the support polygon along x and y through the ZMP [m].

    Axes of the array: sample, coordinate, (low, high). The ZMP is inside if it is between
    both bounds of a coordinate; the bounding box of the polygon would not show this.
    """
    bounds = np.empty((motion.n_samples, 2, 2))
    for span in support_spans(motion.robot, motion.soles, motion.support):
        start, end = span.start, span.end
        polygon = support_polygon(motion.robot, motion.soles[start], span.support, span.bears)
        for axis in (0, 1):
            level = motion.zmp[start:end, 1 - axis]
            bounds[start:end, axis] = section(polygon, level, axis)
    return bounds


def section(polygon: Array, level: Array, axis: int) -> Array:
    """Ends (n, 2) of the intersections of a convex polygon (m, 2) with lines parallel to an axis.

    `level` (n,) is the other coordinate of each line, clipped to the range of the polygon.
    """
    a, b = polygon, np.roll(polygon, -1, axis=0)
    other = 1 - axis
    level = np.clip(level, a[:, other].min(), a[:, other].max())[:, None]
    rise = b[:, other] - a[:, other]
    parallel = np.abs(rise) < 1e-12
    s = (level - a[:, other]) / np.where(parallel, 1.0, rise)
    on_edge = ~parallel & (s >= -1e-9) & (s <= 1.0 + 1e-9)
    cut = a[:, axis] + s * (b[:, axis] - a[:, axis])
    low = np.where(on_edge, cut, np.inf).min(axis=1)
    high = np.where(on_edge, cut, -np.inf).max(axis=1)
    return np.stack([low, high], axis=1)
