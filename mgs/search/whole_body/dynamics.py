"""Whole-body dynamics along a motion, and their derivatives with respect to all samples.

The derivatives of inverse dynamics are Pinocchio's: J. Carpentier, N. Mansard, "Analytical
derivatives of rigid body dynamics algorithms", Robotics: Science and Systems, 2018. Wrenches of the
soles are in the frame of the sole, so that their cones do not change.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Side
from mgs.search.whole_body.problem import Problem

BASE = slice(0, FLOATING_BASE_NV)
JOINTS = slice(FLOATING_BASE_NV, None)
ON_PLACE = 1e-8  # [m] and [rad] of the soles from their places
MOST_CORRECTIONS = 6


@dataclass(frozen=True, eq=False)
class Point:
    """A motion with the wrenches that bear it."""

    q: Array  # (T, 7 + n)
    w: Array  # (T, 2, 6) in the frames of the soles [N] and [N m]
    v: Array  # (T + 1, 6 + n) from the sample before; v[0] = v[T] = 0
    a: Array  # (T, 6 + n)
    force: Array  # (T, 6 + n) of base and joints that is lacking; 0 at the base: dynamics hold
    off_joints: Array  # (T, n) angles minus those of the plan
    off_torso: Array  # (T, 3) turn of the torso from the plan, in its frame
    off_hands: Array  # (T, 2, 3) places of the hands minus those of the plan

    @property
    def torque(self) -> Array:
        """Torques (T, n) of the servos."""
        return self.force[:, JOINTS]


@dataclass(frozen=True, eq=False)
class Slopes:
    """Derivatives at a point."""

    force: Array  # (3, T, 6 + n, 6 + n) of the force at k by the samples k - 1, k, k + 1
    soles: Array  # (T, 2, 6, 6 + n) Jacobians of the soles, in their frames
    torso: Array  # (T, 3, 6 + n)
    hands: Array  # (T, 2, 3, 6 + n)


def velocities(problem: Problem, q: Array) -> Array:
    """Velocities (T + 1, 6 + n) from each sample before; at rest at both ends."""
    v = np.zeros((len(q) + 1, problem.nv))
    for k in range(1, len(q)):
        v[k] = pin.difference(problem.robot.model, q[k - 1], q[k])
    return v / problem.h


def point_at(problem: Problem, q: Array, w: Array | None = None) -> Point:
    """The motion nearest to q (T, 7 + n) whose soles are in place, borne by wrenches near w.

    Newton steps bring the soles to their places; then the wrenches change as little as the
    dynamics of the base ask for.
    """
    q = on_places(problem, q)
    wrenches = np.zeros((len(q), 2, 6)) if w is None else w.copy()
    v = velocities(problem, q)
    a = (v[1:] - v[:-1]) / problem.h
    force, soles = _forces(problem, q, v[:-1], a, wrenches)
    missing = force[:, BASE]
    on_base = np.where(problem.bears[..., None, None], soles[..., BASE], 0.0)  # (T, 2, 6, 6)
    gram = (on_base.transpose(0, 1, 3, 2) @ on_base).sum(axis=1)
    change = (on_base @ np.linalg.solve(gram, missing[..., None])[:, None])[..., 0]
    wrenches += change
    force -= (change[:, :, None] @ soles)[:, :, 0].sum(axis=1)
    return Point(q, wrenches, v, a, force, *offsets(problem, q))


def on_places(problem: Problem, q: Array) -> Array:
    """The motion after Newton steps that bring the soles to their places; ends do not move."""
    q, model = q.copy(), problem.robot.model
    eye = np.eye(12)
    for _ in range(MOST_CORRECTIONS):
        off, J = soles_of(problem, q)
        off[[0, -1]] = 0.0
        if np.abs(off).max() < ON_PLACE:
            break
        J = J.reshape(len(q), 12, -1)
        step = np.linalg.solve(J @ J.transpose(0, 2, 1) + 1e-10 * eye, off.reshape(-1, 12, 1))
        step = -(J.transpose(0, 2, 1) @ step)[..., 0]
        q = np.array([pin.integrate(model, a, d) for a, d in zip(q, step, strict=True)])
    return q


def soles_of(problem: Problem, q: Array) -> tuple[Array, Array]:
    """Distances (T, 2, 6) of the soles from their places and their derivatives (T, 2, 6, 6 + n)."""
    model, data = problem.robot.model, problem.robot.model.createData()
    off, J = np.empty((len(q), 2, 6)), np.empty((len(q), 2, 6, problem.nv))
    for k in range(len(q)):
        pin.computeJointJacobians(model, data, q[k])
        for side, frame in enumerate(problem.robot.sole_frames):
            gap = problem.places[k][side].actInv(pin.updateFramePlacement(model, data, frame))
            off[k, side] = pin.log6(gap).vector
            J[k, side] = pin.Jlog6(gap) @ pin.getFrameJacobian(model, data, frame, pin.LOCAL)
    return off, J


def _forces(problem: Problem, q: Array, v: Array, a: Array, w: Array) -> tuple[Array, Array]:
    """Forces (T, 6 + n) that are lacking, and Jacobians (T, 2, 6, 6 + n) of the soles."""
    model, data = problem.robot.model, problem.robot.model.createData()
    force, J = np.empty_like(v), np.empty((len(q), 2, 6, problem.nv))
    for k in range(len(q)):
        force[k] = pin.rnea(model, data, q[k], v[k], a[k])
        pin.computeJointJacobians(model, data, q[k])
        for side, frame in enumerate(problem.robot.sole_frames):
            pin.updateFramePlacement(model, data, frame)
            J[k, side] = pin.getFrameJacobian(model, data, frame, pin.LOCAL)
    force -= (w[:, :, None] @ J)[:, :, 0].sum(axis=1)
    force[:, JOINTS] += problem.robot.armature * a[:, JOINTS]
    return force, J


def offsets(problem: Problem, q: Array) -> tuple[Array, Array, Array]:
    """Offsets of q (T, 7 + n) from the plan: joints (T, n), torso (T, 3), hands (T, 2, 3)."""
    robot = problem.robot
    model, data = robot.model, robot.model.createData()
    torso, hands = np.empty((len(q), 3)), np.empty((len(q), 2, 3))
    torsos, places = problem.references
    for k in range(len(q)):
        pin.framesForwardKinematics(model, data, q[k])
        turn = data.oMf[robot.torso_frame].rotation
        torso[k] = pin.log3(torsos[k].rotation.T @ turn)
        for side, frame in enumerate(robot.hand_frames):
            hands[k, side] = data.oMf[frame].translation - places[k][side]
    joints = q[:, FLOATING_BASE_NQ:] - problem.plan[:, FLOATING_BASE_NQ:]
    return joints, torso, hands


def slopes_at(problem: Problem, point: Point) -> Slopes:
    """Derivatives at a point whose soles are in place."""
    robot, h, q = problem.robot, problem.h, point.q
    model, data = robot.model, robot.model.createData()
    n_samples, nv = len(q), problem.nv
    by_q, by_v, by_a = (np.empty((n_samples, nv, nv)) for _ in range(3))
    soles = np.empty((n_samples, 2, 6, nv))
    torso, hands = np.empty((n_samples, 3, nv)), np.empty((n_samples, 2, 3, nv))
    before, after = np.zeros((2, n_samples + 1, 6, 6))  # of the base's part of T v by q_k-1, q_k
    external = [pin.Force.Zero() for _ in range(model.njoints)]
    for k in range(n_samples):
        for side in Side:
            frame = model.frames[robot.sole_frames[side]]
            external[frame.parentJoint] = frame.placement.act(pin.Force(point.w[k, side]))
        pin.computeRNEADerivatives(model, data, q[k], point.v[k], point.a[k], external)
        by_q[k], by_v[k], by_a[k] = data.dtau_dq, data.dtau_dv, data.M
        pin.computeJointJacobians(model, data, q[k])
        for side in Side:
            pin.updateFramePlacement(model, data, robot.sole_frames[side])
            soles[k, side] = pin.getFrameJacobian(model, data, robot.sole_frames[side], pin.LOCAL)
            pin.updateFramePlacement(model, data, robot.hand_frames[side])
            hands[k, side] = pin.getFrameJacobian(
                model, data, robot.hand_frames[side], pin.LOCAL_WORLD_ALIGNED
            )[:3]
        pin.updateFramePlacement(model, data, robot.torso_frame)
        J = pin.getFrameJacobian(model, data, robot.torso_frame, pin.LOCAL)
        torso[k] = pin.Jlog3(pin.exp3(point.off_torso[k])) @ J[3:]
        if k > 0:
            first, second = pin.dDifference(model, q[k - 1], q[k])
            before[k], after[k] = first[BASE, BASE], second[BASE, BASE]
    by_a = np.triu(by_a) + np.triu(by_a, 1).transpose(0, 2, 1)
    on = np.arange(FLOATING_BASE_NV, nv)
    by_a[:, on, on] += robot.armature
    by_step = (by_v - by_a / h) / h  # by h v_k
    by_next = by_a / h**2  # by h v_k+1
    force = np.zeros((3, n_samples, nv, nv))
    force[0, 1:] = _times(by_step[1:], before[1:-1], -1.0)
    force[1] = by_q
    force[1, 1:] += _times(by_step[1:], after[1:-1], 1.0)
    force[1, :-1] += _times(by_next[:-1], before[1:-1], -1.0)
    force[2, :-1] = _times(by_next[:-1], after[1:-1], 1.0)
    return Slopes(force, soles, torso, hands)


def _times(matrices: Array, base: Array, joints: float) -> Array:
    """Matrices (T, p, 6 + n) times blocks: (T, 6, 6) at the base, a multiple of 1 at the joints."""
    product = joints * matrices
    product[..., BASE] = matrices[..., BASE] @ base
    return product


def objective(problem: Problem, point: Point) -> float:
    """The objective at a point, see `mgs.search.whole_body.problem`."""
    weights = problem.weights
    power = np.maximum(point.torque * point.v[:-1, JOINTS], 0.0).sum()
    return problem.h * float(
        0.5 * problem.weight_torque * np.sum(point.torque**2)
        + problem.weight_work * power
        + 0.5 * weights.distance * np.sum(point.off_joints**2)
        + 0.5 * weights.upright * np.sum(point.off_torso**2)
        + 0.5 * weights.hands / problem.leg**2 * np.sum(point.off_hands**2)
    )
