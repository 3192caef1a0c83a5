"""The problem of one ik4 sample as a nonlinear program for SLSQP and Ipopt.

With dq the tangent step (6 + n,) from q_prev and q = integrate(q_prev, dq), eq. (8):

    min delta^T Q delta,   delta = f_s(q) - x_s + gamma (J_s(q) dq - xdot dt)
    s.t.  f_h(q) = x_h   and, for every joint,  1 - place(q)^2 - (dq / (dt qdot_max))^2 >= 0

where place is -1 and 1 at the joint limits. The constraint is the ellipse of the safety region
itself, not the equivalent interval. Iterations of ik4 are damped by R; this problem is not. Both
solvers get exact derivatives: SLSQP the Jacobians of Pinocchio, Ipopt those of CasADi for the same
kinematics in symbolic form (no wheel contains `pinocchio.casadi`), with the Hessian.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.optimize import Bounds, minimize

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.ik_solver.floating.parts import COM
from mgs.ik_solver.floating.tasks import BodyTasks
from mgs.ik_solver.hard_soft import FarajiRun


@dataclass(frozen=True, eq=False)
class Sample:
    """One sample of a run: its start, and the initial guess of ik4."""

    k: int
    q_prev: Array  # (7 + n,)
    dq: Array  # (6 + n,) step to the start of the iterations of ik4
    is_stretched: bool  # True if a limb is close to its singularity


@dataclass(frozen=True)
class Quality:
    """Quality of the solution of one sample."""

    slack: float  # |delta|_Q [m]
    hard_error: float  # largest error of the hard rows [m] or [rad]
    region_excess: float  # left side of eq. (6), 0 or less inside the region

    def to_list(self) -> list[float]:
        """Convert to a list of numbers."""
        return [self.slack, self.hard_error, self.region_excess]


class Ik4Problem:
    """Values and derivatives of the program at one sample, by Pinocchio.

    Values of one dq are computed once and kept.
    """

    def __init__(self, run: FarajiRun) -> None:
        self.run, self.model = run, run.robot.model
        self.tasks = BodyTasks(run.robot, run.tasks.parts)
        self.m_hard = len(run.E_hard)
        self.soft = slice(self.m_hard, self.tasks.m)
        (part,) = run.tasks.parts[-1:]
        if run.solver.method != 4 or self.tasks.m - self.m_hard != 3 or part is not COM:
            raise ValueError("only ik4 with the CoM as its only soft task is supported")
        region = run.region
        self.middle, self.half = region.middle, 0.5 * (region.upper - region.lower)
        self.reach = region.speed_max * region.dt
        self.error, self.weights = np.empty(self.tasks.m), run.weights[:, 0]
        self._places = [
            (rows, self.tasks.data.oMf[frame]) for rows, frame in self._rotation_frames()
        ]
        self.set(Sample(0, run.q.copy(), np.zeros(self.model.nv), False))

    def _rotation_frames(self) -> list[tuple[slice, int]]:
        found = []
        for part, rows in self.tasks.rows.items():
            if part.turns and part.frame is not None:
                turned = slice(rows.start + part.n_axes, rows.stop)
                found.append((turned, part.frame(self.run.robot)))
        return found

    def set(self, sample: Sample) -> None:
        """Select a sample."""
        targets, k = self.run.targets, sample.k
        self.q_prev, self.x, self.rotations = sample.q_prev, targets.x[k], targets.rotations[k]
        self.step = self.run.steps_soft[k]
        self._at = self._derived_at = b""

    def _update(self, dq: Array) -> None:
        key = dq.tobytes()
        if key == self._at:
            return
        self._at = key
        self.q = pin.integrate(self.model, self.q_prev, dq)
        self.tasks.update(self.q)
        self.tasks.error(self.x, self.rotations, self.error)
        J = self.tasks.J[self.soft]
        self.delta = self.run.gamma * (J.dot(dq) - self.step) - self.error[self.soft]

    def _derive(self, dq: Array) -> None:
        self._update(dq)
        if self._derived_at == self._at:
            return
        self._derived_at = self._at
        J = self.tasks.J.copy()
        for (rows, placement), R_ref in zip(self._places, self.rotations, strict=True):
            J[rows] = pin.Jlog3(R_ref.dot(placement.rotation.T)).dot(J[rows])
        # d integrate(q_prev, dq) / d dq, in the tangent space at q
        turn = pin.dIntegrate(self.model, self.q_prev, dq, pin.ARG1)
        gamma, J_soft = self.run.gamma, J[self.soft]
        moved = J_soft + gamma * self.tasks.com_velocity_derivative(self.q, dq)
        self._d_delta = moved.dot(turn) + gamma * J_soft
        self._d_hard = J[: self.m_hard].dot(turn)

    def objective(self, dq: Array) -> float:
        """Objective delta^T Q delta [m^2]."""
        self._update(dq)
        return float(self.delta.dot(self.weights * self.delta))

    def gradient(self, dq: Array) -> Array:
        """Gradient of the objective."""
        self._derive(dq)
        return 2.0 * (self.weights * self.delta).dot(self._d_delta)

    def hard(self, dq: Array) -> Array:
        """Residuals f_h - x_h of the hard rows."""
        self._update(dq)
        return -self.error[: self.m_hard]

    def hard_jacobian(self, dq: Array) -> Array:
        """Jacobian of the residuals of the hard rows."""
        self._derive(dq)
        return self._d_hard

    def room(self, dq: Array) -> Array:
        """Left sides (n,) of the region constraints: 0 on the ellipse, positive inside."""
        joints = dq[FLOATING_BASE_NV:]
        place = (self.q_prev[FLOATING_BASE_NQ:] + joints - self.middle) / self.half
        return 1.0 - place**2 - (joints / self.reach) ** 2

    def room_jacobian(self, dq: Array) -> Array:
        """Jacobian of the region constraints."""
        joints = dq[FLOATING_BASE_NV:]
        place = (self.q_prev[FLOATING_BASE_NQ:] + joints - self.middle) / self.half
        J = np.zeros((len(joints), len(dq)))
        diagonal = -2.0 * (place / self.half + joints / self.reach**2)
        np.fill_diagonal(J[:, FLOATING_BASE_NV:], diagonal)
        return J

    def quality(self, dq: Array) -> Quality:
        """Quality of a solution dq."""
        return Quality(
            slack=float(np.sqrt(self.objective(dq))),
            hard_error=float(np.abs(self.hard(dq)).max()),
            region_excess=float(-self.room(dq).min()),
        )


class Slsqp:
    """SLSQP of SciPy for this program.

    Args:
        problem: the nonlinear program.
        maxiter: largest number of iterations.
        ftol: tolerance of SLSQP for the objective [m^2] and the sum of the violations.
        intervals: use the intervals of mgs as bounds instead of the ellipses.
        exact: use exact Jacobians instead of finite differences.
    """

    def __init__(
        self,
        problem: Ik4Problem,
        maxiter: int,
        ftol: float,
        intervals: bool = False,
        exact: bool = True,
    ) -> None:
        self.problem, self.options = problem, {"maxiter": maxiter, "ftol": ftol}
        self.intervals = intervals
        p = problem
        self.gradient = p.gradient if exact else None
        self.constraints: list[dict[str, Any]] = [{"type": "eq", "fun": p.hard}]
        if not intervals:
            self.constraints.append({"type": "ineq", "fun": p.room})
        if exact:
            for constraint, jac in zip(
                self.constraints, (p.hard_jacobian, p.room_jacobian), strict=False
            ):
                constraint["jac"] = jac
        n = p.run.robot.n
        self.low, self.high = np.full(p.model.nv, -np.inf), np.full(p.model.nv, np.inf)
        self._interval = np.empty((2, n))

    def solve(self, sample: Sample) -> tuple[Array, int]:
        """Solve one sample; returns the step dq and the number of iterations."""
        p, bounds = self.problem, None
        p.set(sample)
        if self.intervals:
            joints, low, high = sample.q_prev[FLOATING_BASE_NQ:], *self._interval
            p.run.region.interval(joints, low, high)
            self.low[FLOATING_BASE_NV:], self.high[FLOATING_BASE_NV:] = low - joints, high - joints
            bounds = Bounds(self.low, self.high)
        found = minimize(
            p.objective,
            sample.dq,
            jac=self.gradient,
            method="SLSQP",
            bounds=bounds,
            constraints=self.constraints,
            options=self.options,
        )
        return found.x, int(found.nit)
