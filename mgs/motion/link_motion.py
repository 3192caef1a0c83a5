"""Poses and velocities of the links along a motion; kinematics are Pinocchio's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.geometry import quat_conjugate, quat_multiply, rotate
from mgs.core.short_repr import short_repr
from mgs.motion.dynamics import align_quaternion_signs
from mgs.motion.sampled import SampledMotion
from mgs.robot import Robot
from mgs.robot.orders import Links, Order, robot_order
from mgs.robot.urdf_bounds import parse_bounded


@dataclass(frozen=True, eq=False)
class LinkMotion:
    """What B links do in T frames; world frame, SI units."""

    names: tuple[str, ...]  # the root link first
    position: Array  # (T, B, 3) of the origins of the links
    quat_xyzw: Array  # (T, B, 4), neighbours in one half space
    velocity: Array  # (T, B, 3) of the origins
    com_velocity: Array  # (T, B, 3) of the centres of mass
    angular_velocity: Array  # (T, B, 3)

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class _Carried:
    """Links as parts of the bodies of the model that carry them."""

    body: list[int]  # (B,) index of the joint of the model, less one
    offset: Array  # (B, 3) of the link's origin in the body's frame [m]
    quat: Array  # (B, 4) of the link in the body
    com: Array  # (B, 3) centre of mass of the link in the body's frame [m]


def link_motion(
    sampled: SampledMotion, order: Order = "depth-first", links: Links = "moving"
) -> LinkMotion:
    """Poses and velocities of the links of a robot.

    Args:
        sampled: the motion.
        order: the order of the links, see `mgs.robot.orders`.
        links: "all" links of the URDF; or "moving" ones, whose centre of mass is that of the link
            together with all that is fixed to it.
    """
    robot = sampled.robot
    names = robot_order(robot, order, links).links
    poses, twists = _bodies(robot, sampled.q, sampled.v)
    carried = _carried(robot, names, links)
    quat = poses[:, carried.body, 3:]
    linear = rotate(quat, twists[:, carried.body, :3])
    angular = rotate(quat, twists[:, carried.body, 3:])
    arm, com_arm = rotate(quat, carried.offset), rotate(quat, carried.com)
    turned = quat_multiply(quat, np.broadcast_to(carried.quat, quat.shape))
    for link in range(len(names)):
        align_quaternion_signs(turned[:, link])
    return LinkMotion(
        names=names,
        position=poses[:, carried.body, :3] + arm,
        quat_xyzw=turned,
        velocity=linear + np.cross(angular, arm),
        com_velocity=linear + np.cross(angular, com_arm),
        angular_velocity=angular,
    )


def _bodies(robot: Robot, q: Array, v: Array) -> tuple[Array, Array]:
    """Poses (T, J, 7) of the bodies of the model, and twists (T, J, 6) in their own frames."""
    model, data = robot.model, robot.model.createData()
    poses, twists = np.empty((len(q), model.njoints - 1, 7)), np.empty((len(q), robot.n + 1, 6))
    for k in range(len(q)):
        pin.forwardKinematics(model, data, q[k], v[k])
        for j in range(1, model.njoints):
            poses[k, j - 1] = pin.SE3ToXYZQUAT(data.oMi[j])
            twists[k, j - 1] = data.v[j].vector
    return poses, twists


def _carried(robot: Robot, names: tuple[str, ...], links: Links) -> _Carried:
    model = robot.model
    frames = [model.frames[model.getFrameId(name, pin.FrameType.BODY)] for name in names]
    poses = np.array([pin.SE3ToXYZQUAT(frame.placement) for frame in frames])
    bodies = [int(frame.parentJoint) for frame in frames]
    if links == "moving":
        com = np.array([model.inertias[body].lever for body in bodies])
    else:
        own = _link_coms(robot)
        com = poses[:, :3] + rotate(poses[:, 3:], np.array([own[name] for name in names]))
    return _Carried([body - 1 for body in bodies], poses[:, :3], poses[:, 3:], com)


def _link_coms(robot: Robot) -> dict[str, Array]:
    """Centre of mass (3,) of every link in its own frame [m]; its origin if it has no mass."""
    found = {}
    for link in parse_bounded(robot.urdf, robot.source).findall("link"):
        origin = link.find("inertial/origin")
        text = "0 0 0" if origin is None else origin.get("xyz", "0 0 0")
        found[link.get("name", "")] = np.array([float(part) for part in text.split()])
    return found


def sole_links(robot: Robot, names: Sequence[str]) -> tuple[int, int]:
    """Positions in a list of links of the ones that carry the left and the right sole."""
    model = robot.model

    def body(frame: int) -> int:
        return int(model.frames[frame].parentJoint)

    carriers = [body(model.getFrameId(name, pin.FrameType.BODY)) for name in names]
    left, right = (carriers.index(body(frame)) for frame in robot.sole_frames)
    return left, right


def sole_motion(sampled: SampledMotion) -> tuple[Array, Array]:
    """Positions and velocities (T, 2, 3) of the soles, seen from the root link, in its frame.

    The velocity is the derivative of the position as the root link sees it.
    """
    robot = sampled.robot
    poses, twists = _bodies(robot, sampled.q, sampled.v)
    frames = [robot.model.frames[frame] for frame in robot.sole_frames]
    bodies = [int(frame.parentJoint) - 1 for frame in frames]
    quat = poses[:, bodies, 3:]
    arm = rotate(quat, np.array([frame.placement.translation for frame in frames]))
    position = poses[:, bodies, :3] + arm - sampled.base_position[:, None]
    speed = rotate(quat, twists[:, bodies, :3])
    speed += np.cross(rotate(quat, twists[:, bodies, 3:]), arm)
    back = quat_conjugate(sampled.base_quat_xyzw)[:, None]
    seen = rotate(back, position)
    turning = sampled.v[:, None, 3:6]
    moving = rotate(back, speed) - sampled.v[:, None, :3]
    return seen, moving - np.cross(turning, seen)
