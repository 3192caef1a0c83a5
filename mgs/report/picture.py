"""Overview picture of a motion: the robot at several instants, and its tracks from above."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mgs.core.arrays import Array
from mgs.core.contact import Support
from mgs.core.spans import spans
from mgs.motion import Motion
from mgs.report.canvas import (
    FAINT,
    GREEN,
    INK,
    PURPLE,
    TICK,
    legend_above,
    new_figure,
    render,
    save_figures,
)
from mgs.report.ground import draw_above, footstep_corners
from mgs.report.robot_drawing import box_corners, draw_robot, view_from
from mgs.report.scenery import NEARBY, draw_scene

WIDTH = 9.2  # [inch] width of the picture
VIEW = view_from(-58.0, 14.0)  # from the front right: the robot walks to the right
N_POSES, MIN_PLACES = 8, 6  # largest number of poses; least width in poses
MIN_STEPS = 2  # least number of steps of a motion that is drawn step by step
MOVING = 0.02  # part of the largest joint speed above which a motion counts as moving
SPACING, OVERHANG, LYING, CAPTION = 1.0, 0.58, 1.2, 0.4  # multiples of the CoM height


def picture_strip(motion: Motion, n_poses: int = N_POSES) -> Figure:
    """Draw the robot at rest, in its first steps and at rest again; below, the view from above."""
    spans = np.ptp(np.concatenate(list(footstep_corners(motion).values())), axis=(0, 1))
    ground_height = float(np.clip((WIDTH - 1.0) * spans[1] / spans[0], 1.2, 3.2)) + 0.7
    samples = pose_samples(motion, n_poses)
    unit = float(motion.com[0, 2])
    places = max(len(samples), MIN_PLACES)
    overhang = OVERHANG if motion.gait.is_balanced else LYING
    width = ((places - 1) * SPACING + 2 * overhang) * unit
    left = 0.5 * ((len(samples) - 1) * SPACING * unit - width)  # the poses are centred
    top = 1.08 * max(_top(motion, sample) for sample in samples)
    strip_height = WIDTH * (top + CAPTION * unit) / width
    figure = new_figure(WIDTH, strip_height + ground_height + 0.35)
    strip, ground = figure.subplots(2, 1, height_ratios=[strip_height, ground_height])
    _draw_strip(strip, motion, samples, SPACING * unit)
    strip.set(xlim=(left, left + width), ylim=(-CAPTION * unit, top))
    draw_above(ground, motion)
    ground.set_title("from above", loc="left", fontsize=TICK, color=FAINT)
    legend_above(figure, [ground])
    return figure


def picture_png(motion: Motion) -> bytes:
    """`picture_strip` as a small PNG, for a notebook."""
    return render(picture_strip(motion), "png", few_colours=True)


def write_picture(motion: Motion, path: Path, *, force: bool = False) -> Path:
    """Write `picture_strip` as a small PNG; see `save_figures` for the errors."""
    figures = {path.stem: picture_strip(motion)}
    return save_figures(figures, path.parent, force=force, few_colours=True)[0]


def _top(motion: Motion, sample: int) -> float:
    """Height of the robot above its place in the strip [m]."""
    corners = box_corners(motion.robot, motion.q[sample]).reshape(-1, 3)
    return float((corners @ VIEW.up).max() - _centre(motion, sample) @ VIEW.up)


def _centre(motion: Motion, sample: int) -> Array:
    """Point (3,) on the ground that is the place of the robot: between its soles, or below it."""
    points = motion.soles[sample, :, :3] if motion.gait.is_balanced else motion.com[sample, None]
    return np.asarray(points.mean(axis=0) * [1.0, 1.0, 0.0])


def pose_samples(motion: Motion, n_poses: int) -> list[int]:
    """Samples to draw: the first, the last, and the middles of the first single supports.

    For a sequence, the steps are spread from its start to its end. For a motion with fewer than
    `MIN_STEPS` steps, instants are spread evenly over the time in which the robot moves.
    """
    n_between = max(n_poses - 2, 0)
    middles = [
        (start + end) // 2
        for start, end in spans(motion.support)
        if motion.support[start] != Support.DOUBLE
    ]
    if motion.gait.motion == "sequence" and len(middles) > n_between:
        struck = {round(ball.time / motion.dt) for ball in motion.scene.balls[:n_between]}
        spread = np.linspace(0, len(middles) - 1, n_between - len(struck))
        middles = sorted(struck | {middles[round(i)] for i in spread})
    if len(middles) < MIN_STEPS:
        speed = np.abs(np.diff(motion.q, axis=0)).max(axis=1)
        moving = np.flatnonzero(speed > MOVING * speed.max(initial=0.0))
        if len(moving):
            spread = np.linspace(moving[0], moving[-1], n_between + 2)[1:-1]
            middles = [round(k) for k in spread]
    return [0, *middles[:n_between], motion.n_samples - 1]


def _draw_strip(axes: Axes, motion: Motion, samples: list[int], spacing: float) -> None:
    axes.set_aspect("equal")
    axes.set_axis_off()
    for i, sample in enumerate(samples):
        centre = _centre(motion, sample)
        x, y = VIEW.project(centre)
        offset = np.array([i * spacing - x, -y])
        radius, time = NEARBY * float(motion.com[0, 2]), sample * motion.dt
        draw_scene(axes, motion.scene, VIEW, centre, radius, offset, time)
        _draw_points(axes, motion, sample, offset)
        draw_robot(axes, motion.robot, motion.q[sample], VIEW, offset=(offset[0], offset[1]))
        _caption(axes, motion, sample, i * spacing)


def _draw_points(axes: Axes, motion: Motion, sample: int, offset: Array) -> None:
    """Draw ZMP and CoM, with a line from the CoM to the ground, in front of the robot."""
    sides = list(Support(motion.support[sample]).sides)
    ground = float(motion.soles[sample, sides, 2].mean())
    com, zmp = motion.com[sample], np.append(motion.zmp[sample], ground)
    ends = VIEW.project([com, [*com[:2], ground]]) + offset
    axes.plot(*ends.T, color=PURPLE, linewidth=1.0, linestyle=":", zorder=4.0)
    for point, colour in ((com, PURPLE), (zmp, GREEN)):
        axes.plot(
            *(VIEW.project(point) + offset),
            marker="o",
            markersize=6,
            color=colour,
            markeredgecolor="white",
            markeredgewidth=0.9,
            zorder=5.0,
        )


def _caption(axes: Axes, motion: Motion, sample: int, x: float) -> None:
    support = Support(motion.support[sample])
    what = "both soles" if support is Support.DOUBLE else f"{support.label} sole"
    what = what if motion.gait.is_balanced else ""
    unit = float(motion.com[0, 2])
    for y, text, colour in ((-0.25, f"{sample * motion.dt:.1f} s", INK), (-0.36, what, FAINT)):
        axes.text(x, y * unit, text, ha="center", va="center", fontsize=TICK, color=colour)
