"""Sequential quadratic programming with a trust region, on motions whose soles are in place.

After each step Newton's method brings the soles back to their places and the wrenches back to the
dynamics of the base, so that only inequalities can be violated. Of a step the largest of some parts
is kept that lowers

    objective + PENALTY h sum_k (what inequalities are violated by)

If the motion that was found still violates a limit, a few more steps follow with larger penalties.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, GRAVITY
from mgs.core.contact import Side
from mgs.core.progress import Progress
from mgs.robot import Robot
from mgs.search.whole_body.clearance import Clearances
from mgs.search.whole_body.dynamics import JOINTS, Point, objective, point_at, slopes_at
from mgs.search.whole_body.problem import LEAST_LOAD, RESERVE, Problem
from mgs.search.whole_body.program import Program, Step

TRUST, WIDER = 0.1, 1.5  # [rad] and [m], and a factor
PARTS = (1.0, 0.5, 0.25, 0.1)  # of a step that are tried
LEAST_TRUST = 1e-4
PENALTY, HARDER = 3.0, 30.0
MOST_RESTORATIONS = 5
ENOUGH = 2e-3  # relative decrease below which the search ends
NO_VIOLATION = 1e-4  # part of a limit that counts as none


@dataclass(frozen=True)
class Violations:
    """By how much the worst sample violates each kind of limit, as a part of it, or 0."""

    wrench: float  # of m g, in the rows of the cone
    load: float  # of m g, on both soles together
    range: float  # [rad]
    speed: float
    torque: float
    clearance: float  # [m] by which links overlap

    @property
    def worst(self) -> float:
        """The largest of these violations."""
        return max(dataclasses.astuple(self))


@dataclass(frozen=True, eq=False)
class Solution:
    """The motion that was found."""

    point: Point
    objective: tuple[float, ...]  # at the start and after each step that was kept
    violations: Violations


def solve(problem: Problem, iterations: int, progress: Progress | None = None) -> Solution:
    """Improve the plan of a problem in at most so many steps."""
    search = _Search(problem)
    for iteration in range(iterations):
        if progress is not None:
            progress(iteration, iterations)
        if not search.step():
            break
    for _ in range(MOST_RESTORATIONS):
        if violations(problem, search.here).worst <= NO_VIOLATION:
            break
        search.restore()
    if progress is not None:
        progress(iterations, iterations)
    history = tuple(search.history)
    return Solution(search.here, history, violations(problem, search.here))


class _Search:
    """The motion found so far, and the size of the next step."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.trust, self.penalty = problem, TRUST, PENALTY
        self.here = point_at(problem, problem.plan)
        self.near = problem.clearance.along(self.here.q)
        self.merit = self._merit(self.here, self.near)
        self.history = [objective(problem, self.here)]

    def step(self) -> bool:
        """Solve one program and go as far along its step as the merit falls; True to go on."""
        problem, here = self.problem, self.here
        program = Program(problem, here, slopes_at(problem, here), self.near, self.trust)
        step, before = program.solve(), self.merit
        longest = float(np.abs(step.dq).max())
        if not np.isfinite(longest):
            return False
        for part in PARTS:
            if self._accept(step, part):
                break
        else:
            self.trust = PARTS[-1] * min(self.trust, longest)
            return self.trust > LEAST_TRUST
        if part < 1.0:
            self.trust = part * longest
        elif longest > 0.9 * self.trust:
            self.trust *= WIDER
        self.history.append(objective(problem, self.here))
        return before - self.merit >= ENOUGH * before

    def _accept(self, step: Step, part: float) -> bool:
        """Go a part of a step if the merit is lower there."""
        problem, here = self.problem, self.here
        moved = [
            pin.integrate(problem.robot.model, a, part * d)
            for a, d in zip(here.q, step.dq, strict=True)
        ]
        there = point_at(problem, np.array(moved), here.w + part * (step.w - here.w))
        near = problem.clearance.along(there.q)
        merit = self._merit(there, near)
        if merit >= self.merit:
            return False
        self.here, self.near, self.merit = there, near, merit
        return True

    def restore(self) -> None:
        """A step for which what is violated counts more."""
        self.penalty *= HARDER
        self.merit = self._merit(self.here, self.near)
        self.step()

    def _merit(self, point: Point, near: Clearances) -> float:
        problem = self.problem
        over = sum(float(values.sum()) for values in _excesses(problem, point, near).values())
        return objective(problem, point) + self.penalty * problem.h * over


def _excesses(problem: Problem, point: Point, near: Clearances) -> dict[str, Array]:
    """What every inequality of the programs is violated by, in parts of its limit, or 0."""
    robot = problem.robot
    inside = problem.angles
    q, v = point.q[:, FLOATING_BASE_NQ:], point.v[1:-1, JOINTS]
    excess = {
        "wrench": _out_of_cone(problem, point, problem.cones),
        "load": LEAST_LOAD - _load(problem, point),
        "range": np.maximum(inside[0] - q, q - inside[1]),
        "speed": (np.abs(v) - problem.speed_limit) / robot.speed_limit,
        "torque": torque_use(robot, point) / RESERVE - 1.0,
        "clearance": (near.least - near.distance) / problem.leg,
    }
    return {name: np.maximum(values, 0.0) for name, values in excess.items()}


def violations(problem: Problem, point: Point) -> Violations:
    """The worst violations of the limits of the robot, and of the soles without their margin."""
    robot = problem.robot
    q, v = point.q[:, FLOATING_BASE_NQ:], point.v[1:-1, JOINTS]
    near = problem.clearance.along(point.q)
    excess = {
        "wrench": _out_of_cone(problem, point, problem.whole_cones),
        "load": LEAST_LOAD - _load(problem, point),
        "range": np.maximum(robot.lower - q, q - robot.upper),
        "speed": np.abs(v) / robot.speed_limit - 1.0,
        "torque": torque_use(robot, point) - 1.0,
        "clearance": -near.distance[np.isfinite(near.least)],
    }
    return Violations(**{name: float(values.max(initial=0.0)) for name, values in excess.items()})


def torque_use(robot: Robot, point: Point) -> Array:
    """Torques (T, n) as parts of the speed-torque line, or of stall torque in braking."""
    speed = 0.5 * (point.v[:-1, JOINTS] + point.v[1:, JOINTS])
    braked = np.abs(point.torque) / robot.torque_limit
    driven = braked + np.abs(speed) / robot.no_load_speed
    return np.where(point.torque * speed > 0.0, driven, braked)


def _load(problem: Problem, point: Point) -> Array:
    """Vertical forces (T,) on both soles together, in parts of the weight."""
    return point.w[..., 2].sum(axis=1) / (problem.robot.mass * GRAVITY)


def _out_of_cone(problem: Problem, point: Point, cones: tuple[Array, Array]) -> Array:
    """Rows (2, T, 16) of the wrench cones, in parts of the weight; positive outside."""
    weight = problem.robot.mass * GRAVITY
    rows = [point.w[:, side] @ cones[side].T / weight for side in Side]
    return np.stack(rows)
