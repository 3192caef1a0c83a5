"""Refusal of a finished trajectory that misses a task or leaves a limit of a joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import POSITION_TOLERANCE, ROTATION_TOLERANCE
from mgs.core.errors import IkError, JointLimitError, JointSpeedError
from mgs.robot import Robot


@dataclass(frozen=True, eq=False)
class TaskRows:
    """Rows of a task vector whose error counts as one distance or as one angle."""

    name: str  # of the task, in messages
    rows: slice
    tolerance: float  # largest error of a trajectory that is accepted, in the unit
    unit: str  # m or rad

    def sizes(self, errors: Array) -> Array:
        """Distances or angles (N,) of the task errors (N, m) of N samples."""
        return np.asarray(np.linalg.norm(errors[:, self.rows], axis=1))


def position_rows(name: str, rows: slice, tolerance: float = POSITION_TOLERANCE) -> TaskRows:
    """Rows that hold a position, or some of its coordinates [m]."""
    return TaskRows(name, rows, tolerance, "m")


def turn_rows(name: str, rows: slice) -> TaskRows:
    """Rows that hold an orientation as a rotation vector [rad]."""
    return TaskRows(f"{name} orientation", rows, ROTATION_TOLERANCE, "rad")


def refuse_misses(
    tasks: Sequence[TaskRows],
    errors: Array,
    dt: float,
    start: int = 0,
    causes: Mapping[int, str] | None = None,
) -> None:
    """Raise IkError at the first sample where a task is missed, for the task missed by most.

    Args:
        tasks: the tasks that are checked.
        errors: (N, m) target minus actual; an error that is not finite counts as a miss.
        dt: sampling period [s].
        start: sample of the motion that the first row belongs to.
        causes: causes of misses at some samples, for the message.
    """
    sizes = np.stack([task.sizes(errors) for task in tasks], axis=1)
    ratios = sizes / np.array([task.tolerance for task in tasks])
    missed = np.flatnonzero(~np.all(ratios <= 1.0, axis=1))
    if len(missed):
        k = int(missed[0])
        worst = int(np.argmax(np.nan_to_num(ratios[k], nan=np.inf)))
        task = tasks[worst]
        size, cause = float(sizes[k, worst]), (causes or {}).get(start + k, "")
        raise IkError((start + k) * dt, task.name, size, task.tolerance, task.unit, cause)


def refuse_limits(robot: Robot, joints: Array, dt: float, start: int = 0) -> None:
    """Raise JointLimitError where angles (N, n) of the samples from `start` on leave a range."""
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


def refuse_speed(robot: Robot, angles: Array, dt: float, start: int = 0) -> None:
    """Raise JointSpeedError where angles (N, n) from sample `start` on outrun their servos."""
    speed = np.abs(np.diff(angles, axis=0)) / dt
    k, j = np.unravel_index(np.argmax(speed / robot.speed_limit), speed.shape)
    if speed[k, j] > robot.speed_limit[j]:
        raise JointSpeedError(
            float((start + k) * dt),
            robot.joint_names[j],
            float(speed[k, j]),
            float(robot.speed_limit[j]),
        )
