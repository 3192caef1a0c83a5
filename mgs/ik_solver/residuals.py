"""What a finished trajectory misses: every task measured anew, joints against their ranges."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import IkError, JointLimitError, JointSpeedError
from mgs.ik_solver.floating.tasks import BodyTargets, BodyTasks
from mgs.robot import Robot

POSITION_TOLERANCE, COM_TOLERANCE, ROTATION_TOLERANCE = 1e-4, 2e-4, 1.7e-4  # [m], [m], [rad]


@dataclass(frozen=True, eq=False)
class Miss:
    """Distance of one task from its reference at every sample."""

    part: str
    name: str
    size: Array  # (N,) [m] or [rad]
    tolerance: float
    unit: str


def measure_tasks(tasks: BodyTasks, targets: BodyTargets, configurations: Array) -> Array:
    """Target minus actual (N, m) along configurations (N, 7 + n)."""
    errors = np.empty((len(configurations), tasks.m))
    for k, q in enumerate(configurations):
        tasks.update(q)
        tasks.error(targets.x[k], targets.rotations[k], errors[k])
    return errors


def task_misses(tasks: BodyTasks, errors: Array) -> list[Miss]:
    """The misses of every part, positions and orientations apart, of errors (N, m)."""
    misses = []
    for part in tasks.parts:
        rows = tasks.rows[part]
        turns, name = slice(rows.stop - 3, rows.stop), part.replace("_", " ")
        turned = Miss(
            part, f"{name} orientation", _norm(errors[:, turns]), ROTATION_TOLERANCE, "rad"
        )
        if part == "torso":
            misses.append(turned)
            continue
        moves = slice(rows.start, rows.start + 3) if part.endswith("sole") else rows
        near = COM_TOLERANCE if part.startswith("com") else POSITION_TOLERANCE
        misses.append(Miss(part, name, _norm(errors[:, moves]), near, "m"))
        if part.endswith("sole"):
            misses.append(turned)
    return misses


def _norm(errors: Array) -> Array:
    return np.asarray(np.linalg.norm(errors, axis=1))


def refuse_misses(misses: Iterable[Miss], dt: float) -> None:
    """Raise IkError at the first sample at which any of these is beyond its tolerance."""
    found = []
    for miss in misses:
        missed = np.flatnonzero(~(miss.size <= miss.tolerance))  # NaN counts as missed
        if len(missed):
            found.append((int(missed[0]), miss))
    if found:
        k, miss = min(found, key=lambda item: item[0])
        raise IkError(k * dt, miss.name, float(miss.size[k]), miss.tolerance, miss.unit)


def refuse_limits(robot: Robot, joints: Array, dt: float, start: int = 0) -> None:
    """Raise JointLimitError where joints (N, n), from sample `start` on, leave their ranges."""
    outside = np.argwhere((joints < robot.lower) | (joints > robot.upper))
    if len(outside):
        k, j = outside[0]
        raise JointLimitError(
            float((start + k) * dt),
            robot.joint_names[j],
            float(joints[k, j]),
            float(robot.lower[j]),
            float(robot.upper[j]),
        )


def refuse_speed(robot: Robot, angles: Array, dt: float) -> None:
    """Raise JointSpeedError where joint angles (N, n) move faster than their servos can."""
    speed = np.abs(np.diff(angles, axis=0)) / dt
    k, j = np.unravel_index(np.argmax(speed / robot.speed_limit), speed.shape)
    if speed[k, j] > robot.speed_limit[j]:
        raise JointSpeedError(
            float(k * dt), robot.joint_names[j], float(speed[k, j]), float(robot.speed_limit[j])
        )
