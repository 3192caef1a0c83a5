"""References of the fifteen tree tasks over time, and the refusal of what misses them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Literal

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.errors import ConfigError, IkError
from mgs.core.geometry import quat_xyzw_from_yaw, rotations_from_quat_xyzw, yaw_from_quat_xyzw
from mgs.ik_solver.tree.tasks import COM, LEFT_HAND, RIGHT_HAND, SWING, TURN
from mgs.robot import Robot
from mgs.robot.legs import missing_turn
from mgs.trajectory_planner import TaskTrajectory

# A motion file is refused beyond these.
TOLERANCES = (
    ("swing sole", SWING, 1e-4, "m"),
    ("right hand", RIGHT_HAND, 1e-4, "m"),
    ("left hand", LEFT_HAND, 1e-4, "m"),
    ("CoM", COM, 2e-4, "m"),
    ("swing sole orientation", TURN, 1.7e-4, "rad"),  # 0.01 deg
)


def refuse_torso(tasks: TaskTrajectory, solver: str) -> None:
    """Raise ConfigError where the gait asks something of the torso, which the tree tasks lack."""
    if tasks.torso_asked:
        raise ConfigError(
            "ik.solver",
            f"{solver} leaves the torso free, but this gait has channels for it; use ik1 to ik5, "
            "prioritized or prioritized-acceleration",
        )


def torso_targets(
    robot: Robot, tasks: TaskTrajectory, mode: Literal["free", "upright", "hold"]
) -> Array | None:
    """Rotations (N, 3, 3) that the torso shall keep; None: it is free.

    `hold` keeps the orientation of the half-sitting posture, turned with the soles; `upright` keeps
    its heading alone, with the torso's z axis vertical. Legs that lack a turn of the sole hold the
    pelvis already and leave no room for the torso.
    """
    if mode == "free" or missing_turn(robot) is not None:
        return None
    if mode == "hold":
        return rotations_from_quat_xyzw(tasks.torso)
    return rotations_from_quat_xyzw(quat_xyzw_from_yaw(yaw_from_quat_xyzw(tasks.torso)))


def root_spans(tasks: TaskTrajectory) -> Iterator[tuple[int, int]]:
    """First sample and end of each span that stands on one sole."""
    bounds = [0, *(np.flatnonzero(np.diff(tasks.root)) + 1), tasks.n_samples]
    return itertools.pairwise(int(bound) for bound in bounds)


def tree_targets(tasks: TaskTrajectory, com: Array, start: int, end: int) -> tuple[Array, Array]:
    """Positions (m, 12) in the order of the tasks and swing sole rotations (m, 3, 3)."""
    span = slice(start, end)
    swing = Side(tasks.root[start]).other
    hands = tasks.hands[span] + com[span, None]
    positions = np.concatenate(
        [tasks.soles[span, swing, :3], hands[:, Side.RIGHT], hands[:, Side.LEFT], com[span]],
        axis=1,
    )
    return positions, rotations_from_quat_xyzw(tasks.soles[span, swing, 3:])


def refuse_task_misses(errors: Array, dt: float, start: int = 0) -> None:
    """Raise IkError at the first sample of errors (N, 15) that misses, for its worst task."""
    residuals = np.stack([np.linalg.norm(errors[:, t[1]], axis=1) for t in TOLERANCES], axis=1)
    ratios = residuals / np.array([tolerance for _, _, tolerance, _ in TOLERANCES])
    missed = np.flatnonzero(~np.all(ratios <= 1.0, axis=1))  # NaN counts as missed
    if len(missed):
        i = int(missed[0])
        worst = int(np.argmax(np.nan_to_num(ratios[i], nan=np.inf)))
        task, _, tolerance, unit = TOLERANCES[worst]
        raise IkError((start + i) * dt, task, float(residuals[i, worst]), tolerance, unit)
