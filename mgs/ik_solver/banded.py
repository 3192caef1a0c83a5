"""Least squares in null spaces that second differences couple: a banded system of equations.

    min over z   sum_k [ 1/2 z_k^T B_k z_k + g_k^T z_k ] + c/2 sum_k | sum_l D_kl Z_l z_l |^2

D takes second differences of a motion that rests before its first sample and after its last one.
Each Z_k (n, p) has orthonormal columns. The matrix has blocks (p, p) up to the second off-diagonal,
hence 3 p - 1 diagonals below the main one; its Cholesky factor takes O(N p^3) operations.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solveh_banded

from mgs.core.arrays import Array


def second_differences(q: Array) -> Array:
    """Second differences D q (N, n) of q (N, n), at rest before and after."""
    rested = np.concatenate([q[:1], q, q[-1:]])
    return np.asarray(rested[2:] - 2.0 * rested[1:-1] + rested[:-2])


def coupling(n_samples: int) -> Array:
    """Lower band (3, N) of D^T D: the main diagonal and the two below it, column by column."""
    D = np.zeros((3, n_samples))
    D[0], D[1], D[2] = 6.0, -4.0, 1.0
    D[0, [0, -1]], D[1, [0, -2]] = 2.0, -3.0
    D[1, -1], D[2, -2:] = 0.0, 0.0
    return D


def band_matrix(B: Array, Z: Array, c: float, pinned: int) -> Array:
    """Lower band (3 p, M p) of the matrix for the M samples after the first `pinned` ones.

    Args:
        B: (N, p, p) curvature in the null space of every sample.
        Z: (N, n, p) bases of the null spaces.
        c: weight of the squared second differences.
        pinned: number of samples at the beginning that do not move.
    """
    n_samples, p = len(B), B.shape[-1]
    weights = c * coupling(n_samples)[:, pinned:]
    B, Z = B[pinned:], Z[pinned:]
    band = np.zeros((3 * p, n_samples - pinned, p))
    a, b = np.tril_indices(p)
    main = B.copy()
    main[:, range(p), range(p)] += weights[0][:, None]
    band[a - b, :, b] = main[:, a, b].T
    rows, columns = np.indices((p, p))
    for d in (1, 2):
        blocks = np.swapaxes(Z[d:], 1, 2) @ Z[:-d]
        blocks *= weights[d, : len(blocks), None, None]
        band[d * p + rows - columns, : len(blocks), columns] = blocks.transpose(1, 2, 0)
    return band.reshape(3 * p, -1)


def solve_band(band: Array, g: Array) -> Array:
    """Solution z (M, p) of A z = -g, A positive definite given by its lower band."""
    z = solveh_banded(band, -g.ravel(), lower=True, check_finite=False)
    return np.asarray(z.reshape(g.shape))
