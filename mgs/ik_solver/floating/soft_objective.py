"""Quadratic objective of one iteration of ik1 to ik5: soft rows weighed by Q, steps damped by R.

    |J dq - e|_Q^2 + |dq|_R^2 = dq^T H dq + 2 g^T dq + const,   H = J^T Q J + R,   g = -J^T Q e

with, for E the error of the soft rows, v = q - q_prev and step = xdot dt (see
`mgs.ik_solver.hard_soft`),

    ik1 to ik3   J = J_s,               e = E
    ik4          J = J_s + gamma J_v,   e = E + gamma (step - J_s v)
    ik5          both rows one below the other, J_v with weights gamma Q

J_v is the derivative of J_s(q) v by q, which depends on q through v and through J_s. At a stretched
knee J_s vanishes and the dependence through J_s remains; it is included for the CoM.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mgs.core.arrays import Array
from mgs.gait import FarajiParameters
from mgs.ik_solver.floating.parts import Part
from mgs.ik_solver.floating.tasks import BodyTasks


class SoftObjective:
    """Workspace for H (6 + n, 6 + n) and g (6 + n,).

    Attributes:
        H, g: the objective that was set last.
        J: (m, 6 + n) a view of the Jacobian of the soft rows.
        weights: (m, 1) Q, row by row.
    """

    def __init__(
        self, tasks: BodyTasks, soft: Sequence[Part], tuning: FarajiParameters, damping: Array
    ) -> None:
        """Reserve the buffers for the tasks.

        Args:
            tasks: all tasks, the soft ones last.
            soft: parts of the soft tasks.
            tuning: gives the weights of the soft tasks.
            damping: (6 + n,) diagonal of R.
        """
        self.tasks, self.damping, nv = tasks, damping, tasks.J.shape[1]
        size = sum(part.size for part in soft)
        first = tasks.m - size
        self.J = tasks.J[first:]
        weights = [w for part in soft for w in tuning.soft[part.task] * (part.size // 3)]
        self.weights = np.array(weights, dtype=np.float64)[:, None]
        self._J_v = np.empty((size, nv))
        self._coms = [
            (self._J_v[tasks.rows[part].start - first :][: part.size], part.axes)
            for part in soft
            if part.frame is None
        ]
        self.H, self.g = np.zeros((nv, nv)), np.zeros(nv)
        self._diagonal = self.H.ravel()[:: nv + 1]  # a view

    def set(self, error: Array) -> None:
        """Fill H and g for the error (m,) of the soft rows alone."""
        self._set(self.J, error, self.weights)

    def set_with_velocity(
        self, method: int, gamma: float, error: Array, step: Array, q: Array, v: Array | None
    ) -> None:
        """Fill H and g of ik4 or ik5.

        Args:
            method: 4 or 5.
            gamma: weight of the velocity of the soft tasks.
            error: (m,) of the soft rows.
            step: (m,) xdot dt, by which their references move.
            q: (7 + n,) configuration.
            v: (6 + n,) from the configuration of the last sample to q; None: q is that one.
        """
        J_v, lag = self._J_v, step.copy()
        np.copyto(J_v, self.J)
        if v is not None:
            lag -= self.J.dot(v)
            for rows, axes in self._coms:
                rows += self.tasks.com_velocity_derivative(q, v)[axes]
        if method == 4:
            self._set(J_v * gamma + self.J, lag * gamma + error, self.weights)
        else:
            self._set(
                np.concatenate([self.J, J_v]),
                np.concatenate([error, lag]),
                np.concatenate([self.weights, gamma * self.weights]),
            )

    def _set(self, J: Array, error: Array, weights: Array) -> None:
        QJ = weights * J
        np.dot(J.T, QJ, out=self.H)
        self._diagonal += self.damping
        np.dot(error, QJ, out=self.g)
        np.negative(self.g, out=self.g)
