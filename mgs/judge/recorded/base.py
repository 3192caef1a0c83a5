"""The base of a robot whose file has joint angles alone: found from the contacts of its soles.

One sole stands still and flat on the floor at every sample: the one that is lower. With the left
sole flat, the height of the right one tells which, and the other way round. In the middle of the
time in which both are level the other sole takes over: it stands where it then is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side
from mgs.core.geometry import (
    quat_multiply,
    quat_xyzw_from_yaw,
    rotations_from_quat_xyzw,
)
from mgs.judge.audit.tree import frame_poses, joint_poses
from mgs.motion.dynamics import place_on_soles
from mgs.robot import Robot

LEVEL = 5e-4  # [m] by which heights of soles differ while both stand


def with_base(robot: Robot, joints: Array) -> Array:
    """Configurations (T, 7 + n) of joint angles (T, n), the soles' middle first at the origin."""
    q = np.zeros((len(joints), FLOATING_BASE_NQ + robot.n))
    q[:, 6], q[:, FLOATING_BASE_NQ:] = 1.0, joints
    poses = joint_poses(robot, q)
    R, p = (
        np.stack(parts, axis=1)
        for parts in zip(*(frame_poses(robot, poses, f) for f in robot.sole_frames), strict=True)
    )
    root = _root(R, p)
    soles = np.zeros((len(joints), 2, 7))
    soles[..., 6] = 1.0
    place = np.zeros(3)  # x, y, yaw of the root sole
    for k in range(len(joints)):
        side = root[k]
        if k and side != root[k - 1]:
            place = _other(place, R[k], p[k], Side(int(root[k - 1])))
        soles[k, side, :2] = place[:2]
        soles[k, side, 3:] = quat_xyzw_from_yaw(place[2])
    placed = place_on_soles(robot, joints, root, soles)
    return _at_origin(robot, placed)


def _root(R: Array, p: Array) -> NDArray[np.int8]:
    """Sole (T,) that stands, of rotations (T, 2, 3, 3) and places (T, 2, 3) seen from the base."""
    down = R[:, :, :, 2]  # the vertical, if this sole is flat, seen from the base
    way = p[:, Side.RIGHT] - p[:, Side.LEFT]
    left_height = -np.sum(way * down[:, Side.RIGHT], axis=1)  # of the left one, the right one flat
    right_height = np.sum(way * down[:, Side.LEFT], axis=1)
    lower = 0.5 * (right_height - left_height)  # positive: the left sole is the lower one
    is_known = np.abs(lower) > LEVEL
    if not is_known.any():
        return np.zeros(len(p), dtype=np.int8)
    k, known = np.arange(len(p)), np.flatnonzero(is_known)
    after = np.searchsorted(known, k).clip(max=len(known) - 1)
    before = (np.searchsorted(known, k, side="right") - 1).clip(min=0)
    earlier = np.abs(k - known[before]) <= np.abs(known[after] - k)
    nearest = np.where(earlier, known[before], known[after])
    return np.where(lower[nearest] > 0.0, Side.LEFT, Side.RIGHT).astype(np.int8)


def _other(place: Array, R: Array, p: Array, side: Side) -> Array:
    """Planar pose (3,) of the other sole at a sample at which `side` stands at a planar pose."""
    stand = rotations_from_quat_xyzw(quat_xyzw_from_yaw(place[2]))
    T = stand @ R[side].T
    way = T @ (p[side.other] - p[side])
    ahead = T @ R[side.other][:, 0]
    return np.array([*(place[:2] + way[:2]), np.arctan2(ahead[1], ahead[0])])


def _at_origin(robot: Robot, q: Array) -> Array:
    """The motion with the middle of the soles at the origin, facing ahead, at its first sample."""
    poses = joint_poses(robot, q[:1])
    soles = [frame_poses(robot, poses, f) for f in robot.sole_frames]
    middle = 0.5 * (soles[0][1][0] + soles[1][1][0])
    ahead = soles[0][0][0, :, 0] + soles[1][0][0, :, 0]
    turn = quat_xyzw_from_yaw(-np.arctan2(ahead[1], ahead[0]))
    moved = q.copy()
    moved[:, :2] -= middle[:2]
    moved[:, :3] = moved[:, :3] @ rotations_from_quat_xyzw(turn).T
    moved[:, 3:7] = quat_multiply(np.broadcast_to(turn, (len(q), 4)), q[:, 3:7])
    return moved
