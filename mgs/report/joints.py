"""Plots of joint angles, speeds and torques with their limits, one panel per joint name."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Side
from mgs.motion import Motion
from mgs.report.canvas import INK, SIDE_COLOURS
from mgs.report.panels import Line, Panel, draw_panels
from mgs.robot import Robot

COLUMNS = 3
SHOW_LIMIT_ABOVE = 0.5  # least ratio of peak to limit for which the limits are inside the axes

# accepted forms: left_knee, l_knee, LKnee, knee_left, knee_l
SIDE_NAME = re.compile(r"^(?i:(left|right))_?|^([lr])_|^([LR])(?=[A-Z])|_(?i:(left|right|l|r))$")


@dataclass(frozen=True)
class JointSet:
    """Joints in one panel: the left and the right joint of a name, or a single joint."""

    group: str
    title: str
    joints: tuple[tuple[Side | None, int], ...]  # side and index of each joint


def joint_sets(robot: Robot) -> list[JointSet]:
    """Joints of a robot by group and name, with left and right joints together."""
    groups = {name: group for group, names in robot.spec.groups.items() for name in names}
    order = sorted(
        range(robot.n), key=lambda i: _place(list(robot.spec.groups), groups, robot.joint_names[i])
    )
    found: dict[tuple[str, str], list[tuple[Side | None, int]]] = {}
    for i in order:
        name = robot.joint_names[i]
        side, title = split_side(name)
        _, group = split_side(groups.get(name, "other"))
        found.setdefault((group, title.replace("_", " ")), []).append((side, i))
    return [JointSet(group, title, tuple(joints)) for (group, title), joints in found.items()]


def _place(order: list[str], groups: dict[str, str], name: str) -> int:
    return order.index(groups[name]) if name in groups else len(order)


def split_side(name: str) -> tuple[Side | None, str]:
    """Side and remaining name of a joint or group, e.g. (LEFT, knee) for `left_knee`."""
    match = SIDE_NAME.search(name)
    rest = SIDE_NAME.sub("", name, count=1)
    if match is None or not rest:
        return None, name
    letter = next(text for text in match.groups() if text)[0].lower()
    return (Side.LEFT if letter == "l" else Side.RIGHT), rest


def plot_positions(motion: Motion) -> Figure:
    """Draw joint angles [deg] with their limits."""
    robot = motion.robot
    angles = motion.q[:, FLOATING_BASE_NQ:]

    def panel(joints: JointSet) -> Panel:
        i = [index for _, index in joints.joints]
        margin = np.minimum(angles[:, i] - robot.lower[i], robot.upper[i] - angles[:, i]).min()
        return Panel(
            lines=_lines(motion, joints, np.degrees(angles)),
            ylabel="angle [deg]",
            title=joints.title,
            note=f"{np.degrees(margin):.0f} deg from limit",
            limits=_position_limits(robot, joints),
        )

    return _multiples(
        [panel(joints) for joints in joint_sets(robot)], robot, "dashed: joint limits"
    )


def _position_limits(robot: Robot, joints: JointSet) -> tuple[tuple[float, str], ...]:
    """Limits [deg] with their colours; limits that differ have the colours of their sides."""
    limits: dict[float, str] = {}
    for side, i in joints.joints:
        for level in (float(np.degrees(robot.lower[i])), float(np.degrees(robot.upper[i]))):
            limits[level] = INK if side is None or level in limits else SIDE_COLOURS[side]
    return tuple(limits.items())


def plot_velocities(motion: Motion) -> Figure:
    """Draw joint speeds [deg/s] with the speed limits of the servos."""
    values = np.degrees(motion.v[:, FLOATING_BASE_NV:])
    limits = np.degrees(motion.robot.speed_limit)
    return _against_symmetric_limits(motion, values, limits, "speed [deg/s]", "of the speed limit")


def plot_torques(motion: Motion) -> Figure:
    """Draw joint torques [N m] with the stall torques of the servos."""
    limits = motion.robot.torque_limit
    return _against_symmetric_limits(
        motion, motion.torque, limits, "torque [N m]", "of stall torque"
    )


def _against_symmetric_limits(
    motion: Motion, values: Array, limits: Array, ylabel: str, what: str
) -> Figure:
    """Draw values (N, n) with limits +-(n,), which are outside the axes if the values are small."""

    def panel(joints: JointSet) -> Panel:
        i = [index for _, index in joints.joints]
        ratio = np.abs(values[:, i]) / limits[i]
        peak, rms = 100.0 * ratio.max(), 100.0 * np.sqrt(np.mean(ratio**2, axis=0)).max()
        limit = float(limits[i].min())
        near = peak > 100.0 * SHOW_LIMIT_ABOVE
        bound = 1.15 * float(np.abs(values[:, i]).max()) or limit
        return Panel(
            lines=_lines(motion, joints, values),
            ylabel=ylabel,
            title=joints.title,
            note=f"peak {peak:.0f} %" + f", RMS {rms:.0f} %",
            limits=((-limit, INK), (limit, INK)) if near else (),
            ylim=None if near else (-bound, bound),
        )

    panels = [panel(joints) for joints in joint_sets(motion.robot)]
    return _multiples(
        panels, motion.robot, f"percentages {what}; dashed: limits, if inside the axes"
    )


def _lines(motion: Motion, joints: JointSet, values: Array) -> tuple[Line, ...]:
    return tuple(
        Line(
            motion.times,
            values[:, i],
            "middle" if side is None else side.label,
            INK if side is None else SIDE_COLOURS[side],
            width=1.9
            if side is Side.LEFT
            else 1.0,  # the wide line stays visible below the other one
        )
        for side, i in joints.joints
    )


def _multiples(panels: list[Panel], robot: Robot, caption: str) -> Figure:
    """Draw panels; each group of joints starts a new row."""
    places: list[Panel | None] = []
    group = ""
    for joints, panel in zip(joint_sets(robot), panels, strict=True):
        if joints.group != group:
            places += [None] * (-len(places) % COLUMNS)
            group = joints.group
        places.append(panel)
    return draw_panels(places, columns=COLUMNS, height=1.75, caption=caption)
