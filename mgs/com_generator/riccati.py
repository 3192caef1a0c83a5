"""The discrete algebraic Riccati equation of systems with a few states and one input.

    X = A^T X A - A^T X B (R + B^T X B)^-1 B^T X A + Q

A first solution comes from the structure-preserving doubling algorithm of Chu, Fan, Lin and Wang,
"Structure-preserving algorithms for periodic discrete-time algebraic Riccati equations",
International Journal of Control 77(8), 2004. After i steps H is the least cost over 2^i samples:

    W = (I + G H)^-1     A <- A W A     G <- G + A W G A^T     H <- H + A^T H W A

Newton's method takes it to full precision: Hewer, "An iterative technique for the computation of
the steady state gains for the discrete optimal regulator", IEEE Transactions on Automatic Control
16(4), 1971. It needs NumPy alone, because loading `scipy.linalg` for this one equation takes longer
than planning the whole motion.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array

MOST_STEPS = 64  # of each iteration; all of them converge quadratically
PRECISION = 1e-10  # relative change that ends an iteration; the next one would be its square
CHEAP_INPUT = 0.01  # least weight of the input in the doubling, as a part of B^T Q B


def solve_riccati(A: Array, B: Array, Q: Array, R: float) -> Array:
    """Stabilising solution X (n, n) for A (n, n), B (n, 1), Q (n, n) and the weight R > 0.

    Raises:
        numpy.linalg.LinAlgError: there is no stabilising solution that numbers can express.
    """
    with np.errstate(all="ignore"):  # an overflow shows in the result, which is checked
        # G = B R^-1 B^T loses its digits where the input costs next to nothing
        X = _by_doubling(A, B, Q, max(R, CHEAP_INPUT * (B.T @ Q @ B).item()))
        for _ in range(MOST_STEPS):
            gain = (B.T @ X @ A) / (R + B.T @ X @ B)
            last, X = X, _cost(A - B @ gain, Q + R * gain.T @ gain)
            if _is_small(X - last, X):
                return X
    raise _no_solution()


def _by_doubling(A: Array, B: Array, Q: Array, R: float) -> Array:
    """Solution X (n, n) to few digits if R is small."""
    G, H = B @ B.T / R, Q
    for _ in range(MOST_STEPS):
        W_A, W_G = np.hsplit(np.linalg.solve(np.eye(len(A)) + G @ H, np.hstack([A, G])), 2)
        change = A.T @ H @ W_A
        A, G, H = A @ W_A, G + A @ W_G @ A.T, H + change
        G, H = 0.5 * (G + G.T), 0.5 * (H + H.T)  # rounding would grow from step to step
        if _is_small(change, H):
            return H
    raise _no_solution()


def _cost(A: Array, Q: Array) -> Array:
    """Sum X (n, n) of (A^T)^k Q A^k over all k >= 0, for a stable A (n, n), by doubling."""
    X = Q
    for _ in range(MOST_STEPS):
        change = A.T @ X @ A
        X, A = X + change, A @ A
        if _is_small(change, X):
            return 0.5 * (X + X.T)
    raise _no_solution()


def _is_small(change: Array, of: Array) -> bool:
    """Whether an iteration has ended; raises LinAlgError where it has left the finite numbers."""
    if not np.all(np.isfinite(of)):
        raise _no_solution()
    return bool(np.abs(change).max() <= PRECISION * np.abs(of).max())


def _no_solution() -> np.linalg.LinAlgError:
    return np.linalg.LinAlgError("the Riccati equation has no stabilising solution")
