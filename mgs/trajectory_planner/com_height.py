"""The height of the CoM above uneven ground: as high as asked, as low as the legs need.

A hip is taken to be where it is at rest above the ZMP, which the CoM follows: when a foot is about
to lift off, far behind, the CoM has not come as far ahead as the ZMP, so that there is room to
spare.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.geometry import rotate_planar
from mgs.motion_planner.motion_plan import LegReach

SMOOTHING = 0.4  # [s] over which the height changes
N_SMOOTHINGS = 3  # by moving averages: the more, the more often differentiable


def height_within_reach(
    asked: Array, zmp: Array, soles: Array, heading: Array, reach: LegReach, dt: float
) -> Array:
    """Height (N,) of the CoM, at most as asked (N,), at which both ankles are within reach.

    Args:
        asked: heights (N,) [m].
        zmp: where the CoM will be, about (N, 2) [m].
        soles: x, y, yaw (N, 2, 3) and, in `soles[..., 3]`, the height of both soles [m].
        heading: (N,) of the body [rad].
        reach: of the legs.
        dt: sampling period [s].
    """
    from scipy.ndimage import minimum_filter1d, uniform_filter1d  # slow to import, rarely needed

    limit = asked.copy()
    for side in Side:
        hip = zmp + rotate_planar(np.broadcast_to(reach.hips[side, :2], zmp.shape), heading)
        sole = soles[:, side]
        ankle = np.broadcast_to(reach.ankles[side, :2], zmp.shape)
        apart = hip - sole[:, :2] - rotate_planar(ankle, sole[:, 2])
        rise = np.sqrt(np.maximum(reach.length**2 - np.sum(apart**2, axis=1), 0.0))
        ankle_height = sole[:, 3] + reach.ankles[side, 2]
        limit = np.minimum(limit, ankle_height + rise - reach.hips[side, 2])
    width = 2 * max(1, round(0.5 * SMOOTHING / (N_SMOOTHINGS * dt))) + 1
    # an average of least values over the same span stays below what it is an average of
    height = minimum_filter1d(limit, N_SMOOTHINGS * (width - 1) + 1, mode="nearest")
    for _ in range(N_SMOOTHINGS):
        height = uniform_filter1d(height, width, mode="nearest")
    return np.asarray(height)
