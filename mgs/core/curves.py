"""Smooth curves through points at given times: quintic pieces between knots.

Position and speed of every knot are given and its acceleration is zero, so that a curve is twice
differentiable. Between two knots (p0, v0) and (p1, v1) that are h apart, at s = (t - t0) / h, a
piece is the Bezier curve of six control points:

    p(s) = sum_j B_j(s) c_j        B_j(s) = binomial(5, j) s^j (1 - s)^(5 - j)
    c    = (p0,  p0 + h v0 / 5,  p0 + 2 h v0 / 5,  p1 - 2 h v1 / 5,  p1 - h v1 / 5,  p1)

Between knots at rest that is the minimum-jerk motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from mgs.core.arrays import Array
from mgs.core.short_repr import short_repr

BINOMIALS = (1.0, 5.0, 10.0, 10.0, 5.0, 1.0)  # of degree 5


@dataclass(frozen=True, eq=False)
class Knots:
    """Points of a curve with d coordinates, and its speeds there."""

    times: Array  # (m,) rising [s]
    points: Array  # (m, d)
    speeds: Array  # (m, d) [1/s]

    __repr__ = short_repr


def at_rest(times: ArrayLike, points: ArrayLike) -> Knots:
    """Knots at times (m,) [s] and points (m, d), at each of which the curve is at rest."""
    points = np.asarray(points, dtype=float)
    return Knots(np.asarray(times, dtype=float), points, np.zeros_like(points))


def evaluate(knots: Knots, times: ArrayLike) -> Array:
    """Points (N, d) of the curve at times (N,) [s]; it stands still outside its knots.

    Of several knots at the same time the first one counts.
    """
    first = np.concatenate([[True], np.diff(knots.times) > 0.0])
    at, points, speeds = knots.times[first], knots.points[first], knots.speeds[first]
    t = np.clip(np.atleast_1d(times), at[0], at[-1])
    if len(at) == 1:
        return np.repeat(points, len(t), axis=0)
    i = np.clip(np.searchsorted(at, t, side="right") - 1, 0, len(at) - 2)  # piece of each time
    h = (at[i + 1] - at[i])[:, None]
    s = (t - at[i])[:, None] / h
    start, leaves = points[i], points[i] + speeds[i] / 5.0 * h
    end, arrives = points[i + 1], points[i + 1] - speeds[i + 1] / 5.0 * h
    control = (start, leaves, 2.0 * leaves - start, 2.0 * arrives - end, arrives, end)
    curve = np.zeros_like(start)
    for j, (factor, point) in enumerate(zip(BINOMIALS, control, strict=True)):
        curve += factor * np.float_power(s, j) * np.float_power(1.0 - s, 5 - j) * point
    return curve
