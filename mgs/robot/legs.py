"""Missing rotation of the sole in legs with five joints.

The pose of a sole relative to the pelvis has six coordinates. A leg with five joints cannot reach
one combination of them: the left null vector of its Jacobian. Without hip yaw this is a rotation
about the vertical axis, without ankle roll a rotation about the forward axis. The sole keeps the
right orientation about this axis if the pelvis stays upright (no hip yaw: all pitch angles sum to
zero), or stays level and faces straight ahead (no ankle roll: the legs stay parallel). Therefore
the inverse kinematics constrains the pelvis instead of this rotation of the sole.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import pinocchio as pin

from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.robot.limbs import leg_joints
from mgs.robot.robot import Robot

FULL_LEG = 6  # number of joints that can reach any pose of a sole


Turn = Literal["roll", "yaw"]


def missing_turn(robot: Robot) -> Turn | None:
    """Rotation of the soles that the legs cannot make; None for legs with six joints or more.

    Raises:
        ConfigError: pitch or more than one rotation is missing, so that soles cannot be kept level.
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
            f"legs of {len(joints)} joints ({names}) cannot keep a sole level; of the six joints "
            "of a leg only hip yaw or ankle roll may be missing",
        )
    return "roll" if axis == 0 else "yaw"
