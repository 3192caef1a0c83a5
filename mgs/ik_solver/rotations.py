"""Rotation vectors (log map) of many rotations at once."""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array

SMALL_SINE = 1e-12  # below it the angle equals its sine to double precision


def rotation_vectors(R: Array) -> Array:
    """Rotation vectors (N, 3) [rad] of rotations (N, 3, 3), each by less than half a turn."""
    w = 0.5 * np.stack(
        [R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1
    )
    sine = np.linalg.norm(w, axis=1)
    angle = np.arctan2(sine, 0.5 * (np.trace(R, axis1=1, axis2=2) - 1.0))
    ratio = np.where(sine > SMALL_SINE, angle / np.maximum(sine, SMALL_SINE), 1.0)
    return np.asarray(w * ratio[:, None])


def turns_between(rotations: Array) -> Array:
    """Rotation vectors (N, 3) [rad] from each of N rotations (N, 3, 3) to the next, world axes.

    Row k leads from sample k - 1 to sample k; row 0 and rows between equal rotations are zero.
    """
    turns = np.zeros((len(rotations), 3))
    before, after = rotations[:-1], rotations[1:]
    turned = np.flatnonzero(np.any(after != before, axis=(1, 2)))
    turns[turned + 1] = rotation_vectors(after[turned] @ before[turned].transpose(0, 2, 1))
    return turns
