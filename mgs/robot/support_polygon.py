"""The corners of the soles that bear the robot, and the support polygon: their convex hull.

A sole in support that is level bears on all of its corners. A sole that rolls over its heel or its
toe bears on the edge about which it turns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import CONTACT_TOLERANCE
from mgs.core.contact import Side, Support
from mgs.core.geometry import (
    convex_hull,
    rotations_from_quat_xyzw,
    sole_corners,
    yaw_from_quat_xyzw,
)
from mgs.core.spans import spans
from mgs.robot.robot import Robot


def support_polygon(
    robot: Robot, soles: Array, support: Support, bears: NDArray[np.bool_] | None = None
) -> Array:
    """Corners (m, 2) of the support polygon [m], counter-clockwise, in the world frame.

    Args:
        robot: the robot, whose soles are rectangles.
        soles: poses (2, 7) of the left and the right sole: position [m] and quaternion xyzw.
        support: which of them are in contact.
        bears: (2, 4) corners of the soles that bear where they are in contact; None: the lowest.
    """
    found, corners = corners_of_soles(robot, soles), []
    bears = on_ground(found) if bears is None else bears
    for side in support.sides:
        pose, sole = soles[side], robot.sole_spec(side)
        if bears[side].all():
            planar = [pose[0], pose[1], float(yaw_from_quat_xyzw(pose[3:]))]
            corners.append(sole_corners(planar, sole.length, sole.width))
        else:
            corners.append(found[side, bears[side], :2])
    return convex_hull(np.concatenate(corners))


@dataclass(frozen=True)
class SupportSpan:
    """Samples start <= k < end in which the same corners of the soles bear."""

    start: int
    end: int
    support: Support
    bears: NDArray[np.bool_]  # (2, 4) corners that bear where their sole is in contact


def support_spans(robot: Robot, soles: Array, support: NDArray[np.int8]) -> list[SupportSpan]:
    """Spans that tile the samples of a motion, each with one support polygon.

    Args:
        robot: the robot, whose soles are rectangles.
        soles: poses (N, 2, 7) of the left and the right sole: position [m] and quaternion xyzw.
        support: (N,) values of Support.
    """
    bears = on_ground(corners_of_soles(robot, soles)) | ~in_support(support)[..., None]
    corners = np.packbits(bears.reshape(len(support), 8), axis=1)[:, 0].astype(np.int16)
    codes = corners + 256 * support.astype(np.int16)
    return [
        SupportSpan(start, end, Support(support[start]), bears[start])
        for start, end in spans(codes)
    ]


def in_support(support: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Whether each sole (N, 2) is in support, of values of Support (N,)."""
    alone = np.array([Support.LEFT, Support.RIGHT])
    return np.asarray((support[:, None] == Support.DOUBLE) | (support[:, None] == alone))


def on_ground(corners: Array) -> NDArray[np.bool_]:
    """Whether corners (..., 2, 4, 3) are as low as the lowest one of their sole."""
    z = corners[..., 2]
    return np.asarray(z <= z.min(axis=-1, keepdims=True) + 0.5 * CONTACT_TOLERANCE)


def corners_of_soles(robot: Robot, soles: Array) -> Array:
    """Corners (..., 2, 4, 3) of soles at poses (..., 2, 7) [m]."""
    R = rotations_from_quat_xyzw(soles[..., 3:])
    corners = np.empty((*soles.shape[:-1], 4, 3))
    for side in Side:
        spec = robot.sole_spec(side)
        local = np.zeros((4, 3))
        local[:, :2] = sole_corners(np.zeros(3), spec.length, spec.width)
        turned = np.einsum("...ij,cj->...ci", R[..., side, :, :], local)
        corners[..., side, :, :] = soles[..., side, None, :3] + turned
    return corners
