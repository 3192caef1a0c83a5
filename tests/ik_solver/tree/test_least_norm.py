"""The step of least norm, against singular values and against ridge regression as least squares."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from mgs.ik_solver.tree.least_norm import LeastNorm

M, N = 15, 19


def problem() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Jacobian with a row left below it (16, 19), error (15,) and vector v (19,)."""
    rng = np.random.default_rng(3)
    return rng.normal(size=(M + 1, N)), rng.normal(size=M), rng.normal(size=N)


def test_the_step_meets_the_error_and_moves_by_v_in_the_null_space():
    rows, error, v = problem()
    solver = LeastNorm(rows, damping=1e-9)
    solver.v[:] = v
    J = rows[:M].copy()
    step = solver.step(error)
    J_pinv = np.linalg.pinv(J)
    assert_allclose(J @ step, error, atol=1e-12)
    assert_allclose(step, J_pinv @ error + v - J_pinv @ (J @ v), atol=1e-12)


@pytest.mark.parametrize("extra", [0.0, 0.25])
def test_damping_weighs_the_norm_of_the_step_against_the_error(extra: float):
    """Least squares of [J; d I] s = [e - J v; 0]: the same compromise, without normal equations."""
    rows, error, v = problem()
    solver = LeastNorm(rows, damping=0.5)
    solver.v[:] = v
    J, d = rows[:M].copy(), np.sqrt(0.25 + extra)
    stacked = np.concatenate([J, d * np.eye(N)])
    right = np.concatenate([error - J @ v, np.zeros(N)])
    expected = v + np.linalg.lstsq(stacked, right, rcond=None)[0]
    assert_allclose(solver.step(error, extra), expected, atol=1e-12)


def test_the_step_follows_a_jacobian_that_is_refilled():
    rows, error, _ = problem()
    solver = LeastNorm(rows, damping=1e-9)
    solver.v[:] = 0.0
    first = solver.step(error)
    rows[:M] *= 2.0
    assert_allclose(solver.step(error), 0.5 * first, atol=1e-12)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_jacobian_that_is_not_finite_gives_a_step_that_is_not(value: float):
    """So that the check of the task errors afterwards refuses the sample."""
    rows, error, _ = problem()
    rows[2, 3] = value
    solver = LeastNorm(rows, damping=1e-6)
    assert not np.isfinite(solver.step(error)).all()
