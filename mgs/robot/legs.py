"""What the joints of a leg cannot do: legs of five joints lack a turn of the sole.

A leg places its sole against the pelvis, six coordinates. With five joints one combination stays
out of reach: the left null vector of the leg's Jacobian. Without hip yaw it is a turn about the
vertical, without ankle roll one about the forward axis. The sole keeps this turn by itself as long
as the pelvis keeps upright (no hip yaw: all pitches add up to zero), or level and straight ahead
(no ankle roll: legs stay parallel); therefore the IK holds the pelvis in place of the turn.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import pinocchio as pin

from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.robot.limbs import leg_joints
from mgs.robot.robot import Robot

FULL_LEG = 6  # joints that can place a sole anywhere


Turn = Literal["roll", "yaw"]


def missing_turn(robot: Robot) -> Turn | None:
    """Turn of the soles that the legs lack; None of legs with six joints or more.

    Raises:
        ConfigError: they lack pitch or more than one turn, so that no sole could be kept level.
    """
    joints = leg_joints(robot, Side.LEFT)
    if len(joints) >= FULL_LEG:
        return None
    data = robot.model.createData()
    pin.computeJointJacobians(robot.model, data, robot.standing_q)
    frame = robot.sole_frames[Side.LEFT]
    J = pin.getFrameJacobian(robot.model, data, frame, pin.LOCAL)
    J = J[:, [int(robot.model.idx_vs[joint]) for joint in joints]]
    axis = int(np.argmax(np.abs(np.linalg.svd(J)[0][3:, -1])))
    if len(joints) < FULL_LEG - 1 or axis == 1:
        names = ", ".join(str(robot.model.names[joint]) for joint in joints)
        raise ConfigError(
            robot.source,
            f"legs of {len(joints)} joints ({names}) cannot keep a sole level where it is put; "
            "all but hip yaw or ankle roll are needed",
        )
    return "roll" if axis == 0 else "yaw"
