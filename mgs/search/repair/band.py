"""Symmetric systems in which a sample is coupled to the next two: blocks, and their solution.

A is given by its lower blocks L_d[k] = A[k + d, k] (p, p), d = 0, 1, 2. Its Cholesky factor takes
O(T p^3) operations.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solveh_banded

from mgs.core.arrays import Array

REACH = 3  # a sample, and the next two


def empty_blocks(n_samples: int, p: int) -> Array:
    """Blocks (3, T, p, p) of zeros."""
    return np.zeros((REACH, n_samples, p, p))


def solve_blocks(blocks: Array, g: Array) -> Array:
    """Solution x (T, p) of A x = g (T, p), A positive definite.

    Args:
        blocks: (3, T, p, p) lower blocks of A; those beyond the last sample are not looked at.
        g: (T, p).
    """
    _, n_samples, p, _ = blocks.shape
    band = np.zeros((REACH * p, n_samples, p))
    a, b = np.tril_indices(p)
    band[a - b, :, b] = blocks[0][:, a, b].T
    rows, columns = np.indices((p, p))
    for d in (1, 2):
        band[d * p + rows - columns, : n_samples - d, columns] = blocks[
            d, : n_samples - d
        ].transpose(1, 2, 0)
    flat = band.reshape(REACH * p, -1)
    return np.asarray(solveh_banded(flat, g.ravel(), lower=True, check_finite=False)).reshape(
        g.shape
    )


def smooth(values: Array, weight: float) -> Array:
    """Values (T, m) nearest to the given ones and smooth: E. T. Whittaker, "On a new method of
    graduation", Proc. Edinburgh Math. Soc. 41, 1923, with third differences.

        min |x - values|^2 + weight |D^3 x|^2
    """  # noqa: D205
    n = len(values)
    if n < 5 or weight <= 0.0:
        return values
    D = np.zeros((4, n))  # rows of the lower band of D^T D, D third differences
    stencil = np.array([-1.0, 3.0, -3.0, 1.0])
    for d in range(4):
        for i in range(4 - d):
            D[d, i : n - 3 + i] += stencil[i] * stencil[i + d]
    D *= weight
    D[0] += 1.0
    return np.asarray(solveh_banded(D, values, lower=True, check_finite=False))
