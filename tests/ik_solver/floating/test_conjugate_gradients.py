"""Conjugate gradients of ik2 against closed forms: linear tasks, where the method is finite."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mgs.ik_solver.floating.conjugate_gradients import LARGEST_STEP, ConjugateGradients

DAMPING = 1e-2


def problem(seed: int, n: int = 12, hard: int = 5, soft: int = 3) -> tuple[np.ndarray, ...]:
    """Linear hard rows A x = b and soft rows J x = e, within reach and without damping."""
    rng = np.random.default_rng(seed)
    A, J = rng.normal(size=(hard, n)), 0.3 * rng.normal(size=(soft, n))
    x = 0.01 * rng.normal(size=n)
    return A, A @ x, J, J @ x


def iterate(A, b, J, e, iterations: int) -> np.ndarray:
    n = A.shape[1]
    method, x = ConjugateGradients(np.full(n, DAMPING)), np.zeros(n)
    H = J.T @ J + DAMPING * np.eye(n)
    for _ in range(iterations):
        x = x + method.step(H, -J.T @ (e - J @ x), A, b - A @ x)
    return x


@given(seed=st.integers(0, 10_000))
def test_linear_tasks_are_met_after_as_many_iterations_as_soft_rows(seed: int):
    A, b, J, e = problem(seed)
    x = iterate(A, b, J, e, 3)
    np.testing.assert_allclose(A @ x, b, atol=1e-9)
    np.testing.assert_allclose(J @ x, e, atol=1e-8)  # 1e-2 of the tasks after damped steps


@given(seed=st.integers(0, 10_000))
def test_every_iteration_meets_the_hard_rows(seed: int):
    A, b, J, e = problem(seed)
    np.testing.assert_allclose(A @ iterate(A, b, J, e, 1), b, atol=1e-9)


def test_damped_steps_alone_need_more_iterations():
    A, b, J, e = problem(1)
    n = A.shape[1]
    H, x = J.T @ J + DAMPING * np.eye(n), np.zeros(n)
    K = np.block([[H, A.T], [A, np.zeros((5, 5))]])
    for _ in range(3):
        x = x + np.linalg.solve(K, np.concatenate([J.T @ (e - J @ x), b - A @ x]))[:n]
    fast = np.linalg.norm(J @ iterate(A, b, J, e, 3) - e)
    assert fast < 1e-3 * np.linalg.norm(J @ x - e)


def test_a_line_search_is_bounded_where_the_tasks_are_singular():
    n = 6
    method = ConjugateGradients(np.full(n, DAMPING))
    J = np.zeros((1, n))
    J[0, 0] = 1e-4  # almost singular: an exact line search would go very far
    A = np.eye(n)[1:2]
    dq = method.step(J.T @ J + DAMPING * np.eye(n), -J.T @ np.array([1.0]), A, np.zeros(1))
    assert np.abs(dq).max() == pytest.approx(LARGEST_STEP)


def test_a_new_sample_forgets_the_directions_of_the_last_one():
    A, b, J, e = problem(2)
    n = A.shape[1]
    H = J.T @ J + DAMPING * np.eye(n)
    method = ConjugateGradients(np.full(n, DAMPING))
    first = method.step(H, -J.T @ e, A, b)
    method.reset()
    np.testing.assert_array_equal(method.step(H, -J.T @ e, A, b), first)
