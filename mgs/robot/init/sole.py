"""The rectangle on which a foot stands, from the points of its surface.

Of the facets of the foot's convex hull those that face down together make the plane of the sole:
the direction with the largest area within 30 deg of the vertical. The rectangle bounds the points
that lie in this plane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array

STEEPEST = np.cos(np.deg2rad(30.0))
SAME_FACE = np.cos(np.deg2rad(3.0))
LAYER = 2e-3  # [m] thickness of what counts as the plane of the sole
LEVEL = np.deg2rad(1.0)  # below that a sole is taken as level at rest


@dataclass(frozen=True, eq=False)
class Sole:
    """Contact rectangle of a foot."""

    placement: pin.SE3  # in the body: centre, x forward, z up
    length: float  # [m]
    width: float  # [m]


def find_sole(points: Array, body_in_base: pin.SE3) -> Sole:
    """Sole of a foot with surface points (N, 3) in the body's frame, at rest where it is given."""
    seen = points @ body_in_base.rotation.T  # in the axes of the base
    up = _normal(seen)
    x = np.array([1.0, 0.0, 0.0]) - up[0] * up
    x /= np.linalg.norm(x)
    R = np.stack([x, np.cross(up, x), up], axis=1)  # base from sole
    local = seen @ R
    bottom = float(local[:, 2].min())
    flat = local[local[:, 2] <= bottom + LAYER]
    low, high = flat[:, :2].min(axis=0), flat[:, :2].max(axis=0)
    centre = R @ [*(0.5 * (low + high)), bottom]
    placement = pin.SE3(body_in_base.rotation.T @ R, body_in_base.rotation.T @ centre)
    return Sole(placement, float(high[0] - low[0]), float(high[1] - low[1]))


def _normal(points: Array) -> Array:
    """Upward normal (3,) of the plane on which points (N, 3) would stand."""
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
