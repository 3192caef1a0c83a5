"""Transforms between the links of a robot along a motion, for /tf.

A link has a constant placement in its parent link and is rotated about the axis of its joint by q.
With the quaternion `quat` of the placement,

    quat(q) = quat * (axis sin(q/2), cos(q/2)) = cos(q/2) quat + sin(q/2) (quat * (axis, 0))

so that all samples of a link take a few array operations on two constant quaternions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.robot import Robot


@dataclass(frozen=True)
class LinkTree:
    """Links as tf frames: the root link, J links moved by joints, K links fixed to another."""

    root: str
    moving: tuple[tuple[str, str], ...]  # parent and child link
    fixed: tuple[tuple[str, str], ...]
    fixed_poses: Array  # (K, 7) of the child in the parent: x, y, z, quaternion xyzw
    index: NDArray[np.intp]  # (J,) of the joint in q
    position: Array  # (J, 3) of the placement [m]
    quat: Array  # (J, 4) of the placement
    turn: Array  # (J, 4) quat * (axis, 0)

    def poses(self, q: Array) -> Array:
        """Poses (N, J, 7) of the moving links in their parents at q (N, nq)."""
        half = 0.5 * q[:, self.index, None]  # (N, J, 1)
        out = np.empty((len(q), len(self.index), 7))
        out[..., :3] = self.position
        np.multiply(self.quat, np.cos(half), out=out[..., 3:])
        out[..., 3:] += self.turn * np.sin(half)
        return out


def link_tree(robot: Robot) -> LinkTree:
    """Links of a robot and the constants of their joints."""
    frames = robot.model.frames
    bodies = [frame for frame in frames if frame.type == pin.FrameType.BODY]
    root = next(b.name for b in bodies if frames[b.parentFrame].parentFrame == 0)
    # a frame's parents: the URDF joint that carries the link, then that joint's parent link
    parents = {b.name: frames[frames[b.parentFrame].parentFrame] for b in bodies if b.name != root}
    bodies = [b for b in bodies if b.name != root]
    moving = [b for b in bodies if frames[b.parentFrame].type == pin.FrameType.JOINT]
    fixed = [b for b in bodies if frames[b.parentFrame].type == pin.FrameType.FIXED_JOINT]
    fixed_poses = [pin.SE3ToXYZQUAT(parents[b.name].placement.actInv(b.placement)) for b in fixed]
    joints = [_joint_constants(robot.model, b.parentJoint, parents[b.name]) for b in moving]
    index, position, quat, turn = (np.array(column) for column in zip(*joints, strict=True))
    return LinkTree(
        root=root,
        moving=tuple((parents[b.name].name, b.name) for b in moving),
        fixed=tuple((parents[b.name].name, b.name) for b in fixed),
        fixed_poses=np.array(fixed_poses).reshape(-1, 7),
        index=index,
        position=position,
        quat=quat,
        turn=turn,
    )


def _joint_constants(
    model: pin.Model, joint: int, parent: pin.Frame
) -> tuple[int, Array, Array, Array]:
    """Constants of the pose of a joint's link in its parent: index, position, quat, turn."""
    kind = model.joints[joint]
    data = kind.createData()
    kind.calc(data, pin.neutral(model))
    axis = np.array(data.S).reshape(6)[3:]
    pose = pin.SE3ToXYZQUAT(parent.placement.actInv(model.jointPlacements[joint]))
    turn = (pin.Quaternion(pose[3:]) * pin.Quaternion(np.append(axis, 0.0))).coeffs()
    return kind.idx_q, pose[:3], pose[3:], turn
