"""Sequential quadratic programming with a trust region, on motions whose soles are in place.

After each step Newton's method brings the soles back to their places and the wrenches back to the
dynamics of the base, so that only inequalities can be violated. A step is kept if it lowers

    objective + PENALTY h sum_k (what inequalities are violated by)
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
from mgs.search.whole_body.dynamics import JOINTS, Point, objective, point_at, slopes_at
from mgs.search.whole_body.problem import RESERVE, Problem
from mgs.search.whole_body.program import Program

TRUST, WIDER, NARROWER = 0.1, 1.5, 0.3  # [rad] and [m], and factors
LEAST_TRUST = 1e-4
PENALTY = 100.0
ENOUGH = 2e-3  # relative decrease below which the search ends
NO_VIOLATION = 1e-4  # part of a limit that counts as none


@dataclass(frozen=True)
class Violations:
    """By how much the worst sample violates each kind of limit, as a part of it, or 0."""

    wrench: float  # of m g, in the rows of the cone
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
    here = point_at(problem, problem.plan)
    merit, history, trust = _merit(problem, here), [objective(problem, here)], TRUST
    slopes = slopes_at(problem, here)
    for iteration in range(iterations):
        if progress is not None:
            progress(iteration, iterations)
        step = Program(problem, here, slopes, trust).solve()
        longest = float(np.abs(step.dq).max())
        if not np.isfinite(longest):
            break
        moved = np.array([
            pin.integrate(problem.robot.model, a, d)
            for a, d in zip(here.q, step.dq, strict=True)
        ])  # fmt: skip
        there = point_at(problem, moved, step.w)
        found = _merit(problem, there)
        if found < merit:
            fell, here, merit = merit - found, there, found
            history.append(objective(problem, here))
            if fell < ENOUGH * merit:
                break
            slopes = slopes_at(problem, here)
            trust *= WIDER if longest > 0.9 * trust else 1.0
        else:
            trust = NARROWER * min(trust, longest)
            if trust < LEAST_TRUST:
                break
    if progress is not None:
        progress(iterations, iterations)
    return Solution(here, tuple(history), violations(problem, here))


def _excesses(problem: Problem, point: Point) -> dict[str, Array]:
    """What every inequality of the programs is violated by, in parts of its limit, or 0."""
    robot = problem.robot
    inside, near = problem.angles, problem.clearance.along(point.q, with_rows=False)
    q, v = point.q[:, FLOATING_BASE_NQ:], point.v[1:-1, JOINTS]
    excess = {
        "wrench": _out_of_cone(problem, point, problem.cones),
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
    near = problem.clearance.along(point.q, with_rows=False)
    excess = {
        "wrench": _out_of_cone(problem, point, problem.whole_cones),
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


def _out_of_cone(problem: Problem, point: Point, cones: tuple[Array, Array]) -> Array:
    """Rows (2, T, 16) of the wrench cones, in parts of the weight; positive outside."""
    weight = problem.robot.mass * GRAVITY
    rows = [point.w[:, side] @ cones[side].T / weight for side in Side]
    return np.stack(rows)


def _merit(problem: Problem, point: Point) -> float:
    over = sum(float(values.sum()) for values in _excesses(problem, point).values())
    return objective(problem, point) + PENALTY * problem.h * over
