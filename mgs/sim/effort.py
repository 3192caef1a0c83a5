"""Servo torques of every simulation step, condensed as they come."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array

SATURATED = 0.999  # of the stall torque


class Effort:
    """Peak, root mean square and saturation of the torques of n servos.

    Kept per step, not per sample: a servo that chatters between its limits 10 times a sample would
    otherwise look calm or saturated by chance.
    """

    def __init__(self, stall: Array, dt: float) -> None:
        """Begin with stall torques (n,) [N m] and the simulation step [s]."""
        self.peak = np.zeros_like(stall)  # (n,) largest magnitude [N m]
        self._stall, self._dt = stall, dt
        self._n_steps = 0
        self._squares = np.zeros_like(stall)
        self._run = np.zeros(len(stall), dtype=np.intp)
        self._longest = np.zeros(len(stall), dtype=np.intp)
        self._end = np.zeros(len(stall), dtype=np.intp)

    def add(self, torque: Array, saturated: NDArray[np.bool_] | None = None) -> None:
        """Take in the torques (k, n) of the next steps [N m].

        Args:
            torque: of the servos.
            saturated: where (k, n) they are at a limit; None: where they are at stall torque.
        """
        magnitude = np.abs(torque)
        self._squares += np.square(torque).sum(axis=0)
        self.peak = np.maximum(self.peak, magnitude.max(axis=0))
        if saturated is None:
            saturated = magnitude >= SATURATED * self._stall
        if saturated.any():
            self._follow(saturated)
        else:
            self._run[:] = 0
        self._n_steps += len(torque)

    def _follow(self, saturated: NDArray[np.bool_]) -> None:
        """Go on with the times in a row at the limit through steps (k, n)."""
        step = np.arange(1, len(saturated) + 1)[:, None]
        free = np.maximum.accumulate(np.where(saturated, 0, step), axis=0)  # last one, 0: none
        run = step - free + np.where(free == 0, self._run, 0)
        longest, first = run.max(axis=0), run.argmax(axis=0)
        longer = longest > self._longest
        self._end[longer] = self._n_steps + 1 + first[longer]
        self._longest[longer] = longest[longer]
        self._run = run[-1]

    @property
    def rms(self) -> Array:
        """Root mean square over time (n,) [N m]."""
        return np.asarray(np.sqrt(self._squares / max(self._n_steps, 1)), dtype=np.float64)

    @property
    def saturation(self) -> Array:
        """Longest time in a row at the limit (n,) [s]."""
        return np.asarray(self._longest * self._dt, dtype=np.float64)

    @property
    def saturation_end(self) -> Array:
        """When that time was over (n,), since the first step [s]."""
        return np.asarray(self._end * self._dt, dtype=np.float64)
