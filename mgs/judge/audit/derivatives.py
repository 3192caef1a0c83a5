"""Stated velocities against the derivative of the positions, by the rule that comes nearest.

Which rule of differences a file used is not known: central, forward and backward differences are
tried, and the derivative of a cubic spline, whose error is of the fourth order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.short_repr import short_repr
from mgs.judge.audit.smoothness import noise

TYPICAL = 0.99  # of the samples count; the others may be those at a jump


@dataclass(frozen=True, eq=False)
class Comparison:
    """Stated velocities and those of the positions."""

    scale: float  # stated divided by derived, or the one that was given
    mismatch: float  # of stated and scaled derived ones, in parts of the root mean square
    errors: Array  # (T,) norms of stated minus scaled derived velocities
    speed: float  # root mean square of the derived ones
    rounding: float  # what the rounding of the positions makes of them, in the same parts
    top: float  # largest norm of a stated velocity other than the first and the last one

    __repr__ = short_repr

    def stands_out(self, k: int) -> bool:
        """Whether the error at sample k is many times what it is elsewhere."""
        return bool(self.errors[k] > 5.0 * np.quantile(self.errors[1:-1], 0.95))


def compare(
    stated: Array, forward: Array, positions: Array, dt: float, scale: float | None = None
) -> Comparison:
    """The comparison with that rule of differences which comes nearest.

    Args:
        stated: (T, m) velocities.
        forward: (T - 1, m) steps divided by the period.
        positions: (T, m) for the spline.
        dt: the period [s].
        scale: stated divided by derived velocities where it is known; None: the best one.
    """
    found = [_compared(stated, derived, scale) for derived in _derivatives(forward, positions, dt)]
    scale, mismatch, errors, speed = min(found, key=lambda one: one[1])
    rough = float(np.linalg.norm(np.sqrt(np.mean(noise(forward, dt) ** 2, axis=0))))
    top = float(np.linalg.norm(stated[1:-1], axis=1).max())
    return Comparison(scale, mismatch, errors, speed, rough / max(speed, 1e-12), top)


def _compared(
    stated: Array, derived: Array, scale: float | None
) -> tuple[float, float, Array, float]:
    v, d = stated[1:-1], derived[1:-1]
    gap = np.linalg.norm(v - d, axis=1)
    weight = (gap <= np.quantile(gap, TYPICAL)).astype(float)
    power = float(np.sum(weight * np.sum(d * d, axis=1)))
    if scale is None:
        scale = float(np.sum(weight * np.sum(v * d, axis=1))) / power if power > 0.0 else 1.0
    errors = np.linalg.norm(stated - scale * derived, axis=1)
    speed = float(np.sqrt(np.mean(np.sum(d * d, axis=1))))
    mismatch = float(np.sqrt(np.mean(weight * errors[1:-1] ** 2))) / max(speed, 1e-12)
    return scale, mismatch, errors, speed


def _derivatives(forward: Array, positions: Array, dt: float) -> list[Array]:
    """Derivatives (T, m) by four rules."""
    from scipy.interpolate import CubicSpline  # takes long to load, and few files state velocities

    ahead = np.concatenate([forward, forward[-1:]])
    behind = np.concatenate([forward[:1], forward])
    spline = CubicSpline(dt * np.arange(len(positions)), positions)
    return [0.5 * (ahead + behind), ahead, behind, np.asarray(spline(spline.x, 1))]
