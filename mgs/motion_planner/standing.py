"""Where the parts of a robot are while it stands in its half-sitting posture.

World frame: origin on the ground midway between the soles, x forward, y left, z up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.contact import Footstep, Side
from mgs.motion_planner.motion_plan import LegReach
from mgs.robot import Robot, midpoint_width
from mgs.robot.limbs import arm_joints, hip_to_ankle_length, leg_joints

STRETCH = 0.97  # part of the length of a straight leg that is used where the gait gives none
MIN_ARM_JOINTS = 3  # with fewer joints an arm cannot move its hand in all three directions


@dataclass(frozen=True, eq=False)
class StandingFigures:
    """Places of the CoM and the hands and orientation of the torso."""

    com: Array  # (3,) [m]
    hands: Array  # (2, 3) left and right [m]; NaN: the arm cannot move this hand freely
    torso: Array  # (4,) quaternion xyzw


def standing_figures(robot: Robot) -> StandingFigures:
    """Places of CoM and hands and the orientation of the torso in the half-sitting posture."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.standing_q)
    com = pin.centerOfMass(robot.model, data, robot.standing_q, False).copy()
    hands = np.array([data.oMf[frame].translation for frame in robot.hand_frames])
    for side in Side:
        if len(arm_joints(robot, side)) < MIN_ARM_JOINTS:
            hands[side] = np.nan
    torso = pin.Quaternion(data.oMf[robot.torso_frame].rotation).coeffs()
    return StandingFigures(com, hands, np.array(torso))


def feet_abreast(robot: Robot, width: float | None = None) -> tuple[Footstep, Footstep]:
    """The left and the right footstep of a robot that stands; the width [m] may be given."""
    width = width or midpoint_width(robot)
    left, right = (Footstep(side, 0.0, 0.5 * side.sign * width, 0.0) for side in Side)
    return left, right


def leg_reach(robot: Robot, stretch: float) -> LegReach:
    """Hips and ankles in the half-sitting posture, and how far apart a leg lets them be.

    `stretch` is the part of the length of a straight leg that is used.
    """
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, robot.standing_q)
    com = pin.centerOfMass(model, data, robot.standing_q, False).copy()
    hips, ankles = np.empty((2, 3)), np.empty((2, 3))
    for side in Side:
        hip, *_, ankle = leg_joints(robot, side)
        hips[side] = data.oMi[hip].translation - com
        ankles[side] = data.oMf[robot.sole_frames[side]].actInv(data.oMi[ankle].translation)
    return LegReach(hips, ankles, stretch * hip_to_ankle_length(robot))
