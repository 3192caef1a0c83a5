"""Transforms between the links of a robot along a motion, as tf wants them.

The pose of a link in its parent link is T_parent_joint * T_joint(q): a constant placement and the
motion of one joint along or about its own axis. For the rotation that is, as quaternions,

    quat(q) = quat_0 * (axis sin(q/2), cos(q/2)) = cos(q/2) quat_0 + sin(q/2) (quat_0 * (axis, 0))

so every link costs two constant quaternions and a few array operations for all samples.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.robot import Robot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinkTree:
    """Links as tf frames: the root link, J links moved by joints, K links fixed to another."""

    root: str
    moving: tuple[tuple[str, str], ...]  # parent and child link
    fixed: tuple[tuple[str, str], ...]
    fixed_poses: Array  # (K, 7) of the child in the parent: x, y, z, quaternion xyzw
    index: NDArray[np.intp]  # (J,) of the joint in q
    position: Array  # (J, 3) at q = 0 [m]
    slide: Array  # (J, 3) change of the position with q; zero for a revolute joint
    quat: Array  # (J, 4) at q = 0
    turn: Array  # (J, 4) quat * (axis, 0)
    half: Array  # (J,) half angle per q: 1/2, or 0 for a prismatic joint

    def poses(self, q: Array) -> Array:
        """Poses (N, J, 7) of the moving links in their parents at q (N, nq)."""
        q = q[:, self.index, None]  # (N, J, 1)
        angle = self.half[:, None] * q
        out = np.empty((len(q), len(self.index), 7))
        np.multiply(self.slide, q, out=out[..., :3])
        out[..., :3] += self.position
        np.multiply(self.quat, np.cos(angle), out=out[..., 3:])
        out[..., 3:] += self.turn * np.sin(angle)
        return out


def link_tree(robot: Robot) -> LinkTree:
    """Links and the constants of their joints, from the model."""
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
    columns = zip(*joints, strict=True) if joints else ((),) * 6
    index, position, slide, quat, turn, half = (np.array(column) for column in columns)
    return LinkTree(
        root=root,
        moving=tuple((parents[b.name].name, b.name) for b in moving),
        fixed=tuple((parents[b.name].name, b.name) for b in fixed),
        fixed_poses=np.array(fixed_poses).reshape(-1, 7),
        index=index.astype(np.intp),
        position=position.reshape(-1, 3),
        slide=slide.reshape(-1, 3),
        quat=quat.reshape(-1, 4),
        turn=turn.reshape(-1, 4),
        half=half,
    )


def _joint_constants(
    model: pin.Model, joint: int, parent: pin.Frame
) -> tuple[int, Array, Array, Array, Array, float]:
    """What a link's pose in its parent needs: index, position, slide, quat, turn, half."""
    kind = model.joints[joint]
    data = kind.createData()
    kind.calc(data, pin.neutral(model))
    slide, axis = np.array(data.S).reshape(6)[:3], np.array(data.S).reshape(6)[3:]
    placement = parent.placement.actInv(model.jointPlacements[joint])
    quat = pin.SE3ToXYZQUAT(placement)[3:]
    turn = (pin.Quaternion(quat) * pin.Quaternion(np.append(axis, 0.0))).coeffs()
    half = 0.5 if axis.any() else 0.0
    return kind.idx_q, placement.translation, placement.rotation @ slide, quat, turn, half
