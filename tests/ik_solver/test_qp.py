"""The quadratic program of one iteration, against solvers that share no code with DAQP."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import lsq_linear, minimize

from mgs.ik_solver.qp import ELASTIC_WEIGHT, BoundedQp, kkt_residual, solve_equality

N, M, N_SOFT, N_BASE = 18, 15, 3, 6  # as on legs of twelve joints
DAMPING = 1e-2


class Problem:
    """A random program that has a solution; with a `shift` it may have none."""

    def __init__(self, seed: int, m: int = M, width: float = 0.3, shift: float = 0.0) -> None:
        rng = np.random.default_rng(seed)
        J = rng.normal(size=(N_SOFT, N))
        self.H = J.T @ J + DAMPING * np.eye(N)
        self.g = J.T @ rng.normal(size=N_SOFT)
        self.A = rng.normal(size=(m, N))
        inside = np.concatenate([rng.normal(size=N_BASE), rng.uniform(-0.9, 0.9, N - N_BASE)])
        self.low, self.high = np.full(N, -np.inf), np.full(N, np.inf)
        self.low[N_BASE:], self.high[N_BASE:] = -width, width
        inside[N_BASE:] *= width
        self.b = self.A @ inside + shift * rng.normal(size=m)

    def solve(self) -> tuple[BoundedQp, np.ndarray]:
        qp = BoundedQp(N, len(self.b))
        qp.low[:], qp.high[:] = self.low[N_BASE:], self.high[N_BASE:]
        return qp, qp.solve(self.H, self.g, self.A, self.b)

    def cost(self, x: np.ndarray) -> float:
        return float(0.5 * x @ self.H @ x + self.g @ x)

    def residual(self, x: np.ndarray, lam: np.ndarray) -> float:
        bounds = np.array([self.low, self.high])
        return kkt_residual(self.H, self.g, self.A, self.b, bounds, x, lam)


def least_cost(problem: Problem) -> float:
    """Minimiser by sequential quadratic programming in the null space of the equalities."""
    x0 = np.linalg.pinv(problem.A) @ problem.b
    _, _, Vt = np.linalg.svd(problem.A)
    Z = Vt[len(problem.b) :].T
    joints = slice(N_BASE, None)
    low, high = problem.low[joints], problem.high[joints]
    rows = np.vstack([Z[joints], -Z[joints]])
    room = np.concatenate([x0[joints] - low, high - x0[joints]])
    found = minimize(
        lambda y: problem.cost(x0 + Z @ y),
        np.zeros(Z.shape[1]),
        jac=lambda y: Z.T @ (problem.H @ (x0 + Z @ y) + problem.g),
        constraints={"type": "ineq", "fun": lambda y: rows @ y + room, "jac": lambda y: rows},
        method="SLSQP",
        options={"ftol": 1e-15, "maxiter": 500},
    )
    x = x0 + Z @ found.x
    assert np.all(x[joints] >= low - 1e-8)
    assert np.all(x[joints] <= high + 1e-8)
    return float(found.fun)


# --- with bounds ------------------------------------------------------------------------------


@pytest.mark.parametrize("m", [15, 9, 3])
def test_the_solution_is_that_of_another_method(m: int):
    at_bounds = 0
    for seed in range(15):
        problem = Problem(seed, m)
        qp, x = problem.solve()
        assert not qp.elastic
        assert_allclose(problem.A @ x, problem.b, atol=1e-8)
        assert np.all(x >= problem.low - 1e-8)
        assert np.all(x <= problem.high + 1e-8)
        assert_allclose(problem.cost(x), least_cost(problem), rtol=1e-6, atol=1e-8)
        at_bounds += int((np.abs(qp.lam[:N]) > 1e-9).sum())
    assert at_bounds > 5  # the bounds matter in these problems


def test_a_workspace_carries_no_data_from_one_problem_to_the_next():
    qp = BoundedQp(N, M)
    first = {}
    for seed in [0, 1, 2, 0, 2, 1]:
        problem = Problem(seed, shift=1.0 if seed == 1 else 0.0)  # one without a solution
        qp.low[:], qp.high[:] = problem.low[N_BASE:], problem.high[N_BASE:]
        x = qp.solve(problem.H, problem.g, problem.A, problem.b)
        assert qp.elastic == (seed == 1)
        assert_allclose(x, first.setdefault(seed, x), atol=1e-12)


def test_with_wide_bounds_the_solution_is_the_closed_form():
    for seed in range(10):
        problem = Problem(seed)
        problem.low[N_BASE:], problem.high[N_BASE:] = -1e4, 1e4
        _, x = problem.solve()
        closed = solve_equality(problem.H, problem.g, problem.A, problem.b)
        assert_allclose(x, closed, atol=1e-8 * np.abs(closed).max())


# --- optimality conditions ---------------------------------------------------------------------


@pytest.mark.parametrize("m", [15, 9, 3])
def test_solutions_meet_the_optimality_conditions(m: int):
    for seed in range(40):
        problem = Problem(seed, m)
        qp, x = problem.solve()
        assert problem.residual(x, qp.lam) < 1e-7


def test_other_points_violate_the_optimality_conditions():
    """Each part of a solution is changed in turn by a hundredth."""
    rng = np.random.default_rng(0)
    for seed in range(20):
        problem = Problem(seed, m=9)
        qp, x = problem.solve()
        Z = np.linalg.svd(problem.A)[2][9:].T
        along = Z @ rng.normal(size=N - 9)  # stays on the equalities
        assert problem.residual(x + 1e-2 * along / np.linalg.norm(along), qp.lam) > 1e-5
        assert problem.residual(x + 1e-2 * problem.A[0], qp.lam) > 1e-2
        for j in range(N + 9):
            lam = qp.lam.copy()
            lam[j] += 1e-2
            assert problem.residual(x, lam) > 1e-3
        active = np.flatnonzero(np.abs(qp.lam[:N]) > 1e-3)
        for j in active:  # a bound held by the wrong sign
            lam = qp.lam.copy()
            lam[j] = -lam[j]
            assert problem.residual(x, lam) > 1e-3


def test_wrong_signs_of_the_multipliers_violate_the_optimality_conditions():
    """A maximum on a bound is stationary and feasible, but its multiplier has the wrong sign."""
    H, g, A, b = np.eye(N), np.zeros(N), np.zeros((1, N)), np.zeros(1)
    g[N - 1] = -2.0  # the minimum is at 2
    bounds = np.array([np.full(N, -1.0), np.full(N, 1.0)])
    x, lam = np.zeros(N), np.zeros(N + 1)
    x[N - 1], lam[N - 1] = 1.0, 1.0
    assert kkt_residual(H, g, A, b, bounds, x, lam) == 0.0
    x[N - 1], lam[N - 1] = -1.0, 3.0  # stationary at the wrong bound
    assert kkt_residual(H, g, A, b, bounds, x, lam) > 1.0
    x[N - 1], lam[N - 1] = 2.0, 0.0  # beyond the bound
    assert kkt_residual(H, g, A, b, bounds, x, lam) >= 1.0


# --- contradictions ----------------------------------------------------------------------------


def least_distance(problem: Problem) -> float:
    """Minimiser of |A x - b| within the bounds, by bounded-variable least squares."""
    bounds = (problem.low, problem.high)
    found = lsq_linear(problem.A, problem.b, bounds, method="bvls", tol=1e-14)
    return float(np.linalg.norm(problem.A @ found.x - problem.b))


def test_contradictory_equalities_and_bounds_are_recognised():
    seen = {True: 0, False: 0}
    for seed in range(60):
        problem = Problem(seed, width=0.5, shift=0.4)
        contradictory = least_distance(problem) > 1e-6
        qp, _ = problem.solve()
        assert qp.elastic == contradictory
        seen[contradictory] += 1
    assert min(seen.values()) > 5


def test_contradictory_equalities_are_met_as_far_as_the_bounds_permit():
    """The oracle is bounded least squares with the weight ELASTIC_WEIGHT for A x = b."""
    for seed in range(20):
        problem = Problem(seed, width=0.3, shift=2.0)
        qp, x = problem.solve()
        assert qp.elastic
        assert np.all(x >= problem.low - 1e-9)
        assert np.all(x <= problem.high + 1e-9)
        # the objective moves the residual by about |g| / ELASTIC_WEIGHT of it
        distance = float(np.linalg.norm(problem.A @ x - problem.b))
        assert_allclose(distance, least_distance(problem), rtol=1e-4, atol=1e-5)
        L = np.linalg.cholesky(problem.H)
        rows = np.vstack([L.T, np.sqrt(ELASTIC_WEIGHT) * problem.A])
        right = np.concatenate(
            [-np.linalg.solve(L, problem.g), np.sqrt(ELASTIC_WEIGHT) * problem.b]
        )
        oracle = lsq_linear(rows, right, (problem.low, problem.high), method="bvls", tol=1e-15)
        assert_allclose(x, oracle.x, atol=1e-5)
        stationarity = problem.H @ x + problem.g + qp.lam[:N] + problem.A.T @ qp.lam[N:]
        assert np.abs(stationarity).max() < 1e-9 * ELASTIC_WEIGHT


# --- without bounds ----------------------------------------------------------------------------


def dense_kkt(problem: Problem) -> np.ndarray:
    """Solution of eq. (2) by the pseudo-inverse of the matrix of the optimality conditions."""
    m = len(problem.b)
    K = np.block([[problem.H, problem.A.T], [problem.A, np.zeros((m, m))]])
    return (np.linalg.pinv(K, rcond=1e-12) @ np.concatenate([-problem.g, problem.b]))[:N]


@pytest.mark.parametrize("m", [1, 9, 15, 18])
def test_the_closed_form_solves_the_optimality_conditions(m: int):
    for seed in range(20):
        problem = Problem(seed, m, width=1.0)
        expected = dense_kkt(problem)
        x = solve_equality(problem.H, problem.g, problem.A, problem.b)
        assert_allclose(x, expected, atol=1e-7 * np.abs(expected).max())


def test_the_closed_form_accepts_dependent_rows():
    """Hard rows depend on each other where both legs are straight."""
    for seed in range(20):
        problem = Problem(seed, width=1.0)
        problem.A[-1] = problem.A[0] - 2.0 * problem.A[1]
        problem.A[-2] = problem.A[2]
        problem.b = problem.A @ np.random.default_rng(seed).normal(size=N)
        expected = dense_kkt(problem)
        x = solve_equality(problem.H, problem.g, problem.A, problem.b)
        assert_allclose(x, expected, atol=1e-7 * np.abs(expected).max())


def test_the_closed_form_meets_contradictory_rows_in_the_least_squares_sense():
    """A leg beyond its length is an example; the damping of S causes 1e-5 of the step."""
    for seed in range(20):
        problem = Problem(seed, width=1.0)
        problem.A[-1] = problem.A[0] - 2.0 * problem.A[1]
        problem.b = problem.A @ np.random.default_rng(seed).normal(size=N)
        problem.b[-1] += 1e-2
        expected = dense_kkt(problem)
        x = solve_equality(problem.H, problem.g, problem.A, problem.b)
        assert_allclose(x, expected, atol=1e-4 * np.abs(expected).max())


def test_a_cost_without_a_minimum_is_refused():
    problem = Problem(0)
    with pytest.raises(ArithmeticError, match="positive definite"):
        solve_equality(problem.H - 2.0 * np.eye(N), problem.g, problem.A, problem.b)
