"""The joint step of least norm that meets the tasks, beside a given step in their null space.

    step = v + J^T y,   (J J^T + damping^2 I) y = error - J v

J (m, n) has full row rank, so that this is J^+ error + (I - J^+ J) v up to the damping, and one
Cholesky factor of an (m, m) matrix is all it takes. The vector v is kept as a row below J: then one
product gives both J J^T and J v, and another one gives the step.
"""

from __future__ import annotations

import eigenpy
import numpy as np

from mgs.core.arrays import Array


class LeastNorm:
    """Workspace for one Jacobian.

    Attributes:
        v: (n,) a view of the last row, the step to project; [rad].
    """

    def __init__(self, rows: Array, damping: float) -> None:
        """Reserve the buffers for one Jacobian.

        Args:
            rows: (m + 1, n) the Jacobian J, which somebody else refills, and below it the row of v.
            damping: Levenberg term, in the unit of J.
        """
        m = len(rows) - 1
        self._rows, self._J_T, self.v = rows, rows[:m].T, rows[m]
        self._products = np.empty((m + 1, m))
        self._A, self._Jv = self._products[:m], self._products[m]
        self._damping2 = damping**2 * np.eye(m)
        self._factor = eigenpy.LLT(m)
        self._y = np.ones(m + 1)  # its last entry stays 1, the factor of v

    def step(self, error: Array, extra_damping2: float = 0.0) -> Array:
        """The step (n,) [rad] for a task error (m,); `extra_damping2` adds to damping^2.

        An error or a Jacobian that is not finite gives a step that is not finite.
        """
        np.dot(self._rows, self._J_T, self._products)
        self._A += self._damping2
        if extra_damping2:
            self._A += extra_damping2 * np.eye(len(self._A))
        self._y[:-1] = self._factor.compute(self._A).solve(error - self._Jv)
        return self._y.dot(self._rows)

    def add_below(self, step: Array, J_low: Array, error: Array, damping: float) -> Array:
        """The last step (n,), extended in the null space of J towards a task of lower priority.

            step + B^T (B B^T + damping^2 I)^-1 (error - J_low step),   B = J_low (I - J^+ J)

        Args:
            step: what `step` returned.
            J_low: (l, n) Jacobian of the lower task.
            error: (l,) its error.
            damping: where B is smaller than this, in the unit of J, the lower task is left alone.
        """
        B = self.project(J_low)
        A = B.dot(B.T) + damping**2 * np.eye(len(B))
        return np.asarray(step + np.linalg.solve(A, error - J_low.dot(step)).dot(B))

    def project(self, rows: Array) -> Array:
        """Rows (l, n) times I - J^+ J, with the Jacobian of the last step."""
        J = self._rows[:-1]
        return np.asarray(rows - self._factor.solve(J.dot(rows.T)).T.dot(J))
