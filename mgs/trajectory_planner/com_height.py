"""The height of the CoM: as high as asked, and as low as the legs need.

The hips are assumed to stand above the CoM as they do at rest. Over boxes the ZMP stands for the
CoM: when the rear foot is about to lift off, the CoM is less far ahead of it, so that the legs need
less length than assumed. On level ground the CoM is estimated from the reference of the ZMP: of a
linear inverted pendulum of constant height,

    c - c'' / omega^2 = p        omega^2 = g / com_height

has one solution that stays near the ZMP p, the mean of p weighted by omega / 2 exp(-omega |t|).
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import GRAVITY
from mgs.core.contact import Side
from mgs.core.geometry import rotate, rotate_planar
from mgs.motion_planner.motion_plan import LegReach

SMOOTHING = 0.4  # duration over which a change of height is spread [s]
N_SMOOTHINGS = 3  # moving averages in a row: each makes the height once more differentiable


def height_within_reach(
    asked: Array, com: Array, soles: Array, heading: Array, reach: LegReach, dt: float
) -> Array:
    """Height (N,) of the CoM, at most the one asked for, at which both ankles are in reach [m].

    Args:
        asked: heights (N,) asked for [m].
        com: where the CoM will be (N, 2) [m].
        soles: poses of both soles (N, 2, 7).
        heading: direction (N,) that the body faces [rad].
        reach: largest distance of ankles and hips.
        dt: sampling period [s].
    """
    from scipy.ndimage import minimum_filter1d, uniform_filter1d  # slow to import, rarely needed

    limit = asked.copy()
    for side in Side:
        hip = com + rotate_planar(np.broadcast_to(reach.hips[side, :2], com.shape), heading)
        ankle = soles[:, side, :3] + rotate(soles[:, side, 3:], reach.ankles[side])
        apart = hip - ankle[:, :2]
        rise = np.sqrt(np.maximum(reach.length**2 - np.sum(apart**2, axis=1), 0.0))
        limit = np.minimum(limit, ankle[:, 2] + rise - reach.hips[side, 2])
    width = 2 * max(1, round(0.5 * SMOOTHING / (N_SMOOTHINGS * dt))) + 1
    # averages of the minimum over the same span cannot exceed the limit
    height = minimum_filter1d(limit, N_SMOOTHINGS * (width - 1) + 1, mode="nearest")
    for _ in range(N_SMOOTHINGS):
        height = uniform_filter1d(height, width, mode="nearest")
    return np.asarray(height)


def pendulum_above(zmp: Array, com_height: float, dt: float) -> Array:
    """Horizontal place (N, 2) of a linear inverted pendulum whose ZMP is at (N, 2) [m].

    The ZMP is taken to rest at its first value before, and at its last one afterwards.
    """
    from scipy.signal import lfilter  # slow to import, rarely needed

    decay = float(np.exp(-np.sqrt(GRAVITY / com_height) * dt))
    share, rest = [1.0 - decay], [1.0, -decay]
    before, _ = lfilter(share, rest, zmp, axis=0, zi=decay * zmp[:1])
    after, _ = lfilter(share, rest, zmp[::-1], axis=0, zi=decay * zmp[-1:])
    return np.asarray(0.5 * (before + after[::-1]))
