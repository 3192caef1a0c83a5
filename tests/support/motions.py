"""Motions made by hand for tests of the simulation, so that they need no planner."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

import mgs
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Footstep, Side, Support
from mgs.core.plugins import Origin
from mgs.gait import parse_gait
from mgs.motion import Motion
from mgs.motion.provenance import Provenance
from mgs.robot import Robot

Array = NDArray[np.float64]
DT = 0.01  # [s]


def motion_of(robot: Robot, q: Array) -> Motion:
    """Motion through q (N, 7 + n) on both feet; the fields that no replay looks at are empty."""
    v = np.zeros((len(q), robot.model.nv))
    for k in range(1, len(q) - 1):
        v[k] = pin.difference(robot.model, q[k - 1], q[k + 1]) / (2 * DT)
    data, soles = robot.model.createData(), np.empty((len(q), 2, 7))
    for k, row in enumerate(q):
        pin.framesForwardKinematics(robot.model, data, row)
        soles[k] = [pin.SE3ToXYZQUAT(data.oMf[frame]) for frame in robot.sole_frames]
    none = np.empty((len(q), 0))
    return Motion(
        robot=robot,
        gait=parse_gait("{mgs: 1, motion: walk, walk: {n_steps: 2}}", "a test"),
        gait_name="test",
        dt=DT,
        footsteps=tuple(Footstep(side, *soles[0, side, :2], 0.0) for side in Side),
        support=np.full(len(q), Support.DOUBLE, dtype=np.int8),
        q=q,
        v=v,
        torque=none,
        com=none,
        com_ref=none,
        zmp=none,
        zmp_ref=none,
        soles=soles,
        soles_ref=soles,
        hands=none,
        hands_ref=none,
        torso=none,
        torso_ref=none,
        provenance=Provenance(Origin("none", "mgs", mgs.__version__)),
    )


def standing(robot: Robot, seconds: float) -> Motion:
    """The half-sitting posture."""
    return motion_of(robot, np.tile(robot.standing_q, (round(seconds / DT) + 1, 1)))


def leaning(robot: Robot, angle: float, seconds: float) -> Motion:
    """Both ankles lean the robot forward by an angle [rad], then it waits half as long again."""
    n = round(seconds / DT)
    blend = np.clip(np.arange(n + n // 2 + 1) / n, 0.0, 1.0)
    q = np.tile(robot.standing_q, (len(blend), 1))
    for i, name in enumerate(robot.joint_names):
        if name.endswith("ankle_pitch"):
            q[:, FLOATING_BASE_NQ + i] += angle * blend
    return motion_of(robot, q)


def swaying(robot: Robot, offsets: ArrayLike) -> Motion:
    """The base is displaced by offsets (N, 3) [m] over resting soles."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.standing_q)
    soles = [data.oMf[frame].copy() for frame in robot.sole_frames]
    rows, q = [], robot.standing_q
    for offset in np.asarray(offsets, dtype=float):
        q = q.copy()
        q[:3] = robot.standing_q[:3] + offset
        q = _with_soles_at(robot, data, q, soles)
        rows.append(q)
    return motion_of(robot, np.array(rows))


def _with_soles_at(robot: Robot, data: pin.Data, q: Array, soles: list[pin.SE3]) -> Array:
    """Newton's method on the legs alone, base fixed."""
    for _ in range(20):
        step, largest = np.zeros(robot.model.nv), 0.0
        pin.framesForwardKinematics(robot.model, data, q)
        for frame, target in zip(robot.sole_frames, soles, strict=True):
            J = pin.computeFrameJacobian(robot.model, data, q, frame, pin.LOCAL)
            J[:, :FLOATING_BASE_NV] = 0.0
            error = pin.log6(data.oMf[frame].actInv(target)).vector
            step += np.linalg.pinv(J) @ error
            largest = max(largest, float(np.abs(error).max()))
        if largest < 1e-10:
            return q
        q = pin.integrate(robot.model, q, step)
    raise AssertionError("the test's own inverse kinematics did not converge")
