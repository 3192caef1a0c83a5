"""Distances of points from convex hulls, for many hulls at once.

The distance of a point z from the convex hull of points p_i is, over all directions n,

    max_n [ n . z - max_i n . p_i ]

which `N_DIRECTIONS` of them give within 0.1 %.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array

N_DIRECTIONS = 72


def distance_outside(points: Array, corners: Array, used: NDArray[np.bool_]) -> Array:
    """Distance (T,) of points (T, 2) from the hull of the used ones of corners (T, c, 2) [m].

    Negative inside; minus infinity where no corner is used.
    """
    turn = 2.0 * np.pi * np.arange(N_DIRECTIONS) / N_DIRECTIONS
    n = np.stack([np.cos(turn), np.sin(turn)])  # (2, d)
    reach = np.where(used[..., None], corners @ n, -np.inf).max(axis=1)
    distance = (points @ n - reach).max(axis=1)
    return np.where(used.any(axis=1), distance, -np.inf)
