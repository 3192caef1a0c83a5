"""The height of the CoM above uneven ground: as high as asked, and as low as the legs need.

The hips are assumed to stand above the ZMP as they stand above the CoM at rest. The CoM follows the
ZMP: when the rear foot is about to lift off, the CoM is less far ahead of it than the ZMP, so that
the legs need less length than assumed.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.geometry import rotate_planar
from mgs.motion_planner.motion_plan import LegReach

SMOOTHING = 0.4  # duration over which a change of height is spread [s]
N_SMOOTHINGS = 3  # moving averages in a row: each makes the height once more differentiable


def height_within_reach(
    asked: Array, zmp: Array, soles: Array, heading: Array, reach: LegReach, dt: float
) -> Array:
    """Height (N,) of the CoM, at most the one asked for, at which both ankles are in reach [m].

    Args:
        asked: heights (N,) asked for [m].
        zmp: ZMP (N, 2), which the CoM follows [m].
        soles: x, y [m], yaw [rad] and height [m] of both soles (N, 2, 4).
        heading: direction (N,) that the body faces [rad].
        reach: largest distance of ankles and hips.
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
    # averages of the minimum over the same span cannot exceed the limit
    height = minimum_filter1d(limit, N_SMOOTHINGS * (width - 1) + 1, mode="nearest")
    for _ in range(N_SMOOTHINGS):
        height = uniform_filter1d(height, width, mode="nearest")
    return np.asarray(height)
