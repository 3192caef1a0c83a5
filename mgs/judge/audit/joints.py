"""Findings on joints: ranges, speeds and torques against the limits of the robot.

Torques are those of inverse dynamics. Each sole takes its share of the load, and the centres of
pressure of both are displaced alike, as in `mgs.motion.dynamics`; where other parts touch the
ground, or none does, nothing is said of torques.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.contact import Side
from mgs.judge.audit.balance import judged_samples
from mgs.judge.audit.body import Body
from mgs.judge.audit.contacts import Contacts
from mgs.judge.audit.finding import Finding, findings_where
from mgs.judge.audit.given import GivenMotion
from mgs.judge.audit.tree import joint_axes
from mgs.motion.dynamics import share_wrench

ROUNDING = 1e-3  # [rad] that a joint may be outside, since files round their numbers
SPEED_ROUNDING = 1.001  # times the limit
TORQUE_TIME = 0.03  # [s] that a torque has to be too large


def joint_findings(given: GivenMotion, body: Body, contacts: Contacts) -> list[Finding]:
    """Joints outside their ranges, too fast, or in need of too much torque."""
    robot, found = given.robot, []
    outside = np.maximum(robot.lower - given.joints, given.joints - robot.upper)
    speed = np.abs(body.steps[:, FLOATING_BASE_NV:]) / given.dt
    speed_limit = SPEED_ROUNDING * robot.speed_limit
    torque = joint_torques(given, body, contacts)
    available = _available(given, body, torque)
    judged = judged_samples(contacts)
    for j, name in enumerate(robot.joint_names):
        found += findings_where("joint_position", outside[:, j], ROUNDING, given.dt, "rad", name)
        if np.any(speed[:, j] > speed_limit[j]):
            found += findings_where(
                "joint_speed", speed[:, j], robot.speed_limit[j], given.dt, "rad/s", name,
                speed[:, j] > speed_limit[j],
            )  # fmt: skip
        size = np.abs(torque[:, j])
        bad = judged & (size > available[:, j])
        if bad.any():
            found += findings_where(
                "joint_torque", size, available[:, j], given.dt, "N m", name, bad, TORQUE_TIME
            )
    return found


def joint_torques(given: GivenMotion, body: Body, contacts: Contacts) -> Array:
    """Torques (T, n) of the servos [N m]."""
    robot = given.robot
    wrenches = share_wrench(body.wrench, contacts.zmp, body.soles, contacts.load[:, 0])
    torque = body.force[:, FLOATING_BASE_NV:].copy()
    axes, model = joint_axes(robot), robot.model
    for side in Side:
        frame = model.frames[robot.sole_frames[side]]
        force, moment = wrenches[:, side, :3], wrenches[:, side, 3:]
        for joint in list(model.supports[frame.parentJoint])[2:]:
            axis = body.poses.R[joint] @ axes[joint]
            about = moment - np.cross(body.poses.p[joint], force)
            torque[:, model.idx_vs[joint] - FLOATING_BASE_NV] -= np.sum(axis * about, axis=1)
    return torque


def _available(given: GivenMotion, body: Body, torque: Array) -> Array:
    """Torque (T, n) that each servo has at its speed: the line from stall to no-load speed.

    A servo that brakes has its stall torque.
    """
    speed = body.v[:, FLOATING_BASE_NV:]
    line = np.maximum(1.0 - np.abs(speed) / given.robot.no_load_speed, 1e-9)
    return np.where(torque * speed > 0.0, line, 1.0) * given.robot.torque_limit
