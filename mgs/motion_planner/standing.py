"""Where the parts of a robot are while it stands in its half-sitting posture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.robot import Robot

Array = NDArray[np.float64]
LEAST_ARM_JOINTS = 3  # that can place a hand anywhere about a point


@dataclass(frozen=True, eq=False)
class StandingFigures:
    """World frame, origin on the ground midway between the soles."""

    com: Array  # (3,) [m]
    hands: Array  # (2, 3) left and right [m]; NaN: it cannot be moved freely against the torso
    torso: Array  # (4,) quaternion xyzw


def standing_figures(robot: Robot) -> StandingFigures:
    """Figures of the half-sitting posture."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.standing_q)
    com = pin.centerOfMass(robot.model, data, robot.standing_q, False).copy()
    hands = np.array([data.oMf[frame].translation for frame in robot.hand_frames])
    supports, frames = robot.model.supports, robot.model.frames
    trunk = set(supports[frames[robot.torso_frame].parentJoint])
    for side, frame in enumerate(robot.hand_frames):
        arm = set(supports[frames[frame].parentJoint]) - trunk
        if len(arm) < LEAST_ARM_JOINTS:
            hands[side] = np.nan
    torso = pin.Quaternion(data.oMf[robot.torso_frame].rotation).coeffs()
    return StandingFigures(com, hands, np.array(torso))
