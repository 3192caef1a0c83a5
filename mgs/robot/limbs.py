"""Joints of the limbs and lengths of the legs.

Joints are numbers of Pinocchio's model, in which 0 is the world and 1 the floating base.
"""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.contact import Side
from mgs.robot.robot import Robot
from mgs.robot.urdf_text import joint_axis

Mask = NDArray[np.bool_]


def joints_to(model: pin.Model, joint: int) -> list[int]:
    """Joints from the floating base, which is left out, to a joint, which is the last of them."""
    return [int(supporting) for supporting in model.supports[joint]][2:]


def joint_chain(robot: Robot, tip: int, root: int | None = None) -> list[int]:
    """Joints that move the frame `tip` but not the frame `root`, from the trunk to the tip.

    Without a root these are all joints between the floating base and the tip.
    """
    model = robot.model
    trunk = [] if root is None else joints_to(model, model.frames[root].parentJoint)
    chain = joints_to(model, model.frames[tip].parentJoint)
    return [joint for joint in chain if joint not in trunk]


def leg_joints(robot: Robot, side: Side) -> list[int]:
    """Joints of a leg, from the first one that the other leg does not share to the sole."""
    return joint_chain(robot, robot.sole_frames[side], robot.sole_frames[side.other])


def arm_joints(robot: Robot, side: Side) -> list[int]:
    """Joints between the torso and a hand."""
    return joint_chain(robot, robot.hand_frames[side], robot.torso_frame)


def leg_mask(robot: Robot) -> Mask:
    """Mask (n,) of the joints between the base and the soles."""
    left, right = (joint_chain(robot, frame) for frame in robot.sole_frames)
    return _mask(robot, [*left, *right])


def arm_mask(robot: Robot, side: Side) -> Mask:
    """Mask (n,) of the joints between the torso and a hand."""
    return _mask(robot, arm_joints(robot, side))


def _mask(robot: Robot, joints: list[int]) -> Mask:
    """Mask (n,) of joints given by their numbers in the model."""
    mask = np.zeros(robot.n, dtype=np.bool_)
    mask[[robot.model.idx_vs[joint] - FLOATING_BASE_NV for joint in joints]] = True
    return mask


def stretched_length(model: pin.Model, joints: list[int], tip: Array | None = None) -> float:
    """Length of a stretched limb from its first joint to its last one [m].

    With a point `tip` (3,) in the frame of the last joint, the limb ends there.
    """
    steps = [model.jointPlacements[joint].translation for joint in joints[1:]]
    steps += [] if tip is None else [tip]
    return float(sum(np.linalg.norm(step) for step in reversed(steps)))


def leg_length(robot: Robot) -> float:
    """Length of the stretched left leg from the hip to the sole [m].

    It stands for the size of the robot: lengths of gaits go with it.
    """
    sole = robot.model.frames[robot.sole_frames[Side.LEFT]].placement.translation
    return stretched_length(robot.model, leg_joints(robot, Side.LEFT), sole)


def hip_to_ankle_length(robot: Robot) -> float:
    """Largest distance from the first joint of a leg to its last one, of the shorter leg [m].

    The knee is stretched and the other joints are as in the half-sitting posture. This is what
    bounds the height of the CoM.
    """
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.standing_q)
    return min(_stretched_knee(robot.model, data, leg_joints(robot, side)) for side in Side)


def _stretched_knee(model: pin.Model, data: pin.Data, joints: list[int]) -> float:
    """Largest distance of the first joint from the last one that the knee between them allows [m].

    The ankle moves on a circle about the axis of the knee. Seen along this axis hip, knee and ankle
    are in line where they are farthest apart. The knee is the joint that changes the distance most.
    """
    hip, ankle = (data.oMi[joint].translation for joint in (joints[0], joints[-1]))
    most, longest = -1.0, 0.0
    for joint in joints[1:-1]:
        axis = data.oMi[joint].rotation @ joint_axis(model, joint)
        along, across = [], []
        for point in (hip, ankle):
            arm = point - data.oMi[joint].translation
            along.append(float(arm @ axis))
            across.append(float(np.linalg.norm(arm - along[-1] * axis)))
        if across[0] * across[1] > most:
            most = across[0] * across[1]
            longest = math.hypot(sum(across), along[0] - along[1])
    return longest


def midpoint_width(robot: Robot) -> float:
    """Horizontal distance of the sole centres in the half-sitting posture [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.standing_q)
    left, right = (data.oMf[frame].translation for frame in robot.sole_frames)
    return float(math.hypot(*(left - right)[:2]))
