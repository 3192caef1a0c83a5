"""How far a robot on servos that give way sways to the side when one leg takes its weight.

A servo is a spring here, whose stiffness k goes with its stall torque. On one leg, the hip roll
joint bears the torque tau of trunk and other leg and gives way by tau / k_hip, which moves the
centre of mass (CoM), at height z above the ankle, by e = z tau / k_hip. Hip and ankle roll in a row
have the stiffness K = k_hip k_ankle / (k_hip + k_ankle), so that the robot sways at the angular
frequency w with w^2 = (K - m g z) / (m z^2), and with an amplitude of e its zero-moment point (ZMP)
swings by

    e (1 + w^2 z / g) = e K / (m g z) = (tau / (m g)) k_ankle / (k_hip + k_ankle).

What the servos share of their stiffness, and with it their sag, has dropped out.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mgs.core.constants import FLOATING_BASE_NV, GRAVITY
from mgs.core.contact import Side
from mgs.robot import Robot
from mgs.robot.limbs import leg_joints
from mgs.robot.roles import find_roles


def swing_of_zmp(robot: Robot) -> float:
    """The largest swing of the ZMP, in half widths of the sole; above 1 the sole tips on its edge.

    0 for robots whose legs cannot roll at hip and ankle.
    """
    roles, stall = find_roles(robot), robot.torque_limit
    found = [0.0]
    for side in Side:
        names = [f"{side.label}_{joint}_roll" for joint in ("hip", "ankle")]
        if any(name not in roles for name in names):
            return 0.0
        hip, ankle = (roles[name][0] for name in names)
        arm = _hip_torque(robot, side, hip) / (robot.mass * GRAVITY)
        sole = robot.spec.soles.left if side is Side.LEFT else robot.spec.soles.right
        found.append(arm * stall[ankle] / (stall[hip] + stall[ankle]) / (0.5 * sole.width))
    return float(max(found))


def _hip_torque(robot: Robot, side: Side, hip: int) -> float:
    """Torque of a hip roll joint [N m] that bears all but its leg, with the trunk as at rest.

    `hip` is the place of the joint in the angles.
    """
    model, data, column = robot.model, robot.model.createData(), hip + FLOATING_BASE_NV
    pin.computeJointJacobians(model, data, robot.standing_q)
    pin.centerOfMass(model, data, robot.standing_q, True)
    first = leg_joints(robot, side)[0]
    joint = int(np.flatnonzero(np.asarray(model.idx_vs) == column)[-1])
    axis = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)[3:, column]
    leg = data.mass[first] * data.oMi[first].act(data.com[first])
    rest = data.mass[0] - data.mass[first]
    arm = data.mass[0] * data.com[0] - leg - rest * data.oMi[joint].translation
    return float(abs(axis @ np.cross(arm, [0.0, 0.0, GRAVITY])))
