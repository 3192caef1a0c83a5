"""The quadratic program of one step: the problem made linear about a motion.

Soles in place and whole-body dynamics rid the program of most unknowns, see
`mgs.search.whole_body.unknowns`. What is left of a sample are the moves y (ny), in double support
the forces s (6) by which the soles press against each other, and, if work has a weight, the
positive powers (n). The curvature of the objective is that of Gauss and Newton. Solved by PIQP
(R. Schwan et al., "PIQP: a proximal interior-point quadratic programming solver", IEEE CDC, 2023),
whose multistage back end finds the blocks of neighbouring samples and factorises them as dense
matrices, in time in proportion to the number of samples.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
import piqp

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV, GRAVITY
from mgs.core.contact import Side
from mgs.search.whole_body.clearance import Clearances
from mgs.search.whole_body.dynamics import JOINTS, Point, Slopes
from mgs.search.whole_body.entries import Entries, Places, columns_of
from mgs.search.whole_body.problem import LEAST_LOAD, RESERVE, Problem
from mgs.search.whole_body.unknowns import N_PRESS, Affine, unknowns_of

NEAR_LINE = 0.5  # use of the speed-torque line from which it is part of the program
EPS = 1e-5  # of the conditions of the optimum, in the units of the program
GAP = 1e-4  # relative gap between the program and its dual
MOST_ITERATIONS = 80
LEAST_CURVATURE = 1e-6  # of coordinates that are in no term
PRESS_CURVATURE = 1e-7  # so that wrenches are unique


@dataclass(frozen=True, eq=False)
class Step:
    """The solution of a program."""

    dq: Array  # (T, 6 + n)
    w: Array  # (T, 2, 6)


class Program:
    """The program of a step of at most `trust` in every joint and coordinate of the base."""

    def __init__(
        self, problem: Problem, point: Point, slopes: Slopes, near: Clearances, trust: float
    ) -> None:
        self.problem, self.point, self.slopes, self.near = problem, point, slopes, near
        self.trust, self.n, self.nv = trust, problem.robot.n, problem.nv
        self.with_work = problem.weights.work > 0.0
        self.unknowns = unknowns_of(problem, point, slopes)
        self.moves = self.unknowns.moves
        self.unit = problem.robot.mass * GRAVITY * problem.leg  # of torques [N m]
        every = np.arange(problem.n_samples)
        counts = np.stack([
            self.moves.count * ((every > 0) & (every < every[-1])),  # the ends do not move
            N_PRESS * problem.bears.all(axis=1),
            np.full(len(every), self.n * self.with_work),
        ], axis=1)  # fmt: skip
        ends = np.cumsum(counts).reshape(counts.shape)
        self.size = int(ends[-1, -1])
        at = np.where(counts > 0, ends - counts, -1)  # first unknowns, -1 if there are none
        self.at_moves, self.at_press, self.at_power = at.T

    def solve(self) -> Step:
        """The solution that PIQP finds."""
        P, c = self._objective()
        G, low, high = self._inequalities()
        solver = piqp.SparseSolver()
        settings = solver.settings
        settings.kkt_solver = piqp.sparse_multistage
        settings.eps_abs = settings.eps_rel = EPS
        settings.eps_duality_gap_abs = settings.eps_duality_gap_rel = GAP
        settings.max_iter = MOST_ITERATIONS
        settings.preconditioner_iter = 0  # all rows and unknowns are of one size already
        solver.setup(
            P.matrix(self.size), c, None, None, G.matrix(self.size), low, high, *self._bounds()
        )
        solver.solve()
        x = np.append(solver.result.x, 0.0)  # the last one for unknowns that are 0
        y = x[columns_of(self.at_moves, self.moves.count)]
        s = x[columns_of(self.at_press, N_PRESS)]
        w = self.unknowns.wrench_units * self.unknowns.wrench.at(y, s)
        return Step(self.moves.changes(y), w.reshape(-1, 2, 6))

    def _objective(self) -> tuple[Entries, Array]:
        """The objective divided by h; the upper triangle of its matrix."""
        problem, n_samples, ny = self.problem, self.problem.n_samples, self.moves.count
        P, c = Entries(n_rows=self.size), np.zeros(self.size + 1)  # the last one for at = -1
        blocks = np.zeros((3, n_samples, ny, ny))  # of moves at k with those at k, k + 1, k + 2
        blocks[0], slope = self._configurations()
        torque, weight = self.unknowns.torque, problem.weights.torque
        by_press = weight * torque.by_press.transpose(0, 2, 1)
        for d in (-1, 0, 1):
            k = np.arange(max(-d, 0), n_samples - max(d, 0))
            part = weight * torque.by_moves[d + 1, k].transpose(0, 2, 1)
            slope[k + d] += (part @ torque.constant[k, :, None])[..., 0]
            for e in range(d, 2):
                blocks[e - d, k + d] += part @ torque.by_moves[e + 1, k]
            both = k[(self.at_press[k] >= 0) & (self.at_moves[k + d] >= 0)]
            cross = by_press[both] @ torque.by_moves[d + 1, both]
            if d == 1:  # of the unknowns of a sample those of its moves come first
                P.blocks(self.at_press[both], self.at_moves[both + d], cross)
            else:
                rows = self.at_moves[both + d]
                P.blocks(rows, self.at_press[both], cross.transpose(0, 2, 1))
        for d in range(3):
            k = np.flatnonzero(self.at_moves[: n_samples - d] >= 0)
            P.blocks(self.at_moves[k], self.at_moves[k + d], blocks[d, k])
        both = np.flatnonzero(self.at_press >= 0)
        squares = by_press[both] @ torque.by_press[both] + PRESS_CURVATURE * np.eye(N_PRESS)
        P.blocks(self.at_press[both], self.at_press[both], squares)
        c[columns_of(self.at_press, N_PRESS)] = (by_press @ torque.constant[..., None])[..., 0]
        c[columns_of(self.at_moves, ny)] = slope
        c[columns_of(self.at_power, self.n)] = problem.weights.work
        return P, c[:-1]

    def _configurations(self) -> tuple[Array, Array]:
        """Curvature (T, ny, ny) and slope (T, ny) of the terms of configurations."""
        problem, point, slopes = self.problem, self.point, self.slopes
        weights = problem.weights
        diagonal = np.full(self.nv, LEAST_CURVATURE)
        diagonal[JOINTS] += weights.distance
        curvature = np.tile(np.diag(diagonal), (problem.n_samples, 1, 1))
        slope = np.zeros((problem.n_samples, 1, self.nv))
        slope[:, 0, JOINTS] = weights.distance * point.off_joints
        terms = [(weights.upright, point.off_torso, slopes.torso)]
        terms += [
            (weights.hands / problem.leg**2, point.off_hands[:, side], slopes.hands[:, side])
            for side in Side
        ]
        for factor, off, J in terms:
            if factor > 0.0:
                curvature += factor * (J.transpose(0, 2, 1) @ J)
                slope += factor * (off[:, None] @ J)
        half = self.moves.rows(curvature).transpose(0, 2, 1)
        return self.moves.rows(half), self.moves.rows(slope)[:, 0]

    def _inequalities(self) -> tuple[Entries, Array, Array]:
        G, low, high = Entries(), [], []
        for limits in (
            self._cones, self._loads, self._speeds, self._ranges, self._torques, self._lines,
            self._clearances, self._powers,
        ):  # fmt: skip
            least, most = limits(G)
            low.append(least.ravel())
            high.append(most.ravel())
        return G, np.concatenate(low), np.concatenate(high)

    def _rows(
        self, G: Entries, k: Places, rows: Affine, most: Array | float
    ) -> tuple[Array, Array]:
        """Rows (m, r) of samples k (m,) are at most `most`; the limits of their linear parts."""
        first = G.new_rows(*rows.constant.shape)
        for d in (-1, 0, 1):
            inside = (k + d >= 0) & (k + d < self.problem.n_samples)
            at = self.at_moves[k[inside] + d]
            G.blocks(first[inside], at, rows.by_moves[d + 1, inside])
        G.blocks(first, self.at_press[k], rows.by_press)
        high = most - rows.constant
        return np.full(high.shape, -np.inf), high

    def _cones(self, G: Entries) -> tuple[Array, Array]:
        """Rows of the wrench cones of soles that bear, in parts of the weight."""
        low, high = [], []
        for side in Side:
            k = np.flatnonzero(self.problem.bears[:, side])
            part = slice(6 * side, 6 * side + 6)
            units = self.unknowns.wrench_units[part] / (self.problem.robot.mass * GRAVITY)
            wrench = self.unknowns.wrench.of(k, part).times(self.problem.cones[side] * units)
            limits = self._rows(G, k, wrench, 0.0)
            low.append(limits[0].ravel())
            high.append(limits[1].ravel())
        return np.concatenate(low), np.concatenate(high)

    def _loads(self, G: Entries) -> tuple[Array, Array]:
        """Rows of the least vertical force on both soles together, in parts of the weight."""
        units = self.unknowns.wrench_units / (self.problem.robot.mass * GRAVITY)
        vertical = np.zeros((1, len(units)))
        vertical[0, [2, 8]] = -units[[2, 8]]
        every = np.arange(self.problem.n_samples)
        return self._rows(G, every, self.unknowns.wrench.times(vertical), -LEAST_LOAD)

    def _speeds(self, G: Entries) -> tuple[Array, Array]:
        """Rows of the turn of each joint from one sample to the next."""
        moves, n_turn = self.moves, self.moves.n_turn
        legs, most = moves.moving[FLOATING_BASE_NV:] - FLOATING_BASE_NV, self.problem.speed_limit
        others = moves.free - FLOATING_BASE_NV
        turn = moves.turn[:, FLOATING_BASE_NV:]
        rows = G.new_rows(self.problem.n_samples - 1, len(legs))
        G.blocks(rows, self.at_moves[1:], turn[1:])
        G.blocks(rows, self.at_moves[:-1], -turn[:-1])
        rows = G.new_rows(self.problem.n_samples - 1, len(others))[:, None] + np.arange(len(others))
        at = columns_of(self.at_moves, moves.count)[:, n_turn:]
        G.add(rows, at[1:], np.ones(rows.shape))
        G.add(rows, at[:-1], -np.ones(rows.shape))
        v, h = self.point.v[1:-1, JOINTS], self.problem.h
        low, high = h * (-most - v), h * (most - v)
        return (
            np.concatenate([low[:, legs].ravel(), low[:, others].ravel()]),
            np.concatenate([high[:, legs].ravel(), high[:, others].ravel()]),
        )

    def _ranges(self, G: Entries) -> tuple[Array, Array]:
        """Rows of the changes of base and legs."""
        moving = self.moves.moving
        G.blocks(
            G.new_rows(self.problem.n_samples - 2, len(moving)), self.at_moves[1:-1],
            self.moves.turn[1:-1],
        )  # fmt: skip
        low, high = self._changes
        return low[1:-1, moving], high[1:-1, moving]

    def _bounds(self) -> tuple[Array, Array]:
        """Bounds of all unknowns: joints that do not move the soles, and positive powers."""
        lower, upper = np.full(self.size, -np.inf), np.full(self.size, np.inf)
        at = columns_of(self.at_moves[1:-1], self.moves.count)[:, self.moves.n_turn :]
        low, high = self._changes
        lower[at], upper[at] = low[1:-1, self.moves.free], high[1:-1, self.moves.free]
        if self.with_work:
            lower[columns_of(self.at_power, self.n)] = 0.0
        return lower, upper

    @functools.cached_property
    def _changes(self) -> tuple[Array, Array]:
        """Least and largest changes (T, 6 + n) of base and joints."""
        high = np.full((self.problem.n_samples, self.nv), self.trust)
        low = -high
        angles, (least, most) = self.point.q[:, FLOATING_BASE_NQ:], self.problem.angles
        low[:, JOINTS] = np.maximum(low[:, JOINTS], np.minimum(least - angles, 0.0))
        high[:, JOINTS] = np.minimum(high[:, JOINTS], np.maximum(most - angles, 0.0))
        return low, high

    def _torques(self, G: Entries) -> tuple[Array, Array]:
        """Rows of all torques, in parts of their limits."""
        every = np.arange(self.problem.n_samples)
        part = self.unit / (RESERVE * self.problem.robot.torque_limit)
        rows = self.unknowns.torque.times(np.diag(part))
        _, high = self._rows(G, every, rows, 1.0)
        return high - 2.0, high

    def _lines(self, G: Entries) -> tuple[Array, Array]:
        """Rows  s (tau + slope v) <= stall torque  for s = 1 and -1, where a servo is near them."""
        problem, point, robot = self.problem, self.point, self.problem.robot
        stall = RESERVE * robot.torque_limit
        slope = stall / robot.no_load_speed
        v = 0.5 * (point.v[:-1, JOINTS] + point.v[1:, JOINTS])
        use = (point.torque + slope * v) / stall
        k, j = np.nonzero((np.abs(use) > NEAR_LINE) & (use * v > 0.0))
        inside = (k > 0) & (k < problem.n_samples - 1)
        k, j = k[inside], j[inside]
        sign = np.sign(v[k, j])
        joint = np.zeros((len(k), 1, self.nv))
        joint[np.arange(len(k)), 0, FLOATING_BASE_NV + j] = sign / (
            2.0 * problem.h * robot.no_load_speed[j]
        )
        torque, part = self.unknowns.torque, sign * self.unit / stall[j]
        by_moves = part[:, None, None] * torque.by_moves[:, k, j, None]
        by_moves[0] -= self.moves.rows(joint, k - 1)
        by_moves[2] += self.moves.rows(joint, k + 1)
        rows = Affine(
            (part * torque.constant[k, j] + sign * v[k, j] / robot.no_load_speed[j])[:, None],
            by_moves, part[:, None, None] * torque.by_press[k, j, None],
        )  # fmt: skip
        return self._rows(G, k, rows, 1.0)

    def _clearances(self, G: Entries) -> tuple[Array, Array]:
        """Rows  -row . dq <= distance - least distance  for links that are near each other."""
        near = self.near
        inside = (near.samples > 0) & (near.samples < self.problem.n_samples - 1)
        k = near.samples[inside]
        rows = self.moves.rows(-near.rows[inside, None], k)
        G.blocks(G.new_rows(len(k), 1), self.at_moves[k], rows)
        high = (near.distance - near.least)[inside]
        return np.full(high.shape, -np.inf), high

    def _powers(self, G: Entries) -> tuple[Array, Array]:
        """Rows  tau dv + v tau_new - power <= 0, which make the unknown power the positive one.

        With a slope of the positive power alone a joint at rest would seem to move for nothing.
        """
        if not self.with_work:
            return np.zeros(0), np.zeros(0)
        problem, every = self.problem, np.arange(self.problem.n_samples)
        speed = np.sqrt(GRAVITY * problem.leg)
        v = self.point.v[:-1, JOINTS, None] * problem.leg / speed  # of units of torque to power
        torque, one = self.unknowns.torque, np.eye(self.nv)[None, JOINTS]
        by_moves = v * torque.by_moves
        at = G.n_rows + self.n * every
        turn = self.point.torque[..., None] / self.unit * problem.leg / (speed * problem.h)
        joints = self.moves.rows(np.broadcast_to(one, (problem.n_samples, self.n, self.nv)))
        by_moves[0, 1:] -= turn[1:] * joints[:-1]
        by_moves[1] += turn * joints
        rows = Affine(v[..., 0] * torque.constant, by_moves, v * torque.by_press)
        limits = self._rows(G, every, rows, 0.0)
        places = at[:, None] + np.arange(self.n)
        G.add(places, columns_of(self.at_power, self.n), np.full(places.shape, -1.0))
        return limits
