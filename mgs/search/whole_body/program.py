"""The quadratic program of one step: the problem made linear about a motion.

Unknowns of a sample are the change of its configuration (6 + n), the wrenches of both soles (12),
the torques (n) and, if work has a weight, the positive powers (n). The curvature of the objective
is that of Gauss and Newton. Solved by PIQP
(R. Schwan et al., "PIQP: a proximal interior-point quadratic programming solver", IEEE CDC, 2023),
whose factorisation of the sparse matrix takes time in proportion to the number of samples.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import piqp
import scipy.sparse as sp
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV, GRAVITY
from mgs.core.contact import Side
from mgs.search.whole_body.dynamics import JOINTS, Point, Slopes
from mgs.search.whole_body.problem import RESERVE, Problem

N_CONE = 16
NEAR_LINE = 0.5  # use of the speed-torque line from which it is part of the program
EPS = 1e-6
MOST_ITERATIONS = 80
Places = NDArray[np.intp]  # of rows and columns
LEAST_CURVATURE = 1e-6  # of coordinates that are in no term
WRENCH_CURVATURE = 1e-7  # times 1 / (m g)^2, so that wrenches are unique


@dataclass(frozen=True, eq=False)
class Step:
    """The solution of a program."""

    dq: Array  # (T, 6 + n)
    w: Array  # (T, 2, 6)
    solved: bool


@dataclass(eq=False)
class _Entries:
    """Entries of a sparse matrix, block by block."""

    n_rows: int = 0
    rows: list[Places] = field(default_factory=list)
    columns: list[Places] = field(default_factory=list)
    values: list[Array] = field(default_factory=list)

    def add(self, rows: Places, columns: Places, values: Array) -> None:
        self.rows.append(np.broadcast_to(rows, values.shape).ravel())
        self.columns.append(np.broadcast_to(columns, values.shape).ravel())
        self.values.append(values.ravel())

    def blocks(self, rows: Places, columns: Places, values: Array) -> None:
        """Blocks (m, r, c) whose upper left corners are at rows (m,) and columns (m,)."""
        r, c = values.shape[1:]
        self.add(
            rows[:, None, None] + np.arange(r)[None, :, None],
            columns[:, None, None] + np.arange(c),
            values,
        )

    def new_rows(self, count: int, each: int) -> Places:
        """First rows (count,) of blocks of new rows."""
        rows = self.n_rows + each * np.arange(count)
        self.n_rows += each * count
        return rows

    def matrix(self, n_columns: int) -> sp.csc_matrix:
        values = np.concatenate(self.values)
        rows, columns = np.concatenate(self.rows), np.concatenate(self.columns)
        return sp.csc_matrix((values, (rows, columns)), shape=(self.n_rows, n_columns))


class Program:
    """The program of a step of at most `trust` in every joint and coordinate of the base."""

    def __init__(self, problem: Problem, point: Point, slopes: Slopes, trust: float) -> None:
        self.problem, self.point, self.slopes, self.trust = problem, point, slopes, trust
        self.n, self.nv = problem.robot.n, problem.nv
        self.with_work = problem.weights.work > 0.0
        self.p = self.nv + 12 + self.n * (2 if self.with_work else 1)
        self.torques = slice(self.nv + 12, self.nv + 12 + self.n)
        self.work = slice(self.torques.stop, self.p)
        self.at = self.p * np.arange(problem.n_samples)  # first unknown of each sample

    def solve(self) -> Step:
        """The solution that PIQP finds."""
        size = self.p * self.problem.n_samples
        P, c = self._objective()
        A, b = self._equalities()
        G, low, high = self._inequalities()
        lower, upper = self._bounds()
        units, rows = self._units(A.n_rows)
        scale, per_row = sp.diags_array(units), sp.diags_array(1.0 / rows)
        solver = piqp.SparseSolver()
        solver.settings.eps_abs = solver.settings.eps_rel = EPS
        solver.settings.max_iter = MOST_ITERATIONS
        solver.setup(
            sp.csc_matrix(scale @ P.matrix(size) @ scale), units * c.ravel(),
            sp.csc_matrix(per_row @ A.matrix(size) @ scale), b / rows,
            sp.csc_matrix(G.matrix(size) @ scale), low, high,
            lower.ravel() / units, upper.ravel() / units,
        )  # fmt: skip
        status = solver.solve()
        x = (units * solver.result.x).reshape(-1, self.p)
        w = x[:, self.nv : self.nv + 12].reshape(-1, 2, 6).copy()
        return Step(x[:, : self.nv].copy(), w, bool(status == piqp.PIQP_SOLVED))

    def _units(self, n_rows: int) -> tuple[Array, Array]:
        """Units of the unknowns, and of the equalities, in which all of them are of one size.

        In SI units the solver needs several times as many iterations, or does not converge.
        """
        weight, leg = self.problem.robot.mass * GRAVITY, self.problem.leg
        one = np.ones(self.p)
        one[self.nv : self.nv + 12] = np.tile(weight * np.repeat([1.0, leg], 3), 2)
        one[self.torques] = weight * leg
        one[self.work] = weight * np.sqrt(GRAVITY * leg)
        rows = np.ones(n_rows)
        rows[: self.nv * self.problem.n_samples] = weight * leg
        return np.tile(one, self.problem.n_samples), rows

    def _objective(self) -> tuple[_Entries, Array]:
        """The objective divided by h."""
        problem, point, slopes = self.problem, self.point, self.slopes
        weights, nv = problem.weights, self.nv
        P, c = _Entries(n_rows=self.p * problem.n_samples), np.zeros((problem.n_samples, self.p))
        curvature = np.zeros_like(c)
        curvature[:, FLOATING_BASE_NV:nv] = weights.distance
        curvature[:, :nv] += LEAST_CURVATURE
        c[:, FLOATING_BASE_NV:nv] = weights.distance * point.off_joints
        weight = problem.robot.mass * GRAVITY
        curvature[:, nv : nv + 12] = WRENCH_CURVATURE / weight**2
        curvature[:, self.torques] = problem.weight_torque
        diagonal = self.at[:, None] + np.arange(self.p)
        P.add(diagonal, diagonal, curvature)
        terms = [(weights.upright, point.off_torso, slopes.torso)]
        terms += [
            (weights.hands / problem.leg**2, point.off_hands[:, side], slopes.hands[:, side])
            for side in Side
        ]
        for factor, off, J in terms:
            if factor > 0.0:
                P.blocks(self.at, self.at, factor * (J.transpose(0, 2, 1) @ J))
                c[:, :nv] += factor * (off[:, None] @ J)[:, 0]
        if self.with_work:
            c[:, self.work] = problem.weight_work
        return P, c

    def _equalities(self) -> tuple[_Entries, Array]:
        problem, point, slopes = self.problem, self.point, self.slopes
        n_samples, nv, n = problem.n_samples, self.nv, self.n
        A, every = _Entries(), np.arange(n_samples)
        rows = A.new_rows(n_samples, nv)  # dynamics of base and joints
        for part, d in enumerate((-1, 0, 1)):
            k = every[(every + d >= 0) & (every + d < n_samples)]
            A.blocks(rows[k], self.at[k + d], slopes.force[part, k])
        right = -point.force
        for side in Side:
            J = np.where(problem.bears[:, side, None, None], slopes.soles[:, side], 0.0)
            k = np.flatnonzero(problem.bears[:, side])
            A.blocks(rows[k], self.at[k] + nv + 6 * side, -J[k].transpose(0, 2, 1))
            right -= (point.w[:, side, None] @ J)[:, 0]
        A.add(
            rows[:, None] + FLOATING_BASE_NV + np.arange(n),
            self.at[:, None] + nv + 12 + np.arange(n),
            np.full((n_samples, n), -1.0),
        )
        k = every[1:-1]  # the ends do not move
        for side in Side:
            A.blocks(A.new_rows(len(k), 6), self.at[k], slopes.soles[k, side])
        return A, np.concatenate([right.ravel(), np.zeros(12 * len(k))])

    def _inequalities(self) -> tuple[_Entries, Array, Array]:
        problem, point = self.problem, self.point
        G, low, high = _Entries(), [], []
        for side in Side:
            k = np.flatnonzero(problem.bears[:, side])
            cone = np.broadcast_to(problem.cones[side], (len(k), N_CONE, 6))
            G.blocks(G.new_rows(len(k), N_CONE), self.at[k] + self.nv + 6 * side, cone)
            low.append(np.full(N_CONE * len(k), -np.inf))
            high.append(np.zeros(N_CONE * len(k)))
        joints = FLOATING_BASE_NV + np.arange(self.n)
        rows = G.new_rows(problem.n_samples - 1, self.n)[:, None] + np.arange(self.n)
        ones = np.ones(rows.shape)
        G.add(rows, self.at[1:, None] + joints, ones)
        G.add(rows, self.at[:-1, None] + joints, -ones)
        done = problem.h * point.v[1:-1, JOINTS]
        most = problem.h * problem.speed_limit
        low.append((-most - done).ravel())
        high.append((most - done).ravel())
        for limits in (self._speed_torque_lines(G), self._clearances(G), self._powers(G)):
            low.append(np.full(len(limits), -np.inf))
            high.append(limits)
        return G, np.concatenate(low), np.concatenate(high)

    def _speed_torque_lines(self, G: _Entries) -> Array:
        """Rows  s (tau + slope v) <= stall torque  for s = 1 and -1, where a servo is near them."""
        problem, point, robot = self.problem, self.point, self.problem.robot
        slope = RESERVE * robot.torque_limit / robot.no_load_speed
        stall = RESERVE * robot.torque_limit
        v = 0.5 * (point.v[:-1, JOINTS] + point.v[1:, JOINTS])
        limits = []
        for s in (1.0, -1.0):
            use = s * (point.torque + slope * v) / stall
            k, j = np.nonzero((use > NEAR_LINE) & (s * v > 0.0))
            inside = (k > 0) & (k < problem.n_samples - 1)
            k, j = k[inside], j[inside]
            rows = G.new_rows(len(k), 1)
            part = s * slope[j] / (2.0 * problem.h)
            G.add(rows, self.at[k] + self.nv + 12 + j, np.full(len(k), s))
            G.add(rows, self.at[k + 1] + FLOATING_BASE_NV + j, part)
            G.add(rows, self.at[k - 1] + FLOATING_BASE_NV + j, -part)
            limits.append(stall[j] - s * slope[j] * v[k, j])
        return np.concatenate(limits)

    def _clearances(self, G: _Entries) -> Array:
        """Rows  -row . dq <= distance - least distance  for links that are near each other."""
        found = self.problem.clearance.along(self.point.q)
        inside = (found.samples > 0) & (found.samples < self.problem.n_samples - 1)
        samples, rows = found.samples[inside], found.rows[inside]
        G.blocks(G.new_rows(len(samples), 1), self.at[samples], -rows[:, None])
        return np.asarray((found.distance - found.least)[inside])

    def _powers(self, G: _Entries) -> Array:
        """Rows  tau dv + v tau_new - power <= 0, which make the unknown power the positive one.

        With a slope of the positive power alone a joint at rest would seem to move for nothing.
        """
        if not self.with_work:
            return np.zeros(0)
        point, joints = self.point, FLOATING_BASE_NV + np.arange(self.n)
        rows = G.new_rows(self.problem.n_samples, self.n)[:, None] + np.arange(self.n)
        by_v = point.torque / self.problem.h
        at = self.at[:, None]
        G.add(rows, at + joints, by_v)
        G.add(rows[1:], at[:-1] + joints, -by_v[1:])
        G.add(rows, at + self.torques.start + np.arange(self.n), point.v[:-1, JOINTS])
        G.add(rows, at + self.work.start + np.arange(self.n), np.full(rows.shape, -1.0))
        return np.zeros(rows.size)

    def _bounds(self) -> tuple[Array, Array]:
        problem, robot, nv = self.problem, self.problem.robot, self.nv
        upper = np.full((problem.n_samples, self.p), np.inf)
        upper[:, :nv] = self.trust
        lower = -upper
        angles = self.point.q[:, FLOATING_BASE_NQ:]
        joints = slice(FLOATING_BASE_NV, nv)
        least, most = problem.angles
        lower[:, joints] = np.maximum(lower[:, joints], np.minimum(least - angles, 0.0))
        upper[:, joints] = np.minimum(upper[:, joints], np.maximum(most - angles, 0.0))
        lower[[0, -1], :nv] = upper[[0, -1], :nv] = 0.0
        for side in Side:
            free = np.flatnonzero(~problem.bears[:, side])
            wrench = slice(nv + 6 * side, nv + 6 * side + 6)
            lower[free, wrench] = upper[free, wrench] = 0.0
        lower[:, self.torques] = -RESERVE * robot.torque_limit
        upper[:, self.torques] = RESERVE * robot.torque_limit
        lower[:, self.work] = 0.0
        return lower, upper
