"""Overview picture of a motion: the robot at several instants, and its tracks from above."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Support
from mgs.core.spans import spans
from mgs.motion import Motion
from mgs.report.canvas import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    SKY,
    TICK,
    TITLE,
    VERMILION,
    legend_above,
    new_figure,
    render,
    save_figures,
    style_axes,
)
from mgs.report.ground import draw_above, footstep_corners
from mgs.report.robot_drawing import box_corners, draw_robot, view_from
from mgs.report.scenery import NEARBY, draw_scene
from mgs.report.title import title_line

WIDTH = 9.2  # [inch] width of the picture
VIEW = view_from(-58.0, 14.0)  # from the front right: the robot walks to the right
N_POSES, MIN_PLACES = 8, 6  # largest number of poses; least width in poses
MIN_STEPS = 2  # least number of steps of a motion that is drawn step by step
MOVING = 0.02  # part of the largest joint speed above which a motion counts as moving
SPACING, OVERHANG, CAPTION = 1.0, 0.58, 0.4  # multiples of the CoM height
GAP = 0.08  # least gap between the poses of a robot that lies, as a multiple of the same
N_JOINTS = 6  # number of joints that are drawn over time if the robot makes no step


def picture_strip(motion: Motion, n_poses: int = N_POSES, verdict: str = "") -> Figure:
    """Draw the robot at rest, in its first steps and at rest again; below, its tracks.

    Args:
        motion: the motion.
        n_poses: largest number of poses.
        verdict: verdict on the motion in words, for the title.
    """
    spans = np.ptp(np.concatenate(list(footstep_corners(motion).values())), axis=(0, 1))
    on_the_spot = len(motion.footsteps) <= 2
    ground_height = float(np.clip((WIDTH - 1.0) * spans[1] / spans[0], 1.2, 3.2)) + 0.7
    samples = pose_samples(motion, n_poses)
    places, (left, right), (bottom, top) = _strip_layout(motion, samples)
    strip_height = WIDTH * (top - bottom) / (right - left)
    figure = new_figure(WIDTH, strip_height + ground_height + 0.65)
    rows = figure.add_gridspec(2, 1, height_ratios=[strip_height, ground_height])
    strip = figure.add_subplot(rows[0])
    strip.set(xlim=(left, right), ylim=(bottom, top))
    _draw_strip(strip, motion, samples, places)
    strip.set_title(title_line(motion, verdict), loc="left", fontsize=TITLE + 1.0, color=INK)
    below = rows[1].subgridspec(1, 2 if on_the_spot else 1, width_ratios=[1, 2][: 1 + on_the_spot])
    ground = figure.add_subplot(below[0])
    draw_above(ground, motion)
    ground.set_title("from above", loc="left", fontsize=TICK, color=FAINT)
    legend_above(figure, [ground])
    if on_the_spot:
        _draw_joints(figure.add_subplot(below[1]), motion)
    return figure


def _strip_layout(
    motion: Motion, samples: list[int]
) -> tuple[list[float], tuple[float, float], tuple[float, float]]:
    """Place of each pose, and the limits of the strip in x and y [m]; no pose is cut off.

    The poses of a robot that stands have equal distances, and those of one that lies as much room
    as they need.
    """
    unit = float(motion.com[:, 2].max())
    low, high = np.array([_extent(motion, sample) for sample in samples]).transpose(1, 0, 2)
    places = [0.0]
    for i in range(1, len(samples)):
        needed = high[i - 1, 0] - low[i, 0] + GAP * unit
        step = SPACING * unit
        places.append(places[-1] + (step if motion.gait.is_balanced else max(step, needed)))
    overhang = OVERHANG * unit
    left = min(-overhang, float((low[:, 0] + places).min()))
    right = max(places[-1] + overhang, float((high[:, 0] + places).max()))
    lack = 0.5 * max(((MIN_PLACES - 1) * SPACING + 2 * OVERHANG) * unit - (right - left), 0.0)
    bottom = min(-CAPTION * unit, float(low[:, 1].min()) - 0.45 * unit)
    return places, (left - lack, right + lack), (bottom, 1.04 * float(high[:, 1].max()))


def _extent(motion: Motion, sample: int) -> tuple[Array, Array]:
    """Least and largest picture coordinates (2,) of the robot, relative to its place [m]."""
    corners = box_corners(motion.robot, motion.q[sample]).reshape(-1, 3)
    points = VIEW.project(corners) - VIEW.project(_centre(motion, sample))
    return points.min(axis=0), points.max(axis=0)


def _draw_joints(axes: Axes, motion: Motion) -> None:
    """Draw the joints that move most, since a robot on the spot leaves no track."""
    angles = np.degrees(motion.q[:, FLOATING_BASE_NQ:])
    most = np.argsort(-np.ptp(angles, axis=0), kind="stable")[:N_JOINTS]
    style_axes(axes, xlabel="t [s]", ylabel="angle [deg]")
    colours = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)
    for joint, colour in zip(most, colours, strict=False):
        name = motion.robot.joint_names[joint].replace("_", " ")
        axes.plot(motion.times, angles[:, joint], color=colour, linewidth=1.5, label=name)
    axes.set_title("joints that move most", loc="left", fontsize=TICK, color=FAINT)
    axes.legend(fontsize=TICK, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))


def picture_png(motion: Motion) -> bytes:
    """`picture_strip` as a small PNG, for a notebook."""
    return render(picture_strip(motion), "png", few_colours=True)


def write_picture(motion: Motion, path: Path, *, force: bool = False, verdict: str = "") -> Path:
    """Write `picture_strip` as a small PNG; see `save_figures` for the errors."""
    figures = {path.stem: picture_strip(motion, verdict=verdict)}
    return save_figures(figures, path.parent, force=force, few_colours=True)[0]


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


def _draw_strip(axes: Axes, motion: Motion, samples: list[int], places: list[float]) -> None:
    axes.set_aspect("equal")
    axes.set_axis_off()
    for sample, place in zip(samples, places, strict=True):
        centre = _centre(motion, sample)
        x, y = VIEW.project(centre)
        offset = np.array([place - x, -y])
        radius, time = NEARBY * float(motion.com[0, 2]), sample * motion.dt
        draw_scene(axes, motion.scene, VIEW, centre, radius, offset, time)
        _draw_points(axes, motion, sample, offset)
        draw_robot(axes, motion.robot, motion.q[sample], VIEW, offset=(offset[0], offset[1]))
        _caption(axes, motion, sample, place, axes.get_ylim()[0])


def _draw_points(axes: Axes, motion: Motion, sample: int, offset: Array) -> None:
    """Draw CoM and ZMP, with a line from the CoM to the ground, in front of the robot.

    A robot that falls or lies has no ZMP.
    """
    sides = list(Support(motion.support[sample]).sides)
    ground = float(motion.soles[sample, sides, 2].mean())
    com, zmp = motion.com[sample], np.append(motion.zmp[sample], ground)
    ends = VIEW.project([com, [*com[:2], ground]]) + offset
    if motion.gait.is_balanced:
        axes.plot(*ends.T, color=PURPLE, linewidth=1.0, linestyle=":", zorder=4.0)
    points = [(com, PURPLE), (zmp, GREEN)]
    for point, colour in points if motion.gait.is_balanced else points[:1]:
        axes.plot(
            *(VIEW.project(point) + offset),
            marker="o",
            markersize=6,
            color=colour,
            markeredgecolor="white",
            markeredgewidth=0.9,
            zorder=5.0,
        )


def _caption(axes: Axes, motion: Motion, sample: int, x: float, bottom: float) -> None:
    support = Support(motion.support[sample])
    what = "both soles" if support is Support.DOUBLE else f"{support.label} sole"
    what = what if motion.gait.is_balanced else ""
    unit = float(motion.com[:, 2].max())
    for up, text, colour in ((0.15, f"{sample * motion.dt:.1f} s", INK), (0.04, what, FAINT)):
        axes.text(
            x, bottom + up * unit, text, ha="center", va="center", fontsize=TICK, color=colour
        )
