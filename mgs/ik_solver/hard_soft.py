"""Inverse kinematics IK1 to IK5, which solve for positions: a leg may stretch and bend again.

S. Faraji and A. J. Ijspeert, "Singularity-tolerant inverse kinematics for bipedal robots: an
efficient use of computational power to reduce energy consumption", IEEE Robotics and Automation
Letters 2(2), 2017. Tasks f(q) are hard (h) or soft (s); soft tasks have a slack with weights Q, and
joint steps are damped by R. With E = x - f(q), v = q - q_prev and xdot dt = x[k] - x[k-1], each
iteration solves:

    ik1  min |J_s dq - E_s|_Q^2 + |dq|_R^2   s.t.  J_h dq = E_h                 one iteration
    ik2  the same, n iterations; velocities from a second problem of the same form for xdot
    ik3  ik1 within the safety region
    ik4  min |E_s - J_s dq + gamma (xdot dt - J_s (v + dq))|_Q^2 + |dq|_R^2     n iterations, within
    ik5  min |E_s - J_s dq|_Q^2 + gamma |xdot dt - J_s (v + dq)|_Q^2 + |dq|_R^2 n iterations, within

With q_prev given, the safety region is an interval for each joint (`safety_region`), so that each
iteration is a small quadratic program (QP). R damps the iterations, not the solution to which they
converge. A robot with more joints than tasks is drawn to its half-sitting posture by a term of
small weight.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.errors import ConfigError
from mgs.core.progress import Progress, samples_reported
from mgs.gait import FarajiParameters, IkParameters
from mgs.ik_solver.floating.conjugate_gradients import ConjugateGradients
from mgs.ik_solver.floating.coupled_rows import CoupledRows
from mgs.ik_solver.floating.hard_soft_report import FarajiReport
from mgs.ik_solver.floating.parts import parts_of
from mgs.ik_solver.floating.reserve import Reserve
from mgs.ik_solver.floating.safety_region import SafetyRegion
from mgs.ik_solver.floating.soft_objective import SoftObjective
from mgs.ik_solver.floating.stretched_joints import stretched_joints
from mgs.ik_solver.floating.targets import body_targets
from mgs.ik_solver.floating.tasks import BodyTasks, judged_rows, measure_tasks
from mgs.ik_solver.joint_trajectory import JointTrajectory
from mgs.ik_solver.qp import BoundedQp, solve_equality
from mgs.ik_solver.residuals import refuse_limits, refuse_misses
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

DEFAULT_ITERATIONS = 15  # where a gait file gives none
POSTURE_WEIGHT = 1e-6  # [m^2], small against a squared lever arm
HELD_WEIGHT = 0.1  # [m^2] of joints that follow their posture, large against it
NEAR_STRETCHED = 0.08  # [rad] distance from a stretched limb within which no iteration starts
MAX_START_ITERATIONS = 200
ROUNDING = 1e-9  # [rad] by which an interval that ends at a limit may overstep it
CONVERGED = 1e-7  # [rad] and [m], step at which iterations end
CONTRADICTED = "no step inside the safety region of the joints meets all hard tasks"
MISSED = 5e-5  # [m] and [rad], error of a hard row from which on the solver goes back


@dataclass(frozen=True, kw_only=True)
class FarajiIk:
    """One of the five methods and its settings."""

    method: int  # 1 to 5
    tuning: FarajiParameters
    iterations: int  # n of ik2, ik4 and ik5
    keep: bool  # record a missed hard task or a joint out of range instead of refusing it

    @classmethod
    def from_parameters(cls, parameters: IkParameters) -> FarajiIk:
        """Solver with the settings of a gait file."""
        iterations = parameters.iterations
        if iterations == 0:
            raise ConfigError(
                "ik.iterations", "0 iterations are too few; ik1 to ik5 need at least 1"
            )
        return cls(
            method=int(parameters.solver.removeprefix("ik")),
            tuning=parameters.faraji,
            iterations=DEFAULT_ITERATIONS if iterations is None else iterations,
            keep=parameters.on_limit == "record",
        )

    @property
    def is_bounded(self) -> bool:
        """Whether the safety region bounds the joints."""
        return self.method >= 3

    def solve(
        self,
        robot: Robot,
        tasks: TaskTrajectory,
        com: ComTrajectory,
        progress: Progress | None = None,
    ) -> JointTrajectory:
        """Follow the tasks from the half-sitting posture; see `IkSolver.solve` for the errors."""
        run = FarajiRun(self, robot, tasks, com)
        run.start()
        for k in samples_reported(tasks.n_samples, progress):
            run.advance(k)
        return run.finish()


class FarajiRun:
    """One pass over a trajectory: the buffers, and one step per sample.

    Attributes:
        q: (7 + n,) configuration after the last step.
        H, g, A, b: the quadratic program of the last iteration, in dq (6 + n,).
        configurations: (N, 7 + n) configurations of all samples.
        elastic, recovering: samples that the report counts.
    """

    def __init__(
        self, solver: FarajiIk, robot: Robot, tasks: TaskTrajectory, com: ComTrajectory
    ) -> None:
        self.solver, self.robot, self.model, self.dt = solver, robot, robot.model, tasks.dt
        tuning = solver.tuning
        self.gamma = tuning.gamma if solver.method >= 4 else 0.0
        self.gamma_hard = self.gamma if tuning.gamma_rows == "all" else 0.0
        self.iterations = solver.iterations if solver.method in (2, 4, 5) else 1
        self._set_tasks(tasks, com)
        self._set_posture(tasks)
        damping = np.full(robot.model.nv, tuning.damping)
        damping[FLOATING_BASE_NV:] += self.posture_weight
        self.objective = SoftObjective(self.tasks, self.soft, tuning, damping)
        self.H, self.g, self.weights = self.objective.H, self.objective.g, self.objective.weights
        self.A, self.b = self.J_hard, self.E_hard
        by_gradients = solver.method == 2 and tuning.descent == "conjugate_gradients"
        self.gradients = ConjugateGradients(damping) if by_gradients else None
        bent = solver.method >= 4 if tuning.bent_start is None else tuning.bent_start
        self.is_bent = bent and (self.gamma > 0.0 or self.iterations > 1)
        self.region = SafetyRegion.of_robot(robot, tuning, tasks.dt)
        self.stretched, self.stretched_at = stretched_joints(robot)
        self.inward = np.where(self.region.middle[self.stretched] > self.stretched_at, 1.0, -1.0)
        has_reserve = tuning.reserve and solver.method >= 4
        self.reserve = Reserve(tasks.n_samples, tasks.dt) if has_reserve else None
        self.coupled = CoupledRows(robot)
        self.qp = BoundedQp(robot.model.nv, len(self.E_hard) + self.coupled.n)
        self.low, self.high = np.empty(robot.n), np.empty(robot.n)
        self.configurations = np.empty((tasks.n_samples, robot.model.nq))
        self.velocities = np.empty((tasks.n_samples, robot.n)) if solver.method == 2 else None
        self.counts, self.seconds = np.zeros((2, tasks.n_samples))  # iterations and their time
        self.elastic: list[int] = []
        self.recovering: list[int] = []

    def _set_tasks(self, tasks: TaskTrajectory, com: ComTrajectory) -> None:
        """Hard and soft tasks, their references and the buffers of their errors."""
        tuning = self.solver.tuning
        self.hard, self.soft = parts_of(tuning.hard, tasks), parts_of(tuning.soft, tasks)
        if not self.hard:
            raise ConfigError(
                "ik.faraji.hard", "both hands are free in this motion; add another task"
            )
        self.tasks = BodyTasks(self.robot, (*self.hard, *self.soft))
        self.targets = body_targets(self.tasks.parts, tasks, com)
        m_hard = sum(part.size for part in self.hard)
        self.J_hard, self.error = self.tasks.J[:m_hard], np.zeros(self.tasks.m)
        self.E_hard, self.E_soft = self.error[:m_hard], self.error[m_hard:]
        self.steps_hard, self.steps_soft = np.split(self.targets.steps, [m_hard], axis=1)

    def _set_posture(self, tasks: TaskTrajectory) -> None:
        """First configuration, and the posture to which joints are drawn, with its weights."""
        robot, given = self.robot, self.solver.tuning.posture_weight
        self.q = robot.standing_q.copy()
        if tasks.start is not None:
            self.q[FLOATING_BASE_NQ:] = tasks.start
        default = POSTURE_WEIGHT if robot.model.nv > self.tasks.m else 0.0
        weight = np.full(robot.n, default if given is None else given)
        if tasks.posture is None:
            self.posture = np.tile(self.q[FLOATING_BASE_NQ:], (tasks.n_samples, 1))
        else:
            self.posture = tasks.posture.angles
            weight[tasks.posture.held] = HELD_WEIGHT
        # in ik4 the soft rows weigh 1 + gamma at rest, where their velocity is zero
        self.posture_weight = weight * (1.0 + self.gamma if self.solver.method == 4 else 1.0)

    def start(self) -> None:
        """Bring q from the half-sitting posture onto the first sample, at any speed.

        Raises:
            ConfigError: the margin leaves a joint no range, or none that contains the posture.
        """
        self._refuse_margin()
        self.low[:], self.high[:] = self.region.lower, self.region.upper
        for _ in range(MAX_START_ITERATIONS):
            if self._iterate(0, 0.0, 0.0, None) < CONVERGED:
                break
        self.q_start = self.q

    def _refuse_margin(self) -> None:
        region, names, joints = self.region, self.robot.joint_names, self.q[FLOATING_BASE_NQ:]
        tight = np.flatnonzero(region.lower >= region.upper)
        if len(tight):
            half = 0.5 * (self.robot.upper - self.robot.lower).min()
            raise ConfigError(
                "ik.faraji.margin",
                f"{self.solver.tuning.margin:g} rad on both sides leaves no range of motion of "
                f"{names[int(tight[0])]}; use less than {half:.4f} rad on this robot",
            )
        outside = np.flatnonzero((joints < region.lower) | (joints > region.upper))
        if len(outside):
            j = int(outside[0])
            raise ConfigError(
                "ik.faraji.margin",
                f"the posture has {names[j]} at {joints[j]:.4f} rad, outside "
                f"[{region.lower[j]:.4f}, {region.upper[j]:.4f}], its range less the margin; "
                "use a smaller margin",
            )

    def advance(self, k: int) -> None:
        """Advance to sample k; where a hard task is missed, go back and keep a reserve."""
        self.step(k)
        if self.reserve is None or k not in self.elastic[-1:] or not self._misses(k):
            return
        first = self.reserve.back_from(k)
        if first is not None:
            self.q = self.configurations[first - 1] if first else self.q_start
            self.elastic = [i for i in self.elastic if i < first]
            self.recovering = [i for i in self.recovering if i < first]
            for i in range(first, k + 1):
                self.advance(i)

    def _misses(self, k: int) -> bool:
        """Whether a hard row of sample k is missed by too much at q."""
        self.tasks.update(self.q)
        self.tasks.error(self.targets.x[k], self.targets.rotations[k], self.error)
        return bool(np.abs(self.E_hard).max() > MISSED)

    def step(self, k: int) -> None:
        """Advance from sample k - 1 to sample k."""
        q_prev, solver, started = self.q, self.solver, time.thread_time()
        if solver.is_bounded:
            if self.region.interval(q_prev[FLOATING_BASE_NQ:], self.low, self.high):
                self.recovering.append(k)
            if self.reserve is not None and self.reserve.bend[k]:
                low, high = self.low[self.stretched], self.high[self.stretched]
                self.reserve.apply(k, self.stretched_at, self.inward, low, high)
                self.low[self.stretched], self.high[self.stretched] = low, high
        if self.is_bent:
            self._leave_singularity()
        if self.gradients is not None:
            self.gradients.reset()
        for i in range(self.iterations):
            self.counts[k] = i + 1
            moved = self._iterate(k, self.gamma, self.gamma_hard, q_prev)
            if moved < CONVERGED:
                break
        if solver.is_bounded:
            joints = self.q[FLOATING_BASE_NQ:]
            np.maximum(joints, self.low, out=joints)  # DAQP meets bounds up to its tolerance
            np.minimum(joints, self.high, out=joints)
        if self.qp.elastic and solver.is_bounded:
            self.elastic.append(k)
        self.coupled.complete(self.q[FLOATING_BASE_NQ:])
        self.configurations[k] = self.q
        if self.velocities is not None:
            self.velocities[k] = self._second_problem(k)
        self.seconds[k] = time.thread_time() - started

    def _leave_singularity(self) -> None:
        """Bend stretched limbs first: at a singularity linearised hard rows contradict the bounds.

        A joint near its stretched angle moves to the inner end of its interval; in ik2, which has
        no intervals, to a distance of NEAR_STRETCHED.
        """
        off = np.abs(self.q[FLOATING_BASE_NQ:][self.stretched] - self.stretched_at)
        if not (off < NEAR_STRETCHED).any():
            return
        self.q = self.q.copy()
        joints = self.q[FLOATING_BASE_NQ:]
        ends = self.stretched_at + self.inward * NEAR_STRETCHED
        if self.solver.is_bounded:
            ends = np.where(self.inward > 0, self.high[self.stretched], self.low[self.stretched])
        near = off < NEAR_STRETCHED
        joints[self.stretched[near]] = ends[near]

    def _iterate(self, k: int, gamma: float, gamma_hard: float, q_prev: Array | None) -> float:
        """One linearisation about q and one step; its length [rad] and [m]."""
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
            self.objective.set_with_velocity(
                self.solver.method, gamma, self.E_soft, self.steps_soft[k], q, v
            )
        else:
            self.objective.set(self.E_soft)
        joints = q[FLOATING_BASE_NQ:]
        self.g[FLOATING_BASE_NV:] -= self.posture_weight * (self.posture[k] - joints)
        dq = self._minimiser(joints)
        self.q = pin.integrate(self.model, q, dq)
        return math.sqrt(dq.dot(dq))

    def _minimiser(self, joints: Array) -> Array:
        """Solution dq (6 + n,) of the quadratic program, from joint angles (n,)."""
        A, b = self.coupled.below(self.A, self.b, joints)
        if self.gradients is not None:
            return self.gradients.step(self.H, self.g, A, b)
        if not self.solver.is_bounded:
            return solve_equality(self.H, self.g, A, b)
        np.subtract(self.low, joints, out=self.qp.low)
        np.subtract(self.high, joints, out=self.qp.high)
        return self.qp.solve(self.H, self.g, A, b)

    def _second_problem(self, k: int) -> Array:
        """Joint velocities (n,) of ik2, eq. (5) [rad/s]."""
        self.tasks.update(self.q)
        self.objective.set(self.steps_soft[k])
        dq = solve_equality(self.H, self.g, *self.coupled.below(self.A, self.steps_hard[k]))
        return dq[FLOATING_BASE_NV:] / self.dt

    def finish(self) -> JointTrajectory:
        """The joint trajectory, with the tasks measured anew instead of taken from iterations.

        Raises:
            IkError: a hard task is missed.
            JointLimitError: a joint leaves its range.
        """
        errors = measure_tasks(self.tasks, self.targets, self.configurations)
        joints = self.configurations[:, FLOATING_BASE_NQ:].copy()
        near = np.clip(joints, self.robot.lower, self.robot.upper)
        np.copyto(joints, near, where=np.abs(near - joints) < ROUNDING)
        self.coupled.complete(joints)
        if not self.solver.keep:
            causes = dict.fromkeys(self.elastic, CONTRADICTED)
            rows = judged_rows(self.tasks, self.hard)
            refuse_misses(rows, errors, self.dt, causes=causes)
            refuse_limits(self.robot, joints, self.dt)
        report = FarajiReport(
            hard_error=float(np.abs(errors[:, : len(self.E_hard)]).max()),
            elastic_samples=len(self.elastic),
            recovering_samples=len(self.recovering),
            returns=0 if self.reserve is None else self.reserve.returns,
            iterations=self.counts,
            seconds=self.seconds,
        )
        return JointTrajectory(joints, self.velocities, report)
