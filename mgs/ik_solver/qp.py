"""The small quadratic program of one iteration: equalities, and bounds on the joints.

    min 1/2 x^T H x + g^T x   s.t.   A x = b,   low <= x_joints <= high

It is solved by DAQP (D. Arnstroem, A. Bemporad and D. Axehill, "A dual active-set solver for
embedded quadratic programming using recursive LDL^T updates", IEEE Trans. Automatic Control 67(8),
2022), the fastest of the solvers compared on these problems in docs/benchmarks.md.
"""

from __future__ import annotations

import daqp
import eigenpy
import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV

EQUALITY = 5  # DAQP's mark of an equality
FREE = 1e30  # the bound of a free unknown
ELASTIC_WEIGHT = 1e6  # of squared equalities where they contradict the bounds
TOLERANCE = 1e-9  # of DAQP for bounds and equalities
SOLVED = 1  # exit flag of DAQP
SINGULAR = 1e-12  # damping of dependent equalities, relative to the mean curvature


class BoundedQp:
    """Workspace for problems with n unknowns, the base twist first, and m equalities.

    Attributes:
        lam: (n + m,) multipliers of the last solve, bounds first; positive at an upper bound.
        lower, upper: (n + m,) bounds, and below them the right sides of the equalities.
        low, high: (n - 6,) views of the joints' bounds, which the caller fills.
        elastic: whether the equalities of the last problem contradicted its bounds.
    """

    def __init__(self, n: int, m: int) -> None:
        self.n, self.m = n, m
        self.upper, self.lower = np.full(n + m, FREE), np.full(n + m, -FREE)
        self.sense = np.zeros(n + m, np.int32)
        self.sense[n:] = EQUALITY
        self.high, self.low = self.upper[FLOATING_BASE_NV:n], self.lower[FLOATING_BASE_NV:n]
        self.lam = np.zeros(n + m)
        self.elastic = False

    def solve(self, H: Array, g: Array, A: Array, b: Array) -> Array:
        """Minimiser (n,) for the bounds in `low` and `high`.

        Where bounds and equalities contradict each other, the equalities are met in the
        least-squares sense as far as the bounds permit.

        Raises:
            ArithmeticError: DAQP finds no minimiser.
        """
        self.upper[self.n :] = b
        self.lower[self.n :] = b
        x, _, flag, info = daqp.solve(
            H, g, A, self.upper, self.lower, self.sense, primal_tol=TOLERANCE
        )
        self.elastic = flag != SOLVED
        if self.elastic:
            return self._solve_elastic(H, g, A, b)
        self.lam = info["lam"]
        return x

    def _solve_elastic(self, H: Array, g: Array, A: Array, b: Array) -> Array:
        n = self.n
        x, _, flag, info = daqp.solve(
            H + ELASTIC_WEIGHT * A.T @ A,
            g - ELASTIC_WEIGHT * A.T @ b,
            np.empty((0, n)),
            self.upper[:n],
            self.lower[:n],
            self.sense[:n],
            primal_tol=TOLERANCE,
        )
        if flag != SOLVED:  # a strictly convex problem with bounds alone has a solution
            raise ArithmeticError(f"DAQP ended with exit flag {flag}")
        self.lam[:n] = info["lam"]
        self.lam[n:] = ELASTIC_WEIGHT * (A @ x - b)
        return x


def kkt_residual(
    H: Array, g: Array, A: Array, b: Array, bounds: Array, x: Array, lam: Array
) -> float:
    """Largest violation of the optimality conditions by x (n,) with multipliers lam (n + m,).

    The conditions are stationarity, feasibility, complementarity and the signs of the multipliers;
    `bounds` (2, n) are the lower and the upper ones.
    """
    n = len(x)
    at_bounds, at_equalities = lam[:n], lam[n:]
    low, high = bounds
    stationarity = H @ x + g + at_bounds + A.T @ at_equalities
    slack = np.where(at_bounds > 0.0, high - x, np.where(at_bounds < 0.0, x - low, 0.0))
    parts = (
        np.abs(stationarity),
        np.abs(A @ x - b),
        np.maximum(low - x, 0.0),
        np.maximum(x - high, 0.0),
        np.abs(at_bounds * slack),
    )
    return float(max(part.max(initial=0.0) for part in parts))


def solve_equality(H: Array, g: Array, A: Array, b: Array) -> Array:
    """Minimiser (n,) without bounds, in closed form: eq. (2) of Faraji and Ijspeert.

    H is positive definite; dependent rows of A are met in the least-squares sense.

    Raises:
        ArithmeticError: H is not positive definite.
    """
    factor = eigenpy.LLT(H)
    if factor.info() != eigenpy.ComputationInfo.Success:
        raise ArithmeticError("H is not positive definite")
    X = factor.solve(np.column_stack([A.T, -g]))
    Y, x = X[:, :-1], X[:, -1]
    S = A @ Y
    S.ravel()[:: len(b) + 1] += SINGULAR * np.trace(S) / len(b)
    inner = eigenpy.LLT(S)
    for _ in range(2):  # the second pass removes the error that the damping of S has left
        x = x + Y @ inner.solve(b - A @ x).ravel()  # eigenpy returns (1, 1) for one row
    return np.asarray(x)
