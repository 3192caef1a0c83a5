"""A smooth barrier function of the joint limits that is finite beyond them, too.

    - log s                                            for s > delta
    1/2 ((s - 2 delta) / delta)^2 - 1/2 - log delta    below, twice differentiable in between

where s is the distance of a joint from each of its limits, relative to its range. This is the
relaxed barrier of J. Hauser and A. Saccon, "A barrier function method for the optimization of
trajectory functionals with constraints", CDC 2006, shifted so that it is 0 in mid-range.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array

DELTA = 1e-4


def limit_barrier(q: Array, lower: Array, upper: Array) -> tuple[float, Array, Array]:
    """Sum over all joints of q (..., n), its gradient and its second derivatives (..., n)."""
    width = upper - lower
    low = _wall((q - lower) / width)
    high = _wall((upper - q) / width)
    value = float(np.sum(low[0]) + np.sum(high[0]) + 2.0 * q.size * np.log(0.5))
    return value, (low[1] - high[1]) / width, (low[2] + high[2]) / width**2


def _wall(s: Array) -> tuple[Array, Array, Array]:
    """Value, first and second derivative by the distance s."""
    inside = np.maximum(s, DELTA)
    beyond = np.minimum(s, DELTA) / DELTA - 1.0  # 0 inside
    value = -np.log(inside) - beyond + 0.5 * beyond**2
    return value, (beyond - 1.0) / inside, 1.0 / inside**2
