"""What the whole robot does along a joint trajectory: where its parts are, its ZMP and its torques.

Rigid-body algorithms are Pinocchio's. The robot is taken to be at rest before the first sample and
after the last, so that a trajectory that starts with a jump shows it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV, GRAVITY
from mgs.core.contact import Side
from mgs.core.geometry import rotations_from_quat_xyzw
from mgs.core.short_repr import short_repr
from mgs.robot import Robot, shape_corners


@dataclass(frozen=True, eq=False)
class WholeBodyMotion:
    """Kinematics and inverse dynamics at every sample; world frame, first axis time."""

    q: Array  # (N, 7 + n)
    v: Array  # (N, 6 + n) central differences, 0 at both ends
    a: Array  # (N, 6 + n)
    com: Array  # (N, 3)
    wrench: Array  # (N, 6) force and moment about the world origin that the ground has to exert
    zmp: Array  # (N, 2) multibody ZMP, at the height of the soles as they share the load
    torque: Array  # (N, n) of the servos, their rotors' inertia included, 0 at followers [N m]
    soles: Array  # (N, 2, 7)
    hands: Array  # (N, 2, 7)
    torso: Array  # (N, 7)

    __repr__ = short_repr


def place_on_soles(robot: Robot, joints: Array, root: NDArray[np.int8], soles_ref: Array) -> Array:
    """Configurations (N, 7 + n) of joint angles (N, n) whose root sole stands on its reference.

    Args:
        robot: the robot.
        joints: joint angles (N, n) [rad].
        root: Side (N,) of the sole that stands still.
        soles_ref: poses (N, 2, 7) of the soles in the world.
    """
    model, data = robot.model, robot.model.createData()
    q = np.empty((len(joints), FLOATING_BASE_NQ + robot.n))
    neutral = pin.neutral(model)
    for k in range(len(joints)):
        neutral[FLOATING_BASE_NQ:] = joints[k]
        pin.forwardKinematics(model, data, neutral)
        side = root[k]
        T_base_sole = pin.updateFramePlacement(model, data, robot.sole_frames[side])
        T_world_base = pin.XYZQUATToSE3(soles_ref[k, side]) * T_base_sole.inverse()
        q[k, :FLOATING_BASE_NQ] = pin.SE3ToXYZQUAT(T_world_base)
    q[:, FLOATING_BASE_NQ:] = joints
    align_quaternion_signs(q[:, 3:7])
    return q


def place_lowest(robot: Robot, joints: Array, turns: Array) -> Array:
    """Configurations (N, 7 + n) whose lowest point is on the ground, the base above the origin.

    Args:
        robot: the robot.
        joints: joint angles (N, n) [rad].
        turns: orientations (N, 4) of the base, quaternion xyzw.
    """
    model, geometry = robot.model, robot.geometry
    data, geometry_data = model.createData(), geometry.createData()
    corners = shape_corners(robot.geometry)
    q = np.zeros((len(joints), FLOATING_BASE_NQ + robot.n))
    q[:, 3:7], q[:, FLOATING_BASE_NQ:] = turns, joints
    for row in q:
        pin.updateGeometryPlacements(model, data, geometry, geometry_data, row)
        row[2] = -min(
            float((placement.translation[2] + local @ placement.rotation[2]).min())
            for placement, local in zip(geometry_data.oMg, corners, strict=True)
        )
    return q


def align_quaternion_signs(quat: Array) -> None:
    """Keep neighbouring quaternions (N, 4) in one half space; q and -q are the same rotation."""
    flips = np.sum(quat[1:] * quat[:-1], axis=1) < 0.0
    quat[1:] *= np.where(np.cumsum(flips) % 2 == 1, -1.0, 1.0)[:, None]


def differentiate(robot: Robot, q: Array, dt: float) -> tuple[Array, Array]:
    """Velocities and accelerations (N, 6 + n) of q (N, 7 + n) by central differences.

    At the first and at the last sample the velocity is exactly 0, since the robot is at rest before
    and after: controllers of ros2_control refuse a trajectory whose last point moves. A jump there
    shows in the acceleration.
    """
    forward = np.zeros((len(q) + 1, FLOATING_BASE_NV + robot.n))  # row k: from sample k-1 to k
    for k in range(1, len(q)):
        forward[k] = pin.difference(robot.model, q[k - 1], q[k])
    forward /= dt
    velocity, acceleration = 0.5 * (forward[1:] + forward[:-1]), (forward[1:] - forward[:-1]) / dt
    velocity[0] = velocity[-1] = 0.0
    return velocity, acceleration


def analyse(
    robot: Robot,
    q: Array,
    dt: float,
    load_left: Array,
    payload: Array | None = None,
    pressure: Array | None = None,
) -> WholeBodyMotion:
    """Kinematics, multibody ZMP and joint torques along q (N, 7 + n).

    In double support the contact wrench is shared by `load_left` (N,), the part of the weight on
    the left sole; each sole's centre of pressure is displaced alike, so that together they act at
    the ZMP. On soles of unequal height it lies between them, nearer to the one that carries more. A
    `payload` (N, 2) of point masses in the hands [kg] counts in ZMP and torques; the CoM stays the
    robot's own.

    Centres of pressure (N, 2, 3) that are planned [m] take the place of the centres of the soles.
    The load on them is then shared as the place of the ZMP between them says, since a sole that
    rolls over its edge can bear nowhere else.
    """
    v, a = differentiate(robot, q, dt)
    com, frames = _kinematics(robot, q)
    forces = _inverse_dynamics(robot, q, v, a)
    if payload is not None:
        forces += _payload_forces(robot, q, frames[:, 2:4, :3], dt, payload)
    wrench = _base_wrench_in_world(q, forces[:, :FLOATING_BASE_NV])
    ground = lowest_points(robot, frames[:, :2])
    zmp = zmp_at(wrench, load_left * ground[:, 0] + (1.0 - load_left) * ground[:, 1])
    if pressure is None:
        pressure = frames[:, :2, :3]
    else:
        load_left = _load_between(zmp, pressure, load_left)
    contacts = share_wrench(wrench, zmp, pressure, load_left)
    torque = forces[:, FLOATING_BASE_NV:].copy()
    del forces  # of a long walk these arrays are the most memory that is taken
    torque -= _contact_torques(robot, q, contacts)
    if robot.coupling is not None:
        torque = robot.coupling.at_motors(torque)
    torque += robot.armature * a[:, FLOATING_BASE_NV:]  # the rotors, which are no link's inertia
    soles, hands, torso = frames[:, :2], frames[:, 2:4], frames[:, 4]
    return WholeBodyMotion(q, v, a, com, wrench, zmp, torque, soles, hands, torso)


def _kinematics(robot: Robot, q: Array) -> tuple[Array, Array]:
    """CoM (N, 3) and poses (N, 5, 7) of left and right sole, left and right hand, torso."""
    model, data = robot.model, robot.model.createData()
    ids = (*robot.sole_frames, *robot.hand_frames, robot.torso_frame)
    com, frames = np.empty((len(q), 3)), np.empty((len(q), len(ids), 7))
    for k in range(len(q)):
        com[k] = pin.centerOfMass(model, data, q[k], False)  # also places the joints
        for i, frame in enumerate(ids):
            frames[k, i] = pin.SE3ToXYZQUAT(pin.updateFramePlacement(model, data, frame))
    return com, frames


def _inverse_dynamics(robot: Robot, q: Array, v: Array, a: Array) -> Array:
    """Forces (N, 6 + n) without contacts; the first six act on the base, in its frame."""
    model, data = robot.model, robot.model.createData()
    forces = np.empty_like(v)
    for k in range(len(q)):
        forces[k] = pin.rnea(model, data, q[k], v[k], a[k])
    return forces


def _payload_forces(robot: Robot, q: Array, hands: Array, dt: float, payload: Array) -> Array:
    """Forces (N, 6 + n) that move payloads (N, 2) with hands (N, 2, 3), as `_inverse_dynamics`."""
    model, data = robot.model, robot.model.createData()
    steps = np.zeros((len(q) + 1, 2, 3))  # at rest before the first sample and after the last
    steps[1:-1] = np.diff(hands, axis=0) / dt
    lifting = payload[..., None] * (np.diff(steps, axis=0) / dt + [0.0, 0.0, GRAVITY])
    forces = np.zeros((len(q), FLOATING_BASE_NV + robot.n))
    for k in np.flatnonzero(payload.any(axis=1)):
        pin.computeJointJacobians(model, data, q[k])
        for side, frame in enumerate(robot.hand_frames):
            J = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
            forces[k] += lifting[k, side] @ J[:3]
    return forces


def _base_wrench_in_world(q: Array, wrench: Array) -> Array:
    """Force and moment (N, 6) about the world origin of wrenches (N, 6) in the base frame."""
    R = rotations_from_quat_xyzw(q[:, 3:7])
    force = np.einsum("nij,nj->ni", R, wrench[:, :3])
    moment = np.einsum("nij,nj->ni", R, wrench[:, 3:]) + np.cross(q[:, :3], force)
    return np.concatenate([force, moment], axis=1)


def zmp_at(wrench: Array, height: Array) -> Array:
    """Points (N, 2) at a height (N,) about which wrenches (N, 6) have no horizontal moment."""
    x = height * wrench[:, 0] - wrench[:, 4]
    y = height * wrench[:, 1] + wrench[:, 3]
    return np.column_stack([x, y]) / wrench[:, 2:3]


def lowest_points(robot: Robot, soles: Array) -> Array:
    """Heights (N, 2) of the lowest points of soles at poses (N, 2, 7) [m]."""
    drop = np.empty(soles.shape[:-1])
    for side in Side:
        x, y, z, w = soles[:, side, 3:].T
        spec = robot.sole_spec(side)
        forward, across = 2.0 * np.abs(x * z - y * w), 2.0 * np.abs(y * z + x * w)
        drop[:, side] = 0.5 * (spec.length * forward + spec.width * across)
    return np.asarray(soles[..., 2] - drop)


def _load_between(zmp: Array, pressure: Array, load_left: Array) -> Array:
    """Share (N,) of the left sole: where the ZMP is between the centres of pressure (N, 2, 3).

    Where one sole bears alone by `load_left` (N,) it does so here.
    """
    right = pressure[:, Side.RIGHT, :2]
    way = pressure[:, Side.LEFT, :2] - right
    part = np.sum((zmp - right) * way, axis=1) / np.sum(way**2, axis=1)
    both = (load_left > 0.0) & (load_left < 1.0)
    return np.where(both, np.clip(part, 0.0, 1.0), load_left)


def share_wrench(wrench: Array, zmp: Array, soles: Array, load_left: Array) -> Array:
    """Contact wrenches (N, 2, 6) about the world origin on the soles, which bear at (N, 2, 3)."""
    share = np.stack([load_left, 1.0 - load_left], axis=1)[..., None]  # (N, 2, 1)
    shift = zmp - np.sum(share * soles[..., :2], axis=1)
    pressure = soles.copy()
    pressure[..., :2] += shift[:, None]
    force = share * wrench[:, None, :3]
    moment = np.cross(pressure, force)
    free = wrench[:, 5] - moment[..., 2].sum(axis=1)  # about the vertical
    moment[..., 2] += share[..., 0] * free[:, None]
    return np.concatenate([force, moment], axis=-1)


def _contact_torques(robot: Robot, q: Array, contacts: Array) -> Array:
    """Joint torques (N, n) that the contact wrenches (N, 2, 6) exert."""
    model, data = robot.model, robot.model.createData()
    torque = np.zeros((len(q), robot.n))
    for k in range(len(q)):
        pin.computeJointJacobians(model, data, q[k])
        for side in Side:
            J = pin.getFrameJacobian(model, data, robot.sole_frames[side], pin.WORLD)
            torque[k] += contacts[k, side] @ J[:, FLOATING_BASE_NV:]
    return torque
