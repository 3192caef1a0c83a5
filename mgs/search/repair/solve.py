"""The motion nearest to a reference that meets its constraints, for all samples at once.

    min over q   sum_k |e_k|_W^2 dt + smoothness / dt^3 sum_k |e_k-1 - 2 e_k + e_k+1|^2
    s.t.         the constraints of `mgs.search.repair.constraints`

e_k is the difference of q_k from the reference. The method is that of multipliers (M. R. Hestenes,
"Multiplier and gradient methods", J. Optimization Theory and Applications 4, 1969): each constraint
adds weight / 2 |r + s|^2, only where r + s > 0 if it is an inequality, and after each round the
shift s becomes what is in the bars. Each round takes Gauss-Newton steps, whose matrix is banded:
samples are coupled to the next two by smoothness and by the ZMP.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.progress import Progress
from mgs.ik_solver.banded import coupling, second_differences
from mgs.judge.audit import GivenMotion
from mgs.judge.audit.body import Body, body_along
from mgs.search.repair.band import empty_blocks
from mgs.search.repair.constraints import Constraints, Residuals
from mgs.search.repair.linear import Linear, Shifts

STEPS, HALVINGS = 6, 6  # of a round
# what each round has of the weight of the ZMP: while soles are not yet in their places,
# accelerations mean nothing
ZMP_SHARES = (0.0, 0.0, 1e-3, 1e-2, 0.1, 1.0, 1.0, 1.0, 1.0)
WEIGHTS = {"pose": 1e6, "floor": 1e6, "range": 1e4, "speed": 1e4, "zmp": 1e3}
BASE_PLACE, BASE_TURN = 20.0, 1.0  # weights of the base's part of e, 1 for a joint
BASE_SMOOTHNESS = 1e-2  # [s^4]
ENOUGH = 1e-4  # relative decrease at which the steps of a round end
DAMPING = 1e-6
LARGEST = 0.03  # [m] and [rad] of a shift, so that what cannot be met does not take over


@dataclass(frozen=True, eq=False)
class Point:
    """A motion with its residuals and its penalised objective."""

    given: GivenMotion
    body: Body
    e: Array  # (T, p)
    residuals: Residuals
    objective: float


class Problem:
    """Objective, gradient and curvature of a repair."""

    def __init__(self, constraints: Constraints, reference: GivenMotion, smoothness: float) -> None:
        self.constraints, self.reference = constraints, reference
        dt, p = reference.dt, FLOATING_BASE_NV + reference.robot.n
        self.weight = np.ones(p)
        self.weight[:3], self.weight[3:FLOATING_BASE_NV] = BASE_PLACE, BASE_TURN
        self.weight *= dt
        self.smoothness = np.full(p, smoothness / dt**3)
        self.smoothness[:FLOATING_BASE_NV] = BASE_SMOOTHNESS / dt**3
        self.weights = dict(WEIGHTS)
        self.scale = dt  # of the weights of constraints, so that finer sampling changes nothing

    def at(self, q: Array, shifts: Shifts) -> Point:
        """The motion q (T, 7 + n)."""
        given = dataclasses.replace(self.reference, q=q)
        body = body_along(given, smoothing=0.0)
        e = differences(given, self.reference.q)
        residuals = self.constraints.residuals(given, body)
        cost = 0.5 * float(np.sum(self.weight * e * e))
        cost += 0.5 * float(np.sum(self.smoothness * second_differences(e) ** 2))
        for name, r in vars(residuals).items():
            active = _active(name, r, shifts[name])
            cost += 0.5 * self.scale * self.weights[name] * float(np.sum(active**2))
        return Point(given, body, e, residuals, cost)

    def step(self, point: Point, shifts: Shifts) -> Array:
        """Gauss-Newton step (T, p)."""
        n_samples, p = point.e.shape
        blocks = empty_blocks(n_samples, p)
        g = self.weight * point.e
        g += self.smoothness * second_differences(second_differences(point.e))
        on = np.arange(p)
        for d, part in enumerate(coupling(n_samples)):
            blocks[d][:, on, on] += self.smoothness * part[:, None]
        blocks[0][:, on, on] += self.weight + DAMPING
        shifted = {name: r + shifts[name] for name, r in vars(point.residuals).items()}
        linear = Linear(self.constraints, point.given.q, point.body, shifted)
        curvature, gradient = linear.pose_part(self.scale * self.weights["pose"])
        blocks[0] += curvature
        g += gradient
        weights = {name: self.scale * weight for name, weight in self.weights.items()}
        return linear.step(blocks, g, weights)


def _active(name: str, r: Array, shift: Array) -> Array:
    """What of r + s counts: all of an equality, the positive part of an inequality."""
    return r + shift if name == "pose" else np.maximum(r + shift, 0.0)


def differences(given: GivenMotion, reference: Array) -> Array:
    """Differences (T, p) of the motion from a reference (T, 7 + n) in its tangent."""
    model = given.robot.model
    return np.array([pin.difference(model, a, b) for a, b in zip(reference, given.q, strict=True)])


def solve(problem: Problem, q: Array, progress: Progress | None = None) -> Point:
    """The motion found from q (T, 7 + n)."""
    model = problem.reference.robot.model
    shifts = _no_shifts(problem, q)
    point = problem.at(q, shifts)
    for turn, share in enumerate(ZMP_SHARES):
        problem.weights["zmp"] = share * WEIGHTS["zmp"]
        point = problem.at(point.given.q, shifts)
        for _ in range(STEPS):
            if progress is not None:
                progress(turn, len(ZMP_SHARES))
            step = problem.step(point, shifts)
            size, found = 1.0, None
            for _ in range(HALVINGS):
                moved = np.array(
                    [
                        pin.integrate(model, a, s)
                        for a, s in zip(point.given.q, size * step, strict=True)
                    ]
                )
                trial = problem.at(moved, shifts)
                if trial.objective < point.objective:
                    found = trial
                    break
                size *= 0.5
            if found is None:
                break
            fell, point = point.objective - found.objective, found
            if fell < ENOUGH * point.objective:
                break
        for name, r in vars(point.residuals).items():
            if name == "zmp" and share < 1.0:
                continue
            shifts[name] = np.clip(_active(name, r, shifts[name]), -LARGEST, LARGEST)
    return point


def _no_shifts(problem: Problem, q: Array) -> Shifts:
    n_samples, n = len(q), problem.reference.robot.n
    return {
        "pose": np.zeros((n_samples, 2, 6)),
        "floor": np.zeros((n_samples, 2, 4)),
        "range": np.zeros((n_samples, 2, n)),
        "speed": np.zeros((n_samples - 1, 2, n)),
        "zmp": np.zeros((n_samples, 8)),
    }
