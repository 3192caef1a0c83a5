"""Contact rectangle of a foot, from the points of its surface.

The plane of the sole is determined from the convex hull of the foot: among the directions within
30 deg of the vertical, it is normal to the one in which the downward-facing facets have the largest
area. The sole is the bounding rectangle of the points in this plane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array

STEEPEST = np.cos(np.deg2rad(30.0))
SAME_FACE = np.cos(np.deg2rad(3.0))
LAYER = 2e-3  # [m] thickness of the layer of points that belong to the plane of the sole
LEVEL = np.deg2rad(1.0)  # soles with a smaller inclination at rest are treated as level


@dataclass(frozen=True, eq=False)
class Sole:
    """Contact rectangle of a foot."""

    placement: pin.SE3  # pose in the body: centre, x forward, z up
    length: float  # [m]
    width: float  # [m]


def find_sole(points: Array, body_in_base: pin.SE3) -> Sole:
    """Sole of a foot with surface points (N, 3) in its body [m], at the given pose at rest."""
    seen = points @ body_in_base.rotation.T  # points in the axes of the base
    up = _normal(seen)
    x = np.array([1.0, 0.0, 0.0]) - up[0] * up
    x /= np.linalg.norm(x)
    R = np.stack([x, np.cross(up, x), up], axis=1)  # rotation from sole to base axes
    local = seen @ R
    bottom = float(local[:, 2].min())
    flat = local[local[:, 2] <= bottom + LAYER]
    low, high = flat[:, :2].min(axis=0), flat[:, :2].max(axis=0)
    centre = R @ [*(0.5 * (low + high)), bottom]
    placement = pin.SE3(body_in_base.rotation.T @ R, body_in_base.rotation.T @ centre)
    return Sole(placement, float(high[0] - low[0]), float(high[1] - low[1]))


def _normal(points: Array) -> Array:
    """Upward normal (3,) of the plane on which a body with points (N, 3) stands."""
    from scipy.spatial import ConvexHull, QhullError

    vertical = np.array([0.0, 0.0, 1.0])
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):  # fewer than four points, or all in one plane
        return vertical
    corners = points[hull.simplices]
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    down = -hull.equations[:, :3]
    faces = down[:, 2] > STEEPEST
    if not faces.any():
        return vertical
    down, area = down[faces], area[faces]
    together = (down @ down.T > SAME_FACE) @ area
    near = down @ down[int(np.argmax(together))] > SAME_FACE
    normal = (area[near, None] * down[near]).sum(axis=0)
    normal /= np.linalg.norm(normal)
    return vertical if np.arccos(min(1.0, normal[2])) < LEVEL else normal
