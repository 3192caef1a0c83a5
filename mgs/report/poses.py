"""Plot of robot poses side by side, each in a frame of its own on the ground."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mgs.core.arrays import Array
from mgs.report.canvas import FAINT, LABEL, TICK, TITLE, new_figure
from mgs.report.robot_drawing import View, box_corners, draw_robot
from mgs.robot import Robot


@dataclass(frozen=True, eq=False)
class Pose:
    """Drawing of the robot at q (7 + n,) in a view, optionally with another pose for comparison."""

    q: Array
    view: View
    title: str = ""
    note: str = ""
    ghost: Array | None = None  # (7 + n,)


def plot_poses(
    robot: Robot,
    poses: Sequence[Pose],
    *,
    columns: int,
    rows: Sequence[str] = (),
    width: float = 9.0,
    caption: str = "",
) -> Figure:
    """Draw poses row by row with the same scale.

    Args:
        robot: robot model.
        poses: poses to draw.
        columns: number of poses per row.
        rows: labels of the rows.
        width: width of the figure [inch].
        caption: remark below the poses.
    """
    reach = 1.05 * max(float(np.abs(_outline(robot, pose)).max(axis=0)[0]) for pose in poses)
    top = 1.03 * max(float(_outline(robot, pose)[:, 1].max()) for pose in poses)
    bottom = -0.03 * top
    n_rows = math.ceil(len(poses) / columns)
    height = width / columns * (top - bottom) / (2.0 * reach) + 0.35
    figure = new_figure(width, n_rows * height + 0.3)
    grid = figure.subplots(n_rows, columns, squeeze=False)
    for k, axes in enumerate(grid.ravel()):
        _bare(axes)
        if k < len(poses):
            _draw(axes, robot, poses[k])
            axes.set(xlim=(-reach, reach), ylim=(bottom, top))
    for axes, name in zip(grid[:, 0], rows, strict=False):
        axes.set_ylabel(name, fontsize=LABEL)
    if caption:
        figure.supxlabel(caption, fontsize=TICK, color=FAINT)
    return figure


def _bare(axes: Axes) -> None:
    axes.set_aspect("equal")
    axes.set(xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_visible(False)


def _draw(axes: Axes, robot: Robot, pose: Pose) -> None:
    axes.axhline(0.0, color=FAINT, linewidth=0.8, zorder=1.0)
    if pose.ghost is not None:
        draw_robot(
            axes,
            robot,
            pose.ghost,
            pose.view,
            offset=_centre(robot, pose, pose.ghost),
            ghost=True,
            zorder=4.0,
        )
    draw_robot(axes, robot, pose.q, pose.view, offset=_centre(robot, pose, pose.q))
    axes.set_title(pose.title, fontsize=TITLE, loc="center")
    axes.set_xlabel(pose.note, fontsize=TICK, color=FAINT)


def _centre(robot: Robot, pose: Pose, q: Array) -> tuple[float, float]:
    """Offset in the picture that moves the midpoint of the soles to the origin [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    middle = np.mean([data.oMf[frame].translation for frame in robot.sole_frames], axis=0)
    x, y = pose.view.project(middle * [1.0, 1.0, 0.0])
    return -float(x), -float(y)


def _outline(robot: Robot, pose: Pose) -> Array:
    """Corners (b, 2) of all drawn boxes in the picture [m]."""
    corners = pose.view.project(box_corners(robot, pose.q)).reshape(-1, 2)
    return np.asarray(corners + _centre(robot, pose, pose.q))
