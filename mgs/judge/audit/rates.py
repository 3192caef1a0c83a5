"""Velocities and accelerations of positions that somebody gives: differences, at rest nowhere.

A motion of others may be cut out of a longer one, so that nothing is assumed before its first
sample and after its last one: the outermost differences are repeated.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.geometry import quat_multiply, rotations_from_quat_xyzw


def steps(q: Array) -> Array:
    """Steps (T - 1, 6 + n) from each sample of q (T, 7 + n) to the next one, in its tangent.

    The first six are the base twist over one period in the frame of the base, as Pinocchio's
    `difference` gives it up to terms of third order in the angle of one step.
    """
    turn = turns(q[:, 3:FLOATING_BASE_NQ])
    R = rotations_from_quat_xyzw(q[:-1, 3:FLOATING_BASE_NQ])
    way = np.einsum("tji,tj->ti", R, np.diff(q[:, :3], axis=0))
    cross = np.cross(turn, way)
    way = way - 0.5 * cross + np.cross(turn, cross) / 12.0  # inverse of the left Jacobian
    return np.concatenate([way, turn, np.diff(q[:, FLOATING_BASE_NQ:], axis=0)], axis=1)


def turns(quat_xyzw: Array) -> Array:
    """Rotation vectors (T - 1, 3) from each quaternion (T, 4) to the next, in its own frame."""
    conjugate = quat_xyzw[:-1] * [-1.0, -1.0, -1.0, 1.0]
    between = quat_multiply(conjugate, quat_xyzw[1:])
    between = np.where(between[:, 3:] < 0.0, -between, between)
    sine = np.linalg.norm(between[:, :3], axis=1)
    angle = 2.0 * np.arctan2(sine, between[:, 3])
    ratio = np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 2.0)
    return np.asarray(between[:, :3] * ratio[:, None])


def rates(forward: Array, dt: float) -> tuple[Array, Array]:
    """Velocities and accelerations (T, m) of steps (T - 1, m), T >= 3: central differences."""
    padded = np.concatenate([forward[:1], forward, forward[-1:]]) / dt
    v = 0.5 * (padded[1:] + padded[:-1])
    a = np.diff(padded, axis=0) / dt
    a[0], a[-1] = a[1], a[-2]
    return v, a


def moving_mean(values: Array, width: int) -> Array:
    """Means (T, ...) over `width` samples around each one, fewer at both ends."""
    if width <= 1:
        return values
    half = width // 2
    total = np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(values, axis=0)])
    k = np.arange(len(values))
    low, high = np.maximum(k - half, 0), np.minimum(k + half + 1, len(values))
    count = (high - low).reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray((total[high] - total[low]) / count)
