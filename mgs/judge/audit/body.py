"""What the robot does along a motion that is given by positions alone.

Kinematics are arrays over time; inverse dynamics are Pinocchio's, one call per sample.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV, GRAVITY
from mgs.core.contact import Side
from mgs.core.geometry import rotations_from_quat_xyzw, sole_corners
from mgs.core.scene import ground_below
from mgs.core.short_repr import short_repr
from mgs.judge.audit.given import GivenMotion
from mgs.judge.audit.rates import moving_mean, rates, steps
from mgs.judge.audit.shapes import lowest_points
from mgs.judge.audit.tree import JointPoses, centre_of_mass, frame_poses, joint_poses
from mgs.robot import Robot

SMOOTHING_TIME = 0.05  # [s] over which forces are averaged, since rounded positions make them noisy


@dataclass(frozen=True, eq=False)
class Body:
    """Kinematics and dynamics at every sample; world frame, first axis time."""

    steps: Array  # (T - 1, 6 + n) from sample to sample
    v: Array  # (T, 6 + n)
    poses: JointPoses
    com: Array  # (T, 3)
    soles: Array  # (T, 2, 3) centres
    turns: Array  # (T, 2, 3, 3) rotations of the soles
    corners: Array  # (T, 2, 4, 3) of the soles
    clearance: Array  # (T, 2, 4) of these corners above the ground [m]
    heights: Array  # (T, G) of the lowest points of all collision shapes [m]
    force: Array  # (T, 6 + n) inverse dynamics without contacts, smoothed; base in its own frame
    wrench: Array  # (T, 6) that the ground has to exert, about the world origin, smoothed

    __repr__ = short_repr


def body_along(given: GivenMotion, smoothing: float = SMOOTHING_TIME) -> Body:
    """Kinematics and inverse dynamics of a motion of at least three samples.

    Args:
        given: the motion.
        smoothing: time over which forces are averaged [s]; 0: not at all.
    """
    robot, q = given.robot, given.q
    forward = steps(q)
    v, a = rates(forward, given.dt)
    poses = joint_poses(robot, q)
    placed = [frame_poses(robot, poses, robot.sole_frames[side]) for side in Side]
    corners = np.stack([_corners(robot, side, *placed[side]) for side in Side], axis=1)
    ground = ground_below(given.scene.boxes, corners[..., :2])
    force = _inverse_dynamics(robot, q, v, a)
    if given.payload is not None:
        force += _payload(given, poses)
    width = max(1, round(smoothing / given.dt))
    force = moving_mean(force, width)
    return Body(
        steps=forward,
        v=v,
        poses=poses,
        com=centre_of_mass(robot, poses),
        soles=np.stack([p for _, p in placed], axis=1),
        turns=np.stack([R for R, _ in placed], axis=1),
        corners=corners,
        clearance=corners[..., 2] - ground[..., None],
        heights=lowest_points(robot, poses),
        force=force,
        wrench=_in_world(q, force[:, :FLOATING_BASE_NV]),
    )


def _corners(robot: Robot, side: Side, R: Array, p: Array) -> Array:
    """Corners (T, 4, 3) of a sole."""
    spec = robot.sole_spec(side)
    local = np.zeros((4, 3))
    local[:, :2] = sole_corners(np.zeros(3), spec.length, spec.width)
    return np.asarray(p[:, None] + local @ R.transpose(0, 2, 1))


def _inverse_dynamics(robot: Robot, q: Array, v: Array, a: Array) -> Array:
    model, data = robot.model, robot.model.createData()
    force = np.empty_like(v)
    for k in range(len(q)):
        force[k] = pin.rnea(model, data, q[k], v[k], a[k])
    force[:, FLOATING_BASE_NV:] += robot.armature * a[:, FLOATING_BASE_NV:]
    return force


def _payload(given: GivenMotion, poses: JointPoses) -> Array:
    """Forces (T, 6 + n) that carry the payload; its accelerations are those of the hands."""
    assert given.payload is not None
    robot, force = given.robot, np.zeros((given.n_samples, FLOATING_BASE_NV + given.robot.n))
    model, data = robot.model, robot.model.createData()
    for side in Side:
        _, p = frame_poses(robot, poses, robot.hand_frames[side])
        lift = rates(np.diff(p, axis=0), given.dt)[1] + [0.0, 0.0, GRAVITY]
        for k in np.flatnonzero(given.payload[:, side]):
            pin.computeJointJacobians(model, data, given.q[k])
            J = pin.getFrameJacobian(model, data, robot.hand_frames[side], pin.LOCAL_WORLD_ALIGNED)
            force[k] += given.payload[k, side] * lift[k] @ J[:3]
    return force


def _in_world(q: Array, wrench: Array) -> Array:
    """Force and moment (T, 6) about the world origin of wrenches (T, 6) in the base frame."""
    R = rotations_from_quat_xyzw(q[:, 3:7])
    force = np.einsum("tij,tj->ti", R, wrench[:, :3])
    moment = np.einsum("tij,tj->ti", R, wrench[:, 3:]) + np.cross(q[:, :3], force)
    return np.concatenate([force, moment], axis=1)
