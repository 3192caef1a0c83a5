"""Cubic splines through samples at equal intervals, at rest at both ends; numpy and scipy only.

The curve through samples y[0..N-1], h apart, is twice differentiable. Its rates m solve

    m[i-1] + 4 m[i] + m[i+1] = 3 (y[i+1] - y[i-1]) / h        m[0] = m[N-1] = 0

and between two samples it is the cubic that has their values and rates. Where the samples are of a
smooth motion, the error of the rates at the samples is of the order h^4; central differences have
an error of the order h^2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.short_repr import short_repr


@dataclass(frozen=True, eq=False)
class Spline:
    """Samples of a curve with d coordinates, and its rates there."""

    interval: float  # h [s]
    values: Array  # (N, d)
    rates: Array  # (N, d) [1/s]

    __repr__ = short_repr


def spline_at_rest(values: Array, interval: float) -> Spline:
    """Spline through values (N, d) at times 0, h, 2 h ..., whose rate is zero at both ends."""
    rates = np.zeros_like(values)
    if len(values) > 2:
        from scipy.linalg import solve_banded  # a whole motion that is not resampled needs none

        right = 3.0 * (values[2:] - values[:-2]) / interval
        bands = np.ones((3, len(right)))
        bands[1] = 4.0
        rates[1:-1] = solve_banded((1, 1), bands, right)
    return Spline(interval, values, rates)


def evaluate(spline: Spline, times: Array) -> tuple[Array, Array, Array]:
    """Values, rates and second derivatives (m, d) at times (m,); at rest outside the samples."""
    h, y, m = spline.interval, spline.values, spline.rates
    last = len(y) - 1
    if last == 0:
        still = np.repeat(y, len(times), axis=0)
        return still, np.zeros_like(still), np.zeros_like(still)
    u = np.clip(times / h, 0.0, float(last))
    near = np.rint(u)
    u = np.where(np.abs(u - near) < 1e-9, near, u)  # a sample is met exactly
    i = np.minimum(u.astype(np.intp), last - 1)
    s = (u - i)[:, None]
    r = 1.0 - s
    rise = (y[i + 1] - y[i]) / h
    a, b = m[i], m[i + 1]
    value = r * y[i] + s * y[i + 1] + s * r * h * (r * (a - rise) + s * (rise - b))
    rate = r * a + s * b + 3.0 * s * r * (2.0 * rise - a - b)
    second = (6.0 * (r - s) * rise + (6.0 * s - 4.0) * a + (6.0 * s - 2.0) * b) / h
    second[(times < -1e-9 * h) | (times > (last + 1e-9) * h)] = 0.0
    return value, rate, second
