"""Smooth curves through points at given times: quintic pieces between knots.

Position and speed of every knot are given, its acceleration is zero, so that a curve is twice
differentiable. Between knots at rest it is the minimum-jerk motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BPoly

from mgs.core.arrays import Array


@dataclass(frozen=True, eq=False)
class Knots:
    """Points of a curve with d coordinates."""

    times: Array  # (m,) rising [s]
    points: Array  # (m, d)
    speeds: Array  # (m, d)


def at_rest(times: ArrayLike, points: ArrayLike) -> Knots:
    """Knots (m,), (m, d) at each of which the curve rests."""
    points = np.asarray(points, dtype=float)
    return Knots(np.asarray(times, dtype=float), points, np.zeros_like(points))


def evaluate(knots: Knots, times: ArrayLike) -> Array:
    """The curve (N, d) at times (N,) [s]; it rests before the first and after the last knot.

    Knots at the same time count as the first of them.
    """
    first = np.concatenate([[True], np.diff(knots.times) > 0.0])
    at, points, speeds = knots.times[first], knots.points[first], knots.speeds[first]
    if len(at) == 1:
        return np.repeat(points, len(np.atleast_1d(times)), axis=0)
    values = np.stack([points, speeds, np.zeros_like(points)], axis=1)  # (m, 3, d)
    return np.asarray(BPoly.from_derivatives(at, list(values))(np.clip(times, at[0], at[-1])))
