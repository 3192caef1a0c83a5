"""Drawing of boxes and balls of a scene, in parallel projection and from above."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Circle

from mgs.core.arrays import Array
from mgs.core.geometry import convex_hull
from mgs.core.scene import Ball, Box, Scene
from mgs.report.canvas import FAINT
from mgs.report.robot_drawing import View

BODY, TOP, BALL = "0.90", "0.82", "#E69F00"
NEARBY = 0.4  # radius around the robot in which boxes are drawn, as part of the CoM height


def draw_scene(
    axes: Axes, scene: Scene, view: View, centre: Array, radius: float, offset: Array, time: float
) -> None:
    """Draw objects within a radius [m] of a point (3,) behind the robot, without struck balls."""
    for box in scene.boxes:
        base = _nearby(box, centre[:2], radius)
        if len(base) < 3:
            continue
        low, high = (np.column_stack([base, np.full(len(base), z)]) for z in (0.0, box.height))
        whole = convex_hull(view.project(np.concatenate([low, high])))
        outlines = [whole + offset, view.project(high) + offset]
        axes.add_collection(
            PolyCollection(
                outlines, facecolor=[BODY, TOP], edgecolor=FAINT, linewidth=0.4, zorder=2
            )
        )
    for ball in scene.balls:
        if time <= ball.time:
            middle = view.project([ball.x, ball.y, ball.radius]) + offset
            axes.add_patch(_disc(ball, middle, 1.0, 2.5))


def draw_scene_above(axes: Axes, scene: Scene, unit: float) -> None:
    """Draw all objects from above; `scale` is the number of units per metre, 1e3 for mm."""
    for box in scene.boxes:
        axes.add_collection(
            PolyCollection(
                [unit * box.corners], facecolor=BODY, edgecolor=FAINT, linewidth=0.6, zorder=0.5
            )
        )
    for ball in scene.balls:
        axes.add_patch(_disc(ball, unit * np.array([ball.x, ball.y]), unit, 0.6))


def _disc(ball: Ball, middle: Array, unit: float, zorder: float) -> Circle:
    return Circle(
        (float(middle[0]), float(middle[1])),
        unit * ball.radius,
        facecolor=BALL,
        edgecolor="0.3",
        linewidth=0.5,
        zorder=zorder,
    )


def _nearby(box: Box, centre: Array, radius: float) -> Array:
    """Corners (m, 2) of the part of a box inside a square around a point (2,), in box axes."""
    turn = np.array([[np.cos(box.yaw), -np.sin(box.yaw)], [np.sin(box.yaw), np.cos(box.yaw)]])
    local = (centre - [box.x, box.y]) @ turn
    half = 0.5 * np.array([box.length, box.width])
    low, high = np.maximum(local - radius, -half), np.minimum(local + radius, half)
    if np.any(low >= high):
        return np.empty((0, 2))
    corners = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    return np.asarray(corners @ turn.T + [box.x, box.y])
