"""Rotation vectors of many rotations, against Pinocchio's logarithm of one at a time."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.ik_solver.rotations import rotation_vectors, turns_between


def rotations_by(angles: np.ndarray, seed: int = 4) -> np.ndarray:
    """Rotations (N, 3, 3) by angles (N,) [rad] about random axes."""
    axes = np.random.default_rng(seed).normal(size=(len(angles), 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    return np.array([pin.exp3(angle * axis) for angle, axis in zip(angles, axes, strict=True)])


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-5, 0.1, 1.5, 3.0])
def test_rotation_vectors_are_logarithms(angle: float):
    R = rotations_by(np.full(20, angle))
    expected = np.array([pin.log3(one) for one in R])
    # near half a turn the sine of the angle is small: its rounding of 1e-16 weighs 1 / sin(3) more
    assert_allclose(rotation_vectors(R), expected, atol=1e-13)


def test_turns_lead_from_each_rotation_to_the_next():
    R = rotations_by(np.linspace(0.0, 1.0, 12))
    turns = turns_between(R)
    assert not turns[0].any()
    for k in range(1, len(R)):
        assert_allclose(pin.exp3(turns[k]) @ R[k - 1], R[k], atol=1e-13)


def test_between_equal_rotations_there_is_no_turn_at_all():
    """R R^T differs from the identity by rounding, which must not count as a turn."""
    R = np.repeat(rotations_by(np.array([0.7, 1.2])), 3, axis=0)
    turns = turns_between(R)
    assert not turns[[0, 1, 2, 4, 5]].any()
    assert turns[3].any()
