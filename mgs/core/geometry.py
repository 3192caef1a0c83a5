"""Plane geometry and smooth interpolation; numpy only.

Planar poses are arrays (..., 3) of x [m], y [m], yaw [rad]. Poses in space are arrays (..., 7) of
x, y, z [m] and the quaternion in the order x, y, z, w (Pinocchio's and ROS's order).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from mgs.core.arrays import Array


def compose_planar(pose: ArrayLike, offset: ArrayLike) -> Array:
    """Planar pose (..., 3) reached from `pose` by `offset` given in its own frame."""
    start, step = np.asarray(pose, dtype=float), np.asarray(offset, dtype=float)
    out = np.asarray(start + step)
    out[..., :2] = start[..., :2] + rotate_planar(step[..., :2], start[..., 2])
    return out


def planar_inverse(pose: ArrayLike) -> Array:
    """Planar pose (..., 3) of the frame itself, seen from `pose` given in that frame."""
    x = np.asarray(pose, dtype=float)
    return np.concatenate([-rotate_planar(x[..., :2], -x[..., 2]), -x[..., 2:]], axis=-1)


def planar_middle(poses: ArrayLike) -> Array:
    """Planar pose (..., 3) midway between two poses (..., 2, 7): mean place, mean heading."""
    poses = np.asarray(poses, dtype=float)
    yaw = yaw_from_quat_xyzw(poses[..., 3:])
    mean = yaw[..., 0] + 0.5 * wrap_angle(yaw[..., 1] - yaw[..., 0])
    return np.concatenate([poses[..., :2].mean(axis=-2), mean[..., None]], axis=-1)


def rotate_planar(vector: ArrayLike, yaw: ArrayLike) -> Array:
    """Vectors (..., 2) turned by yaw (...) [rad]."""
    x, y = np.moveaxis(np.asarray(vector, dtype=float), -1, 0)
    c, s = np.cos(yaw), np.sin(yaw)
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def quat_xyzw_from_yaw(yaw: ArrayLike) -> Array:
    """Quaternion (..., 4) of a turn by yaw (...) [rad] about z."""
    half = 0.5 * np.asarray(yaw, dtype=float)
    zero = np.zeros_like(half)
    return np.stack([zero, zero, np.sin(half), np.cos(half)], axis=-1)


def quat_xyzw_from_rpy(angles: ArrayLike) -> Array:
    """Quaternion (..., 4) of roll, pitch, yaw (..., 3) [rad]: R = R_z(yaw) R_y(pitch) R_x(roll)."""
    half = 0.5 * np.asarray(angles, dtype=float)
    turns = []
    for axis in range(3):
        turn = np.zeros((*half.shape[:-1], 4))
        turn[..., axis], turn[..., 3] = np.sin(half[..., axis]), np.cos(half[..., axis])
        turns.append(turn)
    roll, pitch, yaw = turns
    return quat_multiply(yaw, quat_multiply(pitch, roll))


def quat_multiply(quat_a: ArrayLike, quat_b: ArrayLike) -> Array:
    """Product (..., 4) of quaternions: the rotation b, followed by a."""
    a, b = np.asarray(quat_a, dtype=float), np.asarray(quat_b, dtype=float)
    vector = a[..., 3:] * b[..., :3] + b[..., 3:] * a[..., :3] + np.cross(a[..., :3], b[..., :3])
    scalar = a[..., 3] * b[..., 3] - np.sum(a[..., :3] * b[..., :3], axis=-1)
    return np.concatenate([vector, scalar[..., None]], axis=-1)


def slerp(quat_a: ArrayLike, quat_b: ArrayLike, part: ArrayLike) -> Array:
    """Quaternions (..., 4) a part (...) of the shortest way from unit quaternions a to b.

    Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985.
    """
    a, b = np.asarray(quat_a, dtype=float), np.asarray(quat_b, dtype=float)
    s = np.asarray(part, dtype=float)[..., None]
    b = np.where(np.sum(a * b, axis=-1, keepdims=True) < 0.0, -b, b)
    angle = 0.5 * rotation_angles(a, b)[..., None]
    near = angle < 1e-9
    sine = np.where(near, 1.0, np.sin(angle))
    weight_a = np.where(near, 1.0 - s, np.sin((1.0 - s) * angle) / sine)
    weight_b = np.where(near, s, np.sin(s * angle) / sine)
    return np.asarray(weight_a * a + weight_b * b)


def quat_conjugate(quat: ArrayLike) -> Array:
    """Inverses (..., 4) of unit quaternions (..., 4)."""
    return np.asarray(quat, dtype=float) * np.array([-1.0, -1.0, -1.0, 1.0])


def rotate(quat: ArrayLike, vector: ArrayLike) -> Array:
    """Vectors (..., 3) turned by unit quaternions (..., 4)."""
    q, v = np.asarray(quat, dtype=float), np.asarray(vector, dtype=float)
    twice = 2.0 * np.cross(q[..., :3], v)
    return np.asarray(v + q[..., 3:] * twice + np.cross(q[..., :3], twice))


def rotvec_from_quat_xyzw(quat: ArrayLike) -> Array:
    """Rotation vectors (..., 3) [rad] of unit quaternions (..., 4), of length pi at most."""
    q = np.asarray(quat, dtype=float)
    q = np.where(q[..., 3:] < 0.0, -q, q)
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., 3:])
    factor = np.where(sine < 1e-12, 2.0, angle / np.where(sine < 1e-12, 1.0, sine))
    return np.asarray(factor * q[..., :3])


def quat_xyzw_from_rotvec(rotvec: ArrayLike) -> Array:
    """Unit quaternions (..., 4) of rotation vectors (..., 3) [rad]."""
    half = 0.5 * np.asarray(rotvec, dtype=float)
    angle = np.linalg.norm(half, axis=-1, keepdims=True)
    return np.concatenate([np.sinc(angle / np.pi) * half, np.cos(angle)], axis=-1)


def rotations_from_quat_xyzw(quat: ArrayLike) -> Array:
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    x, y, z, w = np.moveaxis(np.asarray(quat, dtype=float), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def rotation_angles(quat_a: ArrayLike, quat_b: ArrayLike) -> Array:
    """Angle (...) [rad] of the rotation between unit quaternions (..., 4); exact near zero."""
    a, b = np.asarray(quat_a, dtype=float), np.asarray(quat_b, dtype=float)
    # the vector part of conj(a) b; its norm is |sin(angle / 2)| and keeps full precision near 0
    vector = a[..., 3:] * b[..., :3] - b[..., 3:] * a[..., :3] - np.cross(a[..., :3], b[..., :3])
    scalar = np.abs(np.sum(a * b, axis=-1))
    return 2.0 * np.arctan2(np.linalg.norm(vector, axis=-1), scalar)


def yaw_from_quat_xyzw(quat: ArrayLike) -> Array:
    """Heading (...) [rad] of the x axis of rotations given as quaternions (..., 4)."""
    x, y, z, w = np.moveaxis(np.asarray(quat, dtype=float), -1, 0)
    return np.arctan2(2 * (x * y + z * w), 1 - 2 * (y * y + z * z))


def wrap_angle(angle: ArrayLike) -> Array:
    """Angle (...) brought into [-pi, pi) [rad]."""
    return (np.asarray(angle, dtype=float) + np.pi) % (2 * np.pi) - np.pi


def quintic(s: ArrayLike) -> Array:
    """Minimum-jerk blend (...) from 0 to 1 for s in [0, 1], at rest at both ends."""
    u = np.clip(np.asarray(s, dtype=float), 0.0, 1.0)
    return u**3 * (10.0 + u * (-15.0 + 6.0 * u))


def cruise(s: ArrayLike, ramp: float) -> Array:
    """Blend (...) from 0 to 1 for s in [0, 1] that moves on steadily between two ramps of speed.

    Speed rises from 0 to 1 / (1 - ramp) by x^2 (3 - 2 x) in a part `ramp` of the way in time, at
    most a half, and falls likewise at the end, so that there is no acceleration at either end. The
    peak is 1.54 times the mean for a ramp of 0.35, where the minimum-jerk blend has 1.875.
    """
    u = np.clip(np.asarray(s, dtype=float), 0.0, 1.0)
    near = np.minimum(u, 1.0 - u)
    x = np.minimum(near / ramp, 1.0)
    gone = (ramp * x**3 * (1.0 - 0.5 * x) + np.maximum(near - ramp, 0.0)) / (1.0 - ramp)
    return np.where(u <= 0.5, gone, 1.0 - gone)


def bump(s: ArrayLike) -> Array:
    """Rise from 0 to 1 at s = 1/2 and back, at rest at both ends: 64 s^3 (1 - s)^3."""
    u = np.clip(np.asarray(s, dtype=float), 0.0, 1.0)
    return (4.0 * u * (1.0 - u)) ** 3


def sole_corners(poses: ArrayLike, length: float, width: float) -> Array:
    """Corners (..., 4, 2), counter-clockwise, of soles at planar poses (..., 3)."""
    poses = np.asarray(poses, dtype=float)
    half = 0.5 * np.array([[length, width], [-length, width], [-length, -width], [length, -width]])
    return poses[..., None, :2] + rotate_planar(half, poses[..., None, 2])


def convex_hull(points: ArrayLike) -> Array:
    """Convex hull (m, 2), counter-clockwise without repeated or collinear points, of (n, 2) points.

    Andrew's monotone chain, Inf. Proc. Letters 9(5), 1979.
    """
    ordered = sorted({(float(x), float(y)) for x, y in np.asarray(points, dtype=float)})
    if len(ordered) < 3:
        return np.array(ordered).reshape(-1, 2)

    def chain(candidates: list[tuple[float, float]]) -> list[tuple[float, float]]:
        hull: list[tuple[float, float]] = []
        for p in candidates:
            while len(hull) > 1 and _cross(hull[-2], hull[-1], p) <= 0.0:
                hull.pop()
            hull.append(p)
        return hull[:-1]

    return np.array(chain(ordered) + chain(ordered[::-1]))


def _cross(o: tuple[float, float], a: tuple[float, float], b: tuple[float, float]) -> float:
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def polygon_margins(points: ArrayLike, polygon: ArrayLike) -> Array:
    """Signed distance (n,) of points (n, 2) to the edge of a convex polygon, positive inside [m].

    `polygon` is (m, 2), m >= 3, counter-clockwise.
    """
    points, polygon = np.asarray(points, dtype=float), np.asarray(polygon, dtype=float)
    edges = np.roll(polygon, -1, axis=0) - polygon
    lengths = np.linalg.norm(edges, axis=1)
    rel = points[:, None, :] - polygon
    inward = (edges[:, 0] * rel[..., 1] - edges[:, 1] * rel[..., 0]) / lengths  # (n, m)
    along = np.clip(np.einsum("nmk,mk->nm", rel, edges) / lengths**2, 0.0, 1.0)
    outside = np.linalg.norm(rel - along[..., None] * edges, axis=-1).min(axis=1)
    inside = inward.min(axis=1)
    return np.where(inside >= 0.0, inside, -outside)


def rectangle_gap(corners_a: ArrayLike, corners_b: ArrayLike) -> float:
    """Widest separating gap [m] between two convex polygons (m, 2); see `rectangle_gaps`."""
    return float(rectangle_gaps(corners_a, corners_b))


def rectangle_gaps(corners_a: ArrayLike, corners_b: ArrayLike) -> Array:
    """Widest separating gaps (...) [m] of convex polygons (..., m, 2); negative on overlap.

    Separating axis theorem: the penetration along the best axis when negative.
    """
    a, b = np.asarray(corners_a, dtype=float), np.asarray(corners_b, dtype=float)
    shape = np.broadcast_shapes(a.shape[:-2], b.shape[:-2])
    edges = [np.roll(corners, -1, axis=-2) - corners for corners in (a, b)]
    along = np.concatenate([np.broadcast_to(e, (*shape, *e.shape[-2:])) for e in edges], axis=-2)
    normals = np.stack([along[..., 1], -along[..., 0]], axis=-1)
    normals = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    pa, pb = a @ np.swapaxes(normals, -1, -2), b @ np.swapaxes(normals, -1, -2)  # (..., m, axes)
    gaps = np.maximum(pb.min(axis=-2) - pa.max(axis=-2), pa.min(axis=-2) - pb.max(axis=-2))
    return np.asarray(gaps.max(axis=-1))
