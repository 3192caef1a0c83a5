"""IK1 to IK5: positions solved for directly, so that a leg may stretch and bend again.

S. Faraji and A. J. Ijspeert, "Singularity-tolerant inverse kinematics for bipedal robots". Tasks
f(q) are hard (h) or soft (s); soft ones have a slack that is weighed by Q, joint steps are damped
by R. With E = x - f(q), v = q - q_prev, xdot dt = x[k] - x[k-1], per iteration:

    ik1  min |J_s dq - E_s|_Q^2 + |dq|_R^2   s.t.  J_h dq = E_h                 one iteration
    ik2  the same, n iterations; velocities from a second problem of the same form for xdot
    ik3  ik1 within the safety region
    ik4  min |E_s - J_s dq + gamma (xdot dt - J_s (v + dq))|_Q^2 + |dq|_R^2     n iterations, within
    ik5  min |E_s - J_s dq|_Q^2 + gamma |xdot dt - J_s (v + dq)|_Q^2 + |dq|_R^2 n iterations, within

With q_prev given the safety region is an interval for each joint (`safety_region`), so that each
iteration is a small QP; R damps iterations, not the solution that they converge to. A robot with
more joints than tasks is drawn to its half-sitting posture by a term of small weight.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.errors import ConfigError
from mgs.gait import FarajiParameters, IkParameters
from mgs.ik_solver.floating.safety_region import SafetyRegion
from mgs.ik_solver.floating.stretched_joints import stretched_joints
from mgs.ik_solver.floating.tasks import COM_AXES, BodyTargets, BodyTasks, body_targets, parts_of
from mgs.ik_solver.joint_trajectory import JointTrajectory
from mgs.ik_solver.qp import BoundedQp, solve_equality
from mgs.ik_solver.residuals import measure_tasks, refuse_limits, refuse_misses, task_misses
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

DEFAULT_ITERATIONS = 15
POSTURE_WEIGHT = 1e-6  # small against a squared lever arm [m^2]
HELD_WEIGHT = 0.1  # of joints that follow their posture, large against it
NEAR_STRETCHED = 0.08  # [rad] from where an iteration does not start
MAX_START_ITERATIONS = 200
ROUNDING = 1e-9  # [rad] by which an interval that ends at a limit may overstep it
CONVERGED = 1e-7  # [rad] and [m], step at which iterations end
N_REPORTS = 50  # of progress


@dataclass(frozen=True, kw_only=True)
class FarajiIk:
    """One of the five methods and its tuning."""

    method: int  # 1 to 5
    tuning: FarajiParameters = field(default_factory=FarajiParameters)
    iterations: int = DEFAULT_ITERATIONS  # n of ik2, ik4 and ik5
    keep: bool = False  # record a missed hard task or a broken limit instead of refusing it

    @classmethod
    def from_parameters(cls, parameters: IkParameters) -> FarajiIk:
        """Solver with the tuning of a gait file."""
        iterations = parameters.iterations
        if iterations == 0:
            raise ConfigError("ik.iterations", "0 leaves ik1 to ik5 nothing to do; at least 1")
        return cls(
            method=int(parameters.solver.removeprefix("ik")),
            tuning=parameters.faraji,
            iterations=DEFAULT_ITERATIONS if iterations is None else iterations,
            keep=parameters.on_limit == "record",
        )

    @property
    def is_bounded(self) -> bool:
        """Whether the safety region holds."""
        return self.method >= 3

    def solve(
        self,
        robot: Robot,
        tasks: TaskTrajectory,
        com: ComTrajectory,
        progress: Callable[[int, int], None] | None = None,
    ) -> JointTrajectory:
        """Follow the tasks from the half-sitting posture; see `IkSolver.solve` for the errors."""
        run = FarajiRun(self, robot, tasks, com)
        run.start()
        n = tasks.n_samples
        for k in range(n):
            run.step(k)
            if progress is not None and (k + 1) % max(1, n // N_REPORTS) == 0:
                progress(k + 1, n)
        return run.finish()


class FarajiRun:
    """One pass over a trajectory: the buffers, and one step per sample.

    Attributes:
        q: (7 + n,) configuration after the last step.
        H, g, A, b: the quadratic program of the last iteration, in dq (6 + n,).
    """

    def __init__(
        self, solver: FarajiIk, robot: Robot, tasks: TaskTrajectory, com: ComTrajectory
    ) -> None:
        self.solver, self.robot, self.model, self.dt = solver, robot, robot.model, tasks.dt
        tuning = solver.tuning
        hard, soft = parts_of(tuning.hard, tasks), parts_of(tuning.soft, tasks)
        self.hard = hard
        self.tasks = BodyTasks(robot, (*hard, *soft))
        self.targets: BodyTargets = body_targets((*hard, *soft), tasks, com)
        m, nv = self.tasks.m, robot.model.nv
        m_soft = sum(_size(self.tasks.rows[part]) for part in soft)
        m_hard = m - m_soft
        if m_hard == 0:
            raise ConfigError(
                "ik.faraji.hard", "nothing is asked of the hands in this motion; add another task"
            )
        self.J_hard, self.J_soft = self.tasks.J[:m_hard], self.tasks.J[m_hard:]
        self.error = np.zeros(m)
        self.E_hard, self.E_soft = self.error[:m_hard], self.error[m_hard:]
        self.steps_hard, self.steps_soft = np.split(self.targets.steps, [m_hard], axis=1)
        gamma = tuning.gamma if solver.method >= 4 else 0.0
        self.gamma, self.gamma_hard = gamma, gamma if tuning.gamma_rows == "all" else 0.0
        self.weights = self._weights(soft)
        self._soft_com = [
            (slice(self.tasks.rows[p].start - m_hard, self.tasks.rows[p].stop - m_hard), axes)
            for p, axes in COM_AXES.items()
            if p in soft
        ]
        self.iterations = solver.iterations if solver.method in (2, 4, 5) else 1
        spare = nv - m
        posture = tuning.posture_weight
        default = POSTURE_WEIGHT if spare > 0 else 0.0
        # beside the soft rows' own pull at rest, where the gamma term is nothing
        weight = np.full(robot.n, default if posture is None else posture)
        if tasks.posture is not None:
            weight[tasks.posture.held] = HELD_WEIGHT
        self.posture_weight = weight * (1.0 + gamma if solver.method == 4 else 1.0)
        self.damping = np.full(nv, tuning.damping)
        self.damping[FLOATING_BASE_NV:] += self.posture_weight
        self.region = SafetyRegion(
            robot.lower + tuning.margin,
            robot.upper - tuning.margin,
            _speed_max(robot, tuning),
            tasks.dt,
            tuning.region,
        )
        self.stretched, self.stretched_at = stretched_joints(robot)
        self.qp = BoundedQp(nv, m_hard)
        self.low, self.high = np.empty(robot.n), np.empty(robot.n)
        self.q = robot.standing_q.copy()
        if tasks.start is not None:
            self.q[FLOATING_BASE_NQ:] = tasks.start
        # that joints left over are drawn to, at every sample
        self.posture = (
            np.tile(self.q[FLOATING_BASE_NQ:], (tasks.n_samples, 1))
            if tasks.posture is None
            else tasks.posture.angles
        )
        self.H, self.g = np.zeros((nv, nv)), np.zeros(nv)
        self.A, self.b = self.J_hard, self.E_hard
        self._diagonal = self.H.ravel()[:: nv + 1]  # a view
        self._turned = np.empty((m_soft, nv))
        self.configurations = np.empty((tasks.n_samples, robot.model.nq))
        self.velocities = np.empty((tasks.n_samples, robot.n)) if solver.method == 2 else None
        self.elastic: list[int] = []
        self.recovering: list[int] = []

    def _weights(self, soft: tuple[str, ...]) -> Array:
        """Q (m_soft, 1), row by row."""
        named = self.solver.tuning.soft
        rows: list[float] = []
        for part in soft:
            name = "soles" if part.endswith("sole") else "hands" if part.endswith("hand") else part
            weights = named[name]  # type: ignore[index]
            rows += [*weights, *weights] if name == "soles" else weights
        return np.array(rows)[:, None]

    def start(self) -> None:
        """Bring q from the half-sitting posture onto the first sample, at any speed."""
        region, joints = self.region, self.q[FLOATING_BASE_NQ:]
        tight = np.flatnonzero(region.lower >= region.upper)
        if len(tight):
            half = 0.5 * (self.robot.upper - self.robot.lower).min()
            raise ConfigError(
                "ik.faraji.margin",
                f"{self.solver.tuning.margin:g} rad on either side leaves nothing of the range of "
                f"{self.robot.joint_names[int(tight[0])]}; below {half:.4f} on this robot",
            )
        outside = np.flatnonzero((joints < region.lower) | (joints > region.upper))
        if len(outside):
            j = int(outside[0])
            raise ConfigError(
                "ik.faraji.margin",
                f"the posture has {self.robot.joint_names[j]} at {joints[j]:.4f} rad, outside "
                f"[{region.lower[j]:.4f}, {region.upper[j]:.4f}], its range less the margin; "
                "use a smaller margin",
            )
        self.low[:], self.high[:] = region.lower, region.upper
        for _ in range(MAX_START_ITERATIONS):
            if self._iterate(0, 0.0, 0.0, None) < CONVERGED:
                break

    def step(self, k: int) -> None:
        """Go on to sample k."""
        q_prev, solver = self.q, self.solver
        if solver.is_bounded:
            if self.region.interval(q_prev[FLOATING_BASE_NQ:], self.low, self.high):
                self.recovering.append(k)
            if self.gamma or self.iterations > 1:
                self._leave_singularity()
        for _ in range(self.iterations):
            moved = self._iterate(k, self.gamma, self.gamma_hard, q_prev)
            if moved < CONVERGED:
                break
        if solver.is_bounded:
            joints = self.q[FLOATING_BASE_NQ:]
            np.maximum(joints, self.low, out=joints)  # to rounding
            np.minimum(joints, self.high, out=joints)
        if self.qp.elastic and solver.is_bounded:
            self.elastic.append(k)
        self.configurations[k] = self.q
        if self.velocities is not None:
            self.velocities[k] = self._second_problem(k)

    def _leave_singularity(self) -> None:
        """Start from bent limbs: at a singularity linearised hard rows contradict the bounds."""
        off = np.abs(self.q[FLOATING_BASE_NQ:][self.stretched] - self.stretched_at)
        if not (off < NEAR_STRETCHED).any():
            return
        self.q = self.q.copy()
        joints = self.q[FLOATING_BASE_NQ:]
        for j, angle, distance in zip(self.stretched, self.stretched_at, off, strict=True):
            if distance < NEAR_STRETCHED:
                inward = self.region.middle[j] > angle
                joints[j] = self.high[j] if inward else self.low[j]

    def _iterate(self, k: int, gamma: float, gamma_hard: float, q_prev: Array | None) -> float:
        """One linearisation about q, one step; its length."""
        tasks, q = self.tasks, self.q
        tasks.update(q)
        tasks.error(self.targets.x[k], self.targets.rotations[k], self.error)
        self.b = self.E_hard
        if gamma and q_prev is not None:
            # in the first iteration nothing has moved yet
            v = None if q is q_prev else pin.difference(self.model, q_prev, q)
            if gamma_hard:
                lag = self.steps_hard[k] - (0.0 if v is None else self.J_hard.dot(v))
                self.b = (self.E_hard + gamma_hard * lag) / (1.0 + gamma_hard)
            self._set_gamma_objective(q, v, self.steps_soft[k], gamma)
        else:
            self._set_objective(self.J_soft, self.E_soft, self.weights)
        joints = q[FLOATING_BASE_NQ:]
        self.g[FLOATING_BASE_NV:] -= self.posture_weight * (self.posture[k] - joints)
        if not self.solver.is_bounded:
            dq = solve_equality(self.H, self.g, self.A, self.b)
            self.q = pin.integrate(self.model, q, dq)
        else:
            np.subtract(self.low, joints, out=self.qp.low)
            np.subtract(self.high, joints, out=self.qp.high)
            dq = self.qp.solve(self.H, self.g, self.A, self.b)
            self.q = pin.integrate(self.model, q, dq)
        return math.sqrt(dq.dot(dq))

    def _set_gamma_objective(self, q: Array, v: Array | None, step: Array, gamma: float) -> None:
        """Fill H and g of ik4 or ik5, for v (6 + n,) from q_prev to q and step (m_soft,) = xdot dt.

        v is None where q is q_prev.

        J(q) v depends on q by v and by J. At a stretched knee, where J itself vanishes, the latter
        is all there is; of the soft tasks it is taken into account for the CoM.
        """
        J, E, turned = self.J_soft, self.E_soft, self._turned
        np.copyto(turned, J)  # derivative of J v by q
        if v is None:
            lag = step.copy()
        else:
            lag = step - J.dot(v)
            for rows, axes in self._soft_com:
                turned[rows] += self.tasks.com_velocity_derivative(q, v)[axes]
        if self.solver.method == 4:
            turned *= gamma
            turned += J
            lag *= gamma
            lag += E
            self._set_objective(turned, lag, self.weights)
        else:
            Q = self.weights
            both = np.concatenate([J, turned])
            self._set_objective(both, np.concatenate([E, lag]), np.concatenate([Q, gamma * Q]))

    def _set_objective(self, J: Array, error: Array, weights: Array) -> None:
        """Fill H = J^T Q J + R and g = -J^T Q e, for weights (m, 1)."""
        QJ = weights * J
        np.dot(J.T, QJ, out=self.H)
        self._diagonal += self.damping
        np.dot(error, QJ, out=self.g)
        np.negative(self.g, out=self.g)

    def _second_problem(self, k: int) -> Array:
        """Joint velocities (n,) of ik2, eq. (5)."""
        self.tasks.update(self.q)
        self._set_objective(self.J_soft, self.steps_soft[k], self.weights)
        dq = solve_equality(self.H, self.g, self.A, self.steps_hard[k])
        return dq[FLOATING_BASE_NV:] / self.dt

    def finish(self) -> JointTrajectory:
        """The joint trajectory; raises IkError or JointLimitError where tasks or limits are missed.

        The hard tasks are measured anew at every sample, not taken from the last linearisation.
        """
        errors = measure_tasks(self.tasks, self.targets, self.configurations)
        joints = self.configurations[:, FLOATING_BASE_NQ:].copy()
        near = np.clip(joints, self.robot.lower, self.robot.upper)
        np.copyto(joints, near, where=np.abs(near - joints) < ROUNDING)
        if not self.solver.keep:
            misses = task_misses(self.tasks, errors)
            refuse_misses([miss for miss in misses if miss.part in self.hard], self.dt)
            refuse_limits(self.robot, joints, self.dt)
        report: dict[str, object] = {
            "hard_error": float(np.abs(errors[:, : len(self.E_hard)]).max()),
            "elastic_samples": len(self.elastic),
            "recovering_samples": len(self.recovering),
        }
        return JointTrajectory(joints, self.velocities, report)


def _size(rows: slice) -> int:
    return int(rows.stop - rows.start)


def _speed_max(robot: Robot, tuning: FarajiParameters) -> Array:
    if tuning.speed_max is None:
        return robot.speed_limit
    return np.minimum(tuning.speed_max, robot.speed_limit)
