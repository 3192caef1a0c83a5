"""Coupled joints as equalities of a quadratic program, beside those of the hard tasks.

q_follower + dq_follower - multiplier (q_leader + dq_leader) = offset
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.robot import Robot


class CoupledRows:
    """Rows C (f, 6 + n) of the equalities; none for a robot whose joints all have a motor.

    Attributes:
        n: number f of followers.
    """

    def __init__(self, robot: Robot) -> None:
        self._coupling = coupling = robot.coupling
        self.n = 0 if coupling is None else len(coupling.followers)
        self._C, self._offsets = np.zeros((self.n, robot.model.nv)), np.zeros(self.n)
        if coupling is not None:
            rows = np.arange(self.n)
            self._C[rows, FLOATING_BASE_NV + coupling.followers] = 1.0
            self._C[rows, FLOATING_BASE_NV + coupling.leaders] = -coupling.multipliers
            self._offsets = coupling.offsets

    def below(self, A: Array, b: Array, joints: Array | None = None) -> tuple[Array, Array]:
        """A (m, 6 + n) and b (m,) with the rows of coupled joints below.

        `joints` (n,) are the angles that the step starts from [rad]; None: from where they belong.
        """
        if not self.n:
            return A, b
        off = 0.0 if joints is None else self._offsets - self._C[:, FLOATING_BASE_NV:] @ joints
        return np.vstack([A, self._C]), np.concatenate([b, np.zeros(self.n) + off])

    def complete(self, joints: Array) -> None:
        """Remove what rounding has left of the error of followers in joints (..., n), in place."""
        if self._coupling is not None:
            self._coupling.complete(joints)
