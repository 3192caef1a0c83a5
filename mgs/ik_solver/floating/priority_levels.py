"""Levels of tasks in strict priority: each works in the null space of those above it.

M. Mistry, J. Nakanishi, G. Cheng and S. Schaal, "Inverse kinematics with floating base and
constraints for full body humanoid robot control", Humanoids 2008. Level 1 comes first:

    projected:  v = sum_i N_i J_i^+ r_i                               (16) and, with other r_i, (18)
    tracking:   v = sum_i (J_i N_i)^+ (r_i - J_i v_(i-1)),   v_(i-1) the sum of the levels before
    N_i = I - Q_i^T Q_i,   N_(i+1) = N_i - Z_i^T Z_i                                            (17)
    Z_i = L_i^-1 J_i N_i,   L_i L_i^T = J_i N_i J_i^T + lambda^2 I

Q_i stacks the Z of the levels before i; its rows are orthonormal as long as lambda = 0. All Z_i lie
in the null space of level 1, damped or not: the form N_A N_AB^lambda of footnote 3. lambda is 0 for
level 1. For a lower level it is 0 until the smallest pivot of J_i N_i J_i^T shows that the level is
about to conflict with those above it.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from scipy.linalg import blas, lapack

from mgs.core.arrays import Array

CONFLICT = 0.02  # lever arm of a lower level below which it conflicts, relative to the robot's size
DEPENDENT = 1e-12  # pivot of rows that depend on each other, relative to the largest squared row


class PriorityLevels:
    """Velocities (or accelerations) that meet stacked tasks in the order of their levels.

    Attributes:
        Q: (m, 6 + n) matrices Z of all levels at the last solution.
        rows: rows of each level.
    """

    def __init__(self, sizes: Sequence[int], nv: int, size: float, projected: bool = False) -> None:
        """Reserve buffers for the largest problem.

        Args:
            sizes: number of rows of each level, 0 for an empty one.
            nv: number of generalised velocities, 6 + n.
            size: a length of the robot [m], to which lever arms are compared.
            projected: use eq. (16) as printed instead of the tracking form.
        """
        bounds = [0, *itertools.accumulate(sizes)]
        self.rows = [slice(start, stop) for start, stop in itertools.pairwise(bounds)]
        self.projected = projected
        self.conflict2 = (CONFLICT * size) ** 2
        self.Q = np.zeros((bounds[-1], nv))
        # LAPACK works on their transposes, which are in Fortran order
        self._M = [np.empty((m, m)) for m in sizes]
        self._across = [np.empty((m, rows.start)) for m, rows in zip(sizes, self.rows, strict=True)]
        self._conflict = 0.0  # of the last level: 0 none, 1 its rows depend on higher ones

    def solve(
        self,
        J: Array,
        rates: Array,
        free: Array,
        bound: float = np.inf,
        behind: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> Array:
        """Generalised velocity (or acceleration) (6 + n,) that meets the levels in their order.

        Args:
            J: (m, 6 + n) Jacobian in the order of the levels.
            rates: (m,) task velocities (or accelerations) to meet.
            free: (6 + n,) motion in the directions that no level determines.
            bound: largest entry that a lower level in full conflict may add, since its solution
                grows without limit there. The bound is widened as the conflict fades.
            behind: lag of each level from 0, none, to 1, which counts as full conflict.

        Raises:
            numpy.linalg.LinAlgError: rows of the first level depend on each other.
        """
        v = np.zeros(J.shape[1])
        for level, rows in enumerate(self.rows):
            if rows.start == rows.stop:
                continue
            L = self._project(level, J[rows])
            if self.projected:
                step = self._projected_step(level, J[rows], rates[rows])
            else:
                rate = np.dot(J[rows], v)
                np.subtract(rates[rows], rate, out=rate)
                step = np.dot(blas.dtrsv(L, rate, lower=1, overwrite_x=1), self.Q[rows])
            if rows.start:
                conflict = max(self._conflict, behind[level])
                step /= max(1.0, conflict * float(np.abs(step).max()) / bound)
            v += step
        v += free
        v -= np.dot(np.dot(self.Q, free), self.Q)
        return v

    def projector(self, level: int) -> Array:
        """Projector N (6 + n, 6 + n) of the levels above `level` at the last solution.

        The level after the last one stands for all levels.
        """
        above = self.Q[: self.rows[level].start] if level < len(self.rows) else self.Q
        return np.eye(self.Q.shape[1]) - above.T @ above

    def _project(self, level: int, J: Array) -> Array:
        """Compute Z of one level into Q; returns its Cholesky factor L in Fortran order."""
        rows, M = self.rows[level], self._M[level]
        K, above = self.Q[rows], self.Q[: rows.start]
        if rows.start:
            np.dot(np.dot(J, above.T, out=self._across[level]), above, out=K)
            np.subtract(J, K, out=K)
        else:
            K[:] = J
        np.dot(K, J.T, out=M)
        L = self._factor(M, is_first=rows.start == 0)
        blas.dtrsm(1.0, L, K.T, side=1, lower=1, trans_a=1, overwrite_b=1)  # K.T is a view of Q
        return L

    def _factor(self, M: Array, is_first: bool) -> Array:
        """Cholesky factor of M + lambda^2 I in Fortran order.

        A pivot is the squared distance of a row from the span of the rows before it. lambda grows
        from 0 as the smallest pivot falls below its limit, so that solutions stay continuous.
        """
        self._conflict = 0.0
        L, info = lapack.dpotrf(M.T, lower=1, clean=0)
        pivot = float(np.diagonal(L).min()) ** 2 if info == 0 else 0.0
        if is_first:
            if not pivot > DEPENDENT * float(np.diagonal(M).max()):
                raise np.linalg.LinAlgError("rows of the first level depend on each other")
            return L
        if pivot < self.conflict2:
            self._conflict = (1.0 - pivot / self.conflict2) ** 2
            M.ravel()[:: len(M) + 1] += self.conflict2 * self._conflict
            L, info = lapack.dpotrf(M.T, lower=1, clean=0)
            if info != 0:
                raise np.linalg.LinAlgError("the task Jacobian is not finite")
        return L

    def _projected_step(self, level: int, J: Array, rates: Array) -> Array:
        """N J^+ rates (6 + n,) of one level, with N the projector of the levels above."""
        M = self._M[level]
        np.dot(J, J.T, out=M)
        L = self._factor(M, is_first=level == 0)
        y, _ = lapack.dpotrs(L, rates, lower=1)
        step = np.dot(y, J)
        above = self.Q[: self.rows[level].start]
        if len(above):
            step -= np.dot(np.dot(above, step), above)
        return step
