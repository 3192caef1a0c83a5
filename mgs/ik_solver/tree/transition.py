"""The transition from one posture to another while both soles stay where they are.

The straight line in joint space is corrected at every sample by Newton steps of least norm, until
soles and CoM are where they should be. Both of its ends meet their tasks already and stay as given.
"""

from __future__ import annotations

import numpy as np

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.geometry import quintic
from mgs.ik_solver.joint_trajectory import JointTrajectory
from mgs.ik_solver.residuals import refuse_limits, refuse_misses
from mgs.ik_solver.tree.batch import TreeBatch
from mgs.ik_solver.tree.targets import TREE_TASKS
from mgs.ik_solver.tree.tasks import N_TASKS
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

MAX_UPDATES = 20
ON_TASK = 1e-9  # [m] and [rad]


def bridge_postures(
    robot: Robot, tasks: TaskTrajectory, com: ComTrajectory, begin: Array, end: Array
) -> JointTrajectory:
    """Joint angles from `begin` to `end` (n,), at rest at both, by a minimum-jerk blend.

    Raises:
        IkError: soles or CoM cannot be kept on the way.
        JointLimitError: a joint leaves its range.
    """
    n = tasks.n_samples
    q = begin + quintic(np.arange(n) / (n - 1))[:, None] * (end - begin)
    batch = TreeBatch(robot, tasks, com, None)
    error, J = batch.tasks_at(q)
    for _ in range(MAX_UPDATES):
        if np.abs(error).max() < ON_TASK:
            break
        y = np.linalg.solve(J @ J.transpose(0, 2, 1), error[..., None])
        q = q + (J.transpose(0, 2, 1) @ y)[..., 0]
        if robot.coupling is not None:
            robot.coupling.complete(q)
        error, J = batch.tasks_at(q)
    errors = np.zeros((n, N_TASKS))
    errors[:, batch.rows] = error
    refuse_misses(TREE_TASKS, errors, tasks.dt)
    refuse_limits(robot, q, tasks.dt)
    return JointTrajectory(q)
