"""The Riccati equation against SciPy's solver and by substituting the solution back."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import solve_discrete_are

from mgs.com_generator.riccati import solve_riccati
from tests.support.preview import TUNINGS, augmented


@pytest.mark.parametrize("tuning", TUNINGS)
def test_the_solution_of_preview_control_is_that_of_scipy(tuning: tuple[float, ...]):
    dt, height, weight_error, weight_jerk = tuning
    A, B = augmented(dt, height)
    Q, R = np.diag([1.0, 0.0, 0.0, 0.0]), weight_jerk / weight_error
    expected = solve_discrete_are(A, B, Q, [[R]])
    assert_allclose(solve_riccati(A, B, Q, R), expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("R", [1e-300, 1e-40, 1e-20, 1e-14, 1e-10, 1e-4, 1.0, 1e4, 1e8])
def test_the_gains_of_preview_control_are_those_of_scipy_for_any_weight(R: float):
    A, B = augmented(0.01, 0.27)
    Q = np.diag([1.0, 0.0, 0.0, 0.0])
    gains = []
    for X in (solve_riccati(A, B, Q, R), solve_discrete_are(A, B, Q, [[R]])):
        gains.append(B.T @ X @ A / (R + B.T @ X @ B))
    # SciPy itself is off by 5e-10 at 1e8, as 60-digit arithmetic shows, and by more beyond
    assert_allclose(gains[0], gains[1], rtol=1e-8)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("n", [1, 2, 5])
def test_the_solution_of_a_random_system_satisfies_the_equation_and_stabilises(n: int, seed: int):
    rng = np.random.default_rng(seed)
    A, B, R = rng.normal(size=(n, n)), rng.normal(size=(n, 1)), rng.uniform(0.1, 10.0)
    root = rng.normal(size=(n, n))
    Q = root @ root.T
    X = solve_riccati(A, B, Q, R)
    gain = B.T @ X @ A / (R + B.T @ X @ B)
    scale = np.abs(X).max() * max(1.0, np.abs(A).max() ** 2)
    assert_allclose(A.T @ X @ A - A.T @ X @ B @ gain + Q, X, atol=1e-11 * scale)
    assert np.abs(np.linalg.eigvals(A - B @ gain)).max() < 1.0
    assert_allclose(X, solve_discrete_are(A, B, Q, [[R]]), atol=1e-9 * scale)


def test_a_system_that_its_input_cannot_stabilise_is_refused():
    A, B = np.diag([2.0, 0.5]), np.array([[0.0], [1.0]])
    with pytest.raises(np.linalg.LinAlgError, match="no stabilising solution"):
        solve_riccati(A, B, np.eye(2), 1.0)


@pytest.mark.parametrize("R", [np.inf, np.nan])
def test_a_weight_that_is_not_finite_is_refused(R: float):
    A, B = augmented(0.01, 0.27)
    with pytest.raises(np.linalg.LinAlgError, match="no stabilising solution"):
        solve_riccati(A, B, np.diag([1.0, 0.0, 0.0, 0.0]), R)
