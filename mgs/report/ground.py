"""Plot of a walk from above: footsteps, ZMP and CoM on the ground."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from mgs.core.arrays import Array
from mgs.core.contact import Footstep, Side
from mgs.core.geometry import rotate_planar, sole_corners
from mgs.motion import Motion
from mgs.report.canvas import (
    BLACK,
    GREEN,
    PURPLE,
    SIDE_COLOURS,
    TICK,
    legend_above,
    new_figure,
    style_axes,
)
from mgs.report.scenery import draw_scene_above

MM = 1e3  # millimetres per metre
MAX_NUMBERS = 40  # largest number of footsteps that get a number
CLEARANCE = 0.3  # least distance of numbered footsteps, as a part of the length of a sole
NUMBER_INSET = (-12.0, -8.0)  # [pt] position of a number relative to the outer corner of the toe
MAX_ASPECT = 25.0  # largest ratio of length to width that is drawn with equal scales
AXES_SIZE, MIN_AXES_SIZE = np.array([8.0, 6.0]), np.array([6.0, 1.1])  # [inch]


def plot_above(motion: Motion) -> Figure:
    """Draw footsteps, ZMP, its reference, and CoM from above; x to the right, y up."""
    corners = np.concatenate(list(footstep_corners(motion).values()))
    spans = np.ptp(corners.reshape(-1, 2), axis=0)
    scale = float(min(*(AXES_SIZE / spans)))  # [inch/m]
    width, height = np.maximum(scale * spans, MIN_AXES_SIZE)
    figure = new_figure(float(width) + 1.0, float(height) + 1.1)
    axes = figure.subplots()
    draw_above(axes, motion)
    legend_above(figure, [axes])
    return figure


def draw_above(axes: Axes, motion: Motion) -> None:
    """Draw footsteps, ZMP and CoM into given axes [mm]."""
    style_axes(axes, xlabel="x [mm]", ylabel="y [mm]")
    corners = np.concatenate(list(footstep_corners(motion).values()))
    spans = np.ptp(corners.reshape(-1, 2), axis=0)
    if spans.max() < MAX_ASPECT * spans.min():
        axes.set_aspect("equal")
    else:
        style_axes(axes, note="x and y have different scales", xlabel="x [mm]", ylabel="y [mm]")
    draw_scene_above(axes, motion.scene, MM)
    _draw_footsteps(axes, motion)
    com, zmp, zmp_ref = MM * motion.com, MM * motion.zmp, MM * motion.zmp_ref
    axes.plot(com[:, 0], com[:, 1], color=PURPLE, linewidth=3.4, alpha=0.75, label="CoM")
    if not motion.gait.is_balanced:  # a robot that falls or lies has no ZMP
        return
    axes.plot(zmp[:, 0], zmp[:, 1], color=GREEN, linewidth=1.6, label="ZMP, whole body")
    axes.plot(
        zmp_ref[:, 0],
        zmp_ref[:, 1],
        color=BLACK,
        linewidth=1.0,
        linestyle=(0, (4, 2)),
        label="ZMP, reference",
    )


def footstep_corners(motion: Motion) -> dict[Side, Array]:
    """Corners (m, 4, 2) [m] of the m footsteps of each side."""
    corners = {}
    for side in Side:
        spec = motion.robot.sole_spec(side)
        poses = np.array([[f.x, f.y, f.yaw] for f in motion.footsteps if f.side is side])
        corners[side] = sole_corners(poses.reshape(-1, 3), spec.length, spec.width)
    return corners


def _draw_footsteps(axes: Axes, motion: Motion) -> None:
    for side, corners in footstep_corners(motion).items():
        colour = SIDE_COLOURS[side]
        axes.add_collection(
            PolyCollection(
                list(MM * corners),
                facecolor=(colour, 0.09),
                edgecolor=colour,
                linewidth=0.9,
                label=f"{side.label} sole",
            )
        )
    axes.autoscale_view()
    every = math.ceil(len(motion.footsteps) / MAX_NUMBERS)
    placed: list[Footstep] = []
    for number, footstep in list(enumerate(motion.footsteps, start=-1))[::every]:
        apart = CLEARANCE * motion.robot.sole_spec(footstep.side).length
        if all(np.hypot(footstep.x - p.x, footstep.y - p.y) > apart for p in placed):
            _number(  # both initial footsteps have number 0
                axes, motion, footstep, str(max(number, 0))
            )
            placed.append(footstep)


def _number(axes: Axes, motion: Motion, footstep: Footstep, text: str) -> None:
    """Write a number at the outer corner of the toe, away from ZMP and CoM."""
    spec, outward = motion.robot.sole_spec(footstep.side), [1.0, float(footstep.side.sign)]
    toe = 0.5 * np.array([spec.length, spec.width]) * outward
    x, y = MM * (np.array([footstep.x, footstep.y]) + rotate_planar(toe, footstep.yaw))
    inset = rotate_planar(np.array(NUMBER_INSET) * outward, footstep.yaw)
    axes.annotate(
        text,
        (x, y),
        xytext=(float(inset[0]), float(inset[1])),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=TICK,
        color=SIDE_COLOURS[footstep.side],
        zorder=5.0,
        path_effects=[withStroke(linewidth=2.5, foreground="white")],  # legible on any line
    )
