"""References of the fifteen tree tasks over time, and how far a motion may miss them."""

from __future__ import annotations

from typing import Literal

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import COM_TOLERANCE
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.core.geometry import quat_xyzw_from_yaw, rotations_from_quat_xyzw
from mgs.ik_solver.residuals import position_rows, turn_rows
from mgs.ik_solver.rotations import turns_between
from mgs.ik_solver.tree.tasks import (
    COM,
    LEFT_HAND,
    N_POSITIONS,
    N_TASKS,
    RIGHT_HAND,
    SWING,
    TURN,
)
from mgs.robot import Robot
from mgs.robot.legs import missing_turn
from mgs.trajectory_planner import TaskTrajectory

TorsoMode = Literal["free", "upright", "hold"]
# A motion that misses one of these tasks is refused.
TREE_TASKS = (
    position_rows("swing sole", SWING),
    position_rows("right hand", RIGHT_HAND),
    position_rows("left hand", LEFT_HAND),
    position_rows("CoM", COM, COM_TOLERANCE),
    turn_rows("swing sole", TURN),
)


def refuse_torso(tasks: TaskTrajectory, solver: str) -> None:
    """Raise ConfigError where the gait prescribes the torso, which the tree tasks leave free."""
    if tasks.torso_asked:
        raise ConfigError(
            "ik.solver",
            f"{solver} leaves the torso free, but this gait has channels for it; use ik1 to ik5, "
            "prioritized or prioritized-acceleration",
        )


def torso_targets(robot: Robot, tasks: TaskTrajectory, mode: TorsoMode) -> Array | None:
    """Rotations (N, 3, 3) that the torso shall keep; None: it is free.

    `hold` keeps the orientation of the half-sitting posture, turned with the soles; `upright` keeps
    its heading alone, with that axis of the torso frame vertical which is nearest to it: the frames
    of many robots have another axis than z along the trunk. Legs that lack a turn of the sole hold
    the pelvis already and leave no room for the torso.
    """
    if mode == "free" or missing_turn(robot) is not None:
        return None
    R = rotations_from_quat_xyzw(tasks.torso)
    if mode == "hold":
        return R
    i = int(np.abs(R[0, 2]).argmax())
    z, x = np.sign(R[0, 2, i]) * np.eye(3)[i], np.eye(3)[(i + 1) % 3]
    C = np.column_stack([x, np.cross(z, x), z])  # torso frame with z along the trunk
    upright = quat_xyzw_from_yaw(np.arctan2((R @ C)[:, 1, 0], (R @ C)[:, 0, 0]))
    return np.asarray(rotations_from_quat_xyzw(upright) @ C.T)


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


def task_steps(positions: Array, rotations: Array) -> Array:
    """t[k] - t[k-1] (m, 15) of positions (m, 12) and rotations (m, 3, 3); zero for k = 0."""
    steps = np.zeros((len(positions), N_TASKS))
    steps[1:, :N_POSITIONS] = np.diff(positions, axis=0)
    steps[:, TURN] = turns_between(rotations)
    return steps
