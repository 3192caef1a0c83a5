"""Joints of each limb, and the length of the legs."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.contact import Side
from mgs.robot.robot import Robot

Mask = NDArray[np.bool_]


def leg_joints(robot: Robot, side: Side) -> list[int]:
    """Pinocchio joint ids of a leg: the joints that the other leg does not share."""
    own, other = (
        [int(joint) for joint in robot.model.supports[robot.model.frames[frame].parentJoint]]
        for frame in (robot.sole_frames[side], robot.sole_frames[side.other])
    )
    return [joint for joint in own if joint not in other]


def leg_length(robot: Robot) -> float:
    """Length of the stretched left leg along its joints, from the first joint to the sole [m]."""
    frame = robot.model.frames[robot.sole_frames[Side.LEFT]]
    steps = [robot.model.jointPlacements[j].translation for j in leg_joints(robot, Side.LEFT)[1:]]
    steps.append(frame.placement.translation)
    return float(sum(np.linalg.norm(step) for step in reversed(steps)))


def midpoint_width(robot: Robot) -> float:
    """Distance of the sole centres in the half-sitting posture [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.standing_q)
    left, right = (data.oMf[frame].translation for frame in robot.sole_frames)
    return float(math.hypot(*(left - right)[:2]))


def leg_mask(robot: Robot) -> Mask:
    """Mask (n,) of the joints between base and soles."""
    left, right = (_joints_to(robot, frame) for frame in robot.sole_frames)
    return left | right


def arm_mask(robot: Robot, side: Side) -> Mask:
    """Mask (n,) of the joints between torso and one hand."""
    return _joints_to(robot, robot.hand_frames[side]) & ~_joints_to(robot, robot.torso_frame)


def _joints_to(robot: Robot, frame: int) -> Mask:
    mask = np.zeros(robot.n, dtype=np.bool_)
    joint = robot.model.frames[frame].parentJoint
    while joint > 1:  # 1 is the floating base
        mask[robot.model.idx_vs[joint] - FLOATING_BASE_NV] = True
        joint = robot.model.parents[joint]
    return mask
