"""Reserve: stretched limbs that bend ahead of a sample at which a hard task would be missed.

The safety region lets a joint leave its limit slowly: at a distance s from the limit its speed is
at most about qdot_max sqrt(2 s / h), where h is half its range. A limb that is shorter than its
greatest length by kappa s^2 / 2 therefore changes its length at a speed of at most
kappa s qdot_max sqrt(2 s / h), which vanishes at the stretched posture. A solver that looks at one
sample at a time stretches both knees as far as the soft tasks ask for, and when the torso then
rolls on, no step inside the region meets the hard tasks. Motions are generated offline, so the
solver can go back: it repeats the last part of the motion with a lower bound on the bend of
stretched joints, which rises and falls smoothly around the missed sample. The errors of the soft
tasks increase.

The reserve is not part of the method of Faraji and Ijspeert.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array

RAMP = 0.4  # [s] over which the bound rises and falls
HOLD = 0.2  # [s] for which it lasts before and after the missed sample
FIRST, GROWTH, LARGEST = 0.1, 1.4, 0.8  # [rad] first bound, factor of each repetition, last bound
MAX_RETURNS = 100  # in one motion


class Reserve:
    """Lower bound of the bend of stretched joints over the samples of a motion.

    Attributes:
        bend: (N,) bound [rad]; 0: none.
        returns: number of times that the solver went back.
    """

    def __init__(self, n_samples: int, dt: float) -> None:
        self.bend, self.returns, self._dt = np.zeros(n_samples), 0, dt

    def back_from(self, k: int) -> int | None:
        """Raise the bound around a missed sample; returns the sample to go back to.

        Returns None if the bound is as large as it may be, or the solver has gone back too often.
        """
        level = max(FIRST, GROWTH * float(self.bend[k]))
        if level > LARGEST or self.returns >= MAX_RETURNS:
            return None
        t = (np.arange(len(self.bend)) - k) * self._dt
        ramp = np.clip((HOLD + RAMP - np.abs(t)) / RAMP, 0.0, 1.0)
        np.maximum(self.bend, level * 0.5 * (1.0 - np.cos(np.pi * ramp)), out=self.bend)
        self.returns += 1
        return max(0, k - round((HOLD + RAMP) / self._dt))

    def apply(self, k: int, angles: Array, inward: Array, low: Array, high: Array) -> None:
        """Tighten the intervals of stretched joints at a sample, in place.

        An interval that does not reach the bound shrinks to its inner end.

        Args:
            k: sample.
            angles: (m,) angles at which the limbs are stretched [rad].
            inward: (m,) 1 where a limb bends to larger angles, else -1.
            low: (m,) lower ends of the intervals [rad].
            high: (m,) upper ends of the intervals [rad].
        """
        bound = angles + inward * self.bend[k]
        up = inward > 0.0
        low[up] = np.maximum(low, np.minimum(bound, high))[up]
        high[~up] = np.minimum(high, np.maximum(bound, low))[~up]
