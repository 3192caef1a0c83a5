"""Measurements on the runs of the experiments of Mistry et al."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side, Support
from mgs.core.geometry import rotation_angles
from mgs.core.spans import span_starts
from mgs.ik_solver.floating.parts import COM_XY, SOLES
from mgs.ik_solver.floating.tasks import BodyTasks
from mgs.ik_solver.prioritized import Phase, PrioritizedReport
from mgs.pipeline import Stages
from mgs.robot import Robot

WORLD_ALIGNED = pin.LOCAL_WORLD_ALIGNED


def horizontal_com_error(stages: Stages) -> float:
    """Largest horizontal distance of the CoM from its reference [m]."""
    motion = stages.motion
    return float(np.linalg.norm((motion.com - motion.com_ref)[:, :2], axis=1).max())


def sole_error(stages: Stages) -> float:
    """Largest distance [m] or rotation [rad] of a sole from its reference."""
    motion = stages.motion
    gap = np.linalg.norm((motion.soles - motion.soles_ref)[..., :3], axis=-1).max()
    return float(max(gap, rotation_angles(motion.soles[..., 3:], motion.soles_ref[..., 3:]).max()))


def critical_error(stages: Stages) -> float:
    """Largest error of level A [m] or [rad]."""
    return max(horizontal_com_error(stages), sole_error(stages))


def hand_errors(stages: Stages) -> Array:
    """Distance (N,) of the right hand from its reference [m]."""
    motion = stages.motion
    gap = motion.hands[:, Side.RIGHT, :3] - motion.hands_ref[:, Side.RIGHT]
    return np.asarray(np.linalg.norm(gap, axis=1))


def hand_error(stages: Stages) -> float:
    """Largest distance of the right hand from its reference [m]."""
    return float(hand_errors(stages).max())


def drift(stages: Stages, period: float) -> float:
    """Largest change of a joint angle over one period of the motion, in its middle [rad]."""
    angles, n = stages.joints.angles, round(period / stages.tasks.dt)
    middle = len(angles) // 2 - n // 2
    return float(np.abs(angles[middle + n] - angles[middle]).max())


def torso_and_height(stages: Stages) -> tuple[float, float]:
    """Largest turn of the torso [rad] and error of the CoM height [m] against the references."""
    motion, tasks = stages.motion, stages.tasks
    robot = motion.robot
    data, turns = robot.model.createData(), []
    for q, wanted in zip(motion.q, tasks.torso, strict=True):
        pin.framesForwardKinematics(robot.model, data, q)
        R = data.oMf[robot.torso_frame].rotation
        R_ref = pin.Quaternion(*wanted[[3, 0, 1, 2]]).matrix()
        turns.append(np.linalg.norm(pin.log3(R_ref @ R.T)))
    height = np.abs((motion.com - motion.com_ref)[:, 2]).max()
    return float(max(turns)), float(height)


def angle_gap(a: Stages, b: Stages) -> float:
    """Largest difference between the joint angles of two runs [rad]."""
    return float(np.abs(a.joints.angles - b.joints.angles).max())


def peak_joint_speed(stages: Stages) -> float:
    """Largest joint speed from sample to sample [rad/s]."""
    return float(np.abs(np.diff(stages.joints.angles, axis=0)).max() / stages.tasks.dt)


def switch_accelerations(stages: Stages) -> tuple[float, float]:
    """Largest joint acceleration [rad/s^2] at support switches, and at all other samples."""
    tasks, dt = stages.tasks, stages.tasks.dt
    acceleration = np.abs(np.diff(stages.joints.angles, 2, axis=0)).max(axis=1) / dt**2
    near = np.zeros(len(acceleration), bool)
    for switch in span_starts(tasks.support)[1:]:
        near[switch - 2 : switch + 1] = True
    return float(acceleration[near].max()), float(acceleration[~near].max())


def smallest_singular_value(robot: Robot, configurations: Array) -> float:
    """Least singular value of J_A at some configurations (m, 7 + n), rows in m and rad."""
    tasks, least = BodyTasks(robot, (*SOLES, COM_XY)), np.inf
    for q in configurations:
        tasks.update(q)
        least = min(least, float(np.linalg.svd(tasks.J, compute_uv=False)[-1]))
    return least


def edge_rows(robot: Robot, side: Side, points: list[tuple[float, float]]) -> list[Array]:
    """Velocity rows (3, 6 + n) of points (x, y) of a sole in the standing posture."""
    model, data = robot.model, robot.model.createData()
    pin.computeJointJacobians(model, data, robot.standing_q)
    frame = robot.sole_frames[side]
    placement = pin.updateFramePlacement(model, data, frame)
    J = pin.getFrameJacobian(model, data, frame, WORLD_ALIGNED)
    return [J[:3] - pin.skew(placement.rotation @ np.array([x, y, 0.0])) @ J[3:] for x, y in points]


def straight_legs(robot: Robot) -> Array:
    """Configuration (7 + n,) with the joints of both legs at zero."""
    q = robot.standing_q.copy()
    for group in ("left_leg", "right_leg"):
        for name in robot.spec.groups[group]:
            q[FLOATING_BASE_NQ + robot.joint_names.index(name)] = 0.0
    return q


def phases_of(stages: Stages) -> tuple[Phase, ...]:
    """Reported constraints of a run, once for each kind of phase."""
    return stages.joints.report_of(PrioritizedReport).phases


def swing_switches(stages: Stages) -> int:
    """Number of support switches."""
    return len(span_starts(stages.tasks.support != Support.DOUBLE)) - 1
