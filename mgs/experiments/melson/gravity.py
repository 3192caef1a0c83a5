"""Gravity torques of a robot in single support along a motion.

Eq. (24) of "Inverse kinematics of a humanoid robot modelled as a tree-shaped manipulator":
tau = -J_com^T M g in the tree rooted at the support sole. In double support
the legs close a loop and the torques are not unique.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.pipeline import Stages
from mgs.robot import Robot


def gravity_torques(robot: Robot, stages: Stages) -> Array:
    """Gravity torques (N, n) [N m] in the order of `Robot.joint_names`; NaN in double support."""
    tasks, angles = stages.tasks, stages.joints.angles
    torques = np.full(angles.shape, np.nan)
    for side in Side:
        tree = TreeTasks(robot, side)
        for k in np.flatnonzero(tasks.support == Support.single(side)):
            tree.place(pin.XYZQUATToSE3(tasks.soles[k, side]))
            torques[k, tree.order] = tree.gravity(angles[k, tree.order])[0]
    return torques


def gravity_cost(torques: Array) -> Array:
    """Cost H_grav = 1/2 tau^T tau, (N,) [(N m)^2], of torques (N, n) [N m]; NaN for NaN."""
    return np.asarray(0.5 * np.sum(torques**2, axis=1))
