"""Which joints move which part of a robot."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mgs.contact import Side
from mgs.robot import FLOATING_BASE_NV, Robot

Mask = NDArray[np.bool_]


def leg_joints(robot: Robot) -> Mask:
    """Mask (n,) of the joints between base and soles."""
    left, right = (_joints_to(robot, frame) for frame in robot.sole_frames)
    return left | right


def arm_joints(robot: Robot, side: Side) -> Mask:
    """Mask (n,) of the joints between torso and one hand."""
    return _joints_to(robot, robot.hand_frames[side]) & ~_joints_to(robot, robot.torso_frame)


def _joints_to(robot: Robot, frame: int) -> Mask:
    mask = np.zeros(robot.n, dtype=np.bool_)
    joint = robot.model.frames[frame].parentJoint
    while joint > 1:  # 1 is the floating base
        mask[robot.model.idx_vs[joint] - FLOATING_BASE_NV] = True
        joint = robot.model.parents[joint]
    return mask
