"""Whole-body inverse kinematics with strict priorities, on a floating base held by constraints.

M. Mistry, J. Nakanishi, G. Cheng and S. Schaal, "Inverse kinematics with floating base and
constraints for full body humanoid robot control", Humanoids 2008. Levels A (critical: soles and
CoM), B (functional: hands) and E (extraneous: torso and CoM height); `priority_levels` solves them.
With the error e = x_ref - x at the sample before and the share kappa of it that is corrected:

    prioritized:   q[k] = q[k-1] + dt v,   level rates  (x_ref[k] - x_ref[k-1] + kappa e) / dt
    prioritized-acceleration:  v[k] = v[k-1] + dt a,   q[k] = q[k-1] + dt v[k]           (20)-(22)
        level rates  xdd_ref + Kd edot + Kp e - Jdot v,   Kp dt^2 = (1 - p)^2,   Kd dt = 1 - p^2
        xdd_ref = (x_ref[k] - 2 x_ref[k-1] + x_ref[k-2]) / dt^2,   p = 1 - kappa, a double pole
        edot = (x_ref[k-1] - x_ref[k-2]) / dt - (J v - dt/2 Jdot v)

The bracket in edot is the speed of the last step, (x[k-1] - x[k-2]) / dt: with J v in its place a
turning limb would keep an error that grows as dt^2. Soles take Kd dt = 1 and Kp dt^2 = kappa, so
that velocities which violate the constraints are removed at once, as by the projection N_A.

Directions that no level determines are drawn to the half-sitting posture. In single support the
swing sole is not a constraint: it moves from level A to B after lift-off, and back before landing.
Both sets of constraints meet the common ones exactly, and so does any blend of their solutions.
A lower level that cannot be met may move the joints so fast that the curvature of a step shows in
level A, and the projected form misses a swing sole in level B. A Newton step then corrects both.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
import pinocchio as pin

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Side, Support
from mgs.core.errors import InfeasibleGaitError
from mgs.core.progress import Progress, samples_reported
from mgs.core.spans import span_starts
from mgs.gait import IkParameters, PrioritizedParameters
from mgs.ik_solver.floating.constraints import ConstraintSet, handover_profile, refuse_infeasible
from mgs.ik_solver.floating.jacobian_rate import JacobianRate
from mgs.ik_solver.floating.parts import SOLES, Part, parts_of
from mgs.ik_solver.floating.printed_levels import PRINTED_FORMS, printed_solution
from mgs.ik_solver.floating.targets import body_targets
from mgs.ik_solver.floating.tasks import BodyTasks, judged_rows, measure_tasks
from mgs.ik_solver.joint_trajectory import JointTrajectory
from mgs.ik_solver.residuals import refuse_limits, refuse_misses
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

POSTURE_RATE = 1.0  # [1/s] at which redundant joints approach the half-sitting posture
POSTURE_DAMPING = 10.0  # [1/s] at which they reach that speed in the acceleration form
CONFLICT_SPEED = 1.0  # [rad/s] and [m/s], largest rate of a level that conflicts with a higher one
CORRECT_ABOVE = 5e-5  # [m] and [rad], error of level A that calls for a Newton step
MAX_CORRECTIONS = 5  # per sample
MAX_START_ITERATIONS = 300
MAX_START_STEP = 0.2  # [rad] and [m], largest part of a step there
CONVERGED = 1e-9  # [rad] and [m], step at which the start is found
SWING = {Support.DOUBLE: None, Support.LEFT: Side.RIGHT, Support.RIGHT: Side.LEFT}


@dataclass(frozen=True, kw_only=True)
class PrioritizedIk:
    """Levels of tasks and their settings."""

    tuning: PrioritizedParameters
    acceleration: bool  # eq. (18) instead of (16)
    keep: bool  # record a missed critical task or a joint out of range instead of refusing it

    @classmethod
    def from_parameters(cls, parameters: IkParameters) -> PrioritizedIk:
        """Solver with the settings of a gait file."""
        return cls(
            tuning=parameters.prioritized,
            acceleration=parameters.solver == "prioritized-acceleration",
            keep=parameters.on_limit == "record",
        )

    def solve(
        self,
        robot: Robot,
        tasks: TaskTrajectory,
        com: ComTrajectory,
        progress: Progress | None = None,
    ) -> JointTrajectory:
        """Follow the tasks from the half-sitting posture; see `IkSolver.solve` for the errors."""
        run = PrioritizedRun(self, robot, tasks, com)
        run.start()
        for k in samples_reported(tasks.n_samples, progress, first=1):
            run.step(k)
        return run.finish()


@dataclass(frozen=True)
class Phase:
    """One kind of support phase: the ranks of its constraints and of the critical tasks."""

    start: float  # of the first phase of this kind [s]
    support: str
    rows: int  # of the constraints
    rank: int  # of the constraints
    base_rank: int  # of their base part
    critical_rows: int
    critical_rank: int
    count: int  # number of phases of this kind


@dataclass(frozen=True)
class PrioritizedReport:
    """How the prioritised IK fared."""

    phases: tuple[Phase, ...]
    corrections: int  # Newton steps in all samples together
    worst_errors: dict[str, float]  # largest error of every task, by name [m] or [rad]

    def to_dict(self) -> dict[str, object]:
        """The report as plain data."""
        return {**asdict(self), "phases": [asdict(phase) for phase in self.phases]}


class PrioritizedRun:
    """One pass over a trajectory: the buffers, and one step per sample.

    Attributes:
        q: (7 + n,) configuration after the last step.
        v: (6 + n,) velocity of the last step.
        error: (m,) task errors at q against the references of the last step.
        configurations: (N, 7 + n) configurations of all samples.
    """

    def __init__(
        self, solver: PrioritizedIk, robot: Robot, tasks: TaskTrajectory, com: ComTrajectory
    ) -> None:
        self.solver, self.robot, self.dt = solver, robot, tasks.dt
        tuning = solver.tuning
        levels = [
            parts_of(names, tasks)
            for names in (tuning.critical, tuning.functional, tuning.extraneous)
        ]
        self.critical = levels[0]
        self.tasks = BodyTasks(robot, [part for level in levels for part in level])
        self.targets = body_targets(self.tasks.parts, tasks, com)
        self.jacobian_rate = JacobianRate(robot, self.tasks)
        self._set_constraints(levels, tasks)
        self._set_gains()
        self.q, self.v = robot.standing_q.copy(), np.zeros(robot.model.nv)
        if tasks.start is not None:
            self.q[FLOATING_BASE_NQ:] = tasks.start
        self.posture = self.q[FLOATING_BASE_NQ:].copy()  # redundant joints approach it
        self.error, self.rates, self.bias = np.zeros((3, self.tasks.m))
        self.free = np.zeros(robot.model.nv)  # motion that no level determines
        self.configurations = np.empty((tasks.n_samples, robot.model.nq))
        self.corrections = 0

    def _set_constraints(self, levels: list[tuple[Part, ...]], tasks: TaskTrajectory) -> None:
        """The levels for every kind of support, and the samples at which the support changes."""
        tuning, size = self.solver.tuning, float(tasks.com_height[0])
        projected = tuning.null_space == "projected"
        self.printed = next((f for f in PRINTED_FORMS if f == tuning.null_space), None)
        self.support = tasks.support
        self.sets = {
            support: ConstraintSet(self.tasks, levels, projected, size, swing)
            for support, swing in SWING.items()
        }
        self._start_set = ConstraintSet(self.tasks, levels, False, size)
        self.m_critical = len(self.sets[Support.DOUBLE].critical)  # the first of all rows
        self.handover = handover_profile(tasks.support, tasks.dt, tuning.handover)
        self.phase_starts = set(span_starts(tasks.support))
        self.phases: dict[tuple[str, int, int, int, int, int], tuple[float, int]] = {}

    def _set_gains(self) -> None:
        """Feedback gains Kp and Kd of every row, and the bounds of what a level may ask for."""
        acceleration, kappa = self.solver.acceleration, self.solver.tuning.feedback
        is_sole = np.zeros(self.tasks.m, bool)
        for sole in SOLES:
            is_sole[self.tasks.rows[sole]] = True
        self.kp = np.where(is_sole, kappa, kappa**2) / self.dt**2
        self.kd = np.where(is_sole, 1.0, 1.0 - (1.0 - kappa) ** 2) / self.dt
        # A task that has long been out of reach need not rush when it can be met again.
        catch_up = self.solver.tuning.catch_up if self.printed is None else None
        self.largest = np.inf if catch_up is None else catch_up * self.dt / kappa
        self.posture_damping = min(POSTURE_DAMPING, 0.5 / self.dt)
        self.bound = CONFLICT_SPEED * (self.posture_damping if acceleration else 1.0)
        # Below this lag a level in conflict could ask for more than the fastest joint can do.
        fastest = float(self.robot.speed_limit.max()) / (self.dt if acceleration else 1.0)
        self.least_behind = self.bound / fastest

    def start(self) -> None:
        """Bring q from the half-sitting posture onto the first sample, by Newton steps.

        Redundant joints stay as near to the posture as the tasks permit.
        """
        for _ in range(MAX_START_ITERATIONS):
            self._measure(0)
            self.free[FLOATING_BASE_NV:] = self.posture - self.q[FLOATING_BASE_NQ:]
            dq = self._solve(self._start_set, 0, self.error)
            largest = float(np.abs(dq).max())
            dq *= min(1.0, MAX_START_STEP / largest) if largest > 0.0 else 1.0
            self.q = pin.integrate(self.robot.model, self.q, dq)
            if largest < CONVERGED:
                break
        self._measure(0)
        self.configurations[0] = self.q
        self._check_phase(0)

    def step(self, k: int) -> None:
        """Advance from sample k - 1, at which the tasks have been measured, to sample k."""
        if self.largest < np.inf:
            np.clip(self.error, -self.largest, self.largest, out=self.error)
        if self.solver.acceleration:
            self._set_accelerations(k)
            self.v += self.dt * self._blend(k)
        else:
            np.multiply(self.error, self.solver.tuning.feedback, out=self.rates)
            self.rates += self.targets.steps[k]
            self.rates /= self.dt
            self._set_posture_velocity()
            self.v = self._blend(k)
        self.q = pin.integrate(self.robot.model, self.q, self.dt * self.v)
        self._measure(k)
        if self.printed is None:
            self._correct(k)
        self.configurations[k] = self.q
        if k in self.phase_starts:
            self._check_phase(k)

    def _correct(self, k: int) -> None:
        """Correct critical tasks and the swing sole where they are missed by too much.

        Lower levels do not move in this correction, as far as they can be met.
        """
        for _ in range(MAX_CORRECTIONS):
            critical = self.error[: self.m_critical]
            if np.dot(critical, critical) <= CORRECT_ABOVE**2:
                return
            self.corrections += 1
            np.copyto(self.rates, self.error)
            self.rates[self.m_critical :] = 0.0
            self.free[:] = 0.0
            self.error[:] = 0.0  # only level A lags
            dq = self._solve(self.sets[Support.DOUBLE], k, self.rates)
            self.q = pin.integrate(self.robot.model, self.q, dq)
            self._measure(k)

    def _measure(self, k: int) -> None:
        """Update the Jacobian at q and the error against the references of sample k."""
        self.tasks.update(self.q)
        self.tasks.error(self.targets.x[k], self.targets.rotations[k], self.error)

    def _set_accelerations(self, k: int) -> None:
        """Fill the rates of eq. (18) and the acceleration of free directions for the step to k."""
        steps, dt, rates = self.targets.steps, self.dt, self.rates
        self.jacobian_rate.product(self.q, self.v, self.bias)
        np.dot(self.tasks.J, self.v, out=rates)
        rates -= (0.5 * dt) * self.bias
        np.subtract(steps[k - 1] / dt, rates, out=rates)
        rates *= self.kd
        rates += self.kp * self.error
        rates += (steps[k] - steps[k - 1]) / dt**2
        rates -= self.bias
        self._set_posture_velocity()
        self.free -= self.v
        self.free *= self.posture_damping

    def _set_posture_velocity(self) -> None:
        """Fill the velocity of the directions that no level determines."""
        free, joints = self.free, self.q[FLOATING_BASE_NQ:]
        free[:FLOATING_BASE_NV] = 0.0
        np.subtract(self.posture, joints, out=free[FLOATING_BASE_NV:])
        free *= POSTURE_RATE

    def _blend(self, k: int) -> Array:
        """Solution (6 + n,) of the constraints at sample k, a blend of two sets in a handover."""
        form = self.printed
        if form is not None:
            levels, J, rates = self.sets[Support(self.support[k])], self.tasks.J, self.rates
            chosen = levels.index
            return self._or_refuse(
                k, lambda: printed_solution(form, J[chosen], rates[chosen], levels.rows)
            )
        factor = float(self.handover[k])
        both, single = self.sets[Support.DOUBLE], self.sets[Support(self.support[k])]
        if factor == 0.0 or single is both:
            return self._solve(both, k, self.rates)
        v = self._solve(single, k, self.rates)
        if factor < 1.0:
            v *= factor
            v += (1.0 - factor) * self._solve(both, k, self.rates)
        return v

    def _solve(self, chosen: ConstraintSet, k: int, rates: Array) -> Array:
        return self._or_refuse(
            k,
            lambda: chosen.solve(
                self.tasks.J, rates, self.error, self.free, self.bound, self.least_behind
            ),
        )

    def _or_refuse(self, k: int, solve: Callable[[], Array]) -> Array:
        """Result of a solver of the levels; raises InfeasibleGaitError where it has none."""
        try:
            return solve()
        except np.linalg.LinAlgError as error:
            # the motion has most likely left its tasks before: name the first one
            self._refuse_misses(self.configurations[:k])
            raise InfeasibleGaitError(
                f"t = {k * self.dt:.3f} s: the priority levels have no solution: {error}"
            ) from error

    def _refuse_misses(self, configurations: Array) -> Array:
        """Errors (M, m) along the first M configurations; raises IkError at a critical miss."""
        errors = measure_tasks(self.tasks, self.targets, configurations)
        if not self.solver.keep and len(errors):
            refuse_misses(judged_rows(self.tasks, self.critical), errors, self.dt)
        return errors

    def _check_phase(self, k: int) -> None:
        """Note the ranks of the constraints; raises ConfigError where they do not suffice."""
        support = Support(self.support[k])
        soles = [self.tasks.rows[SOLES[side]] for side in support.sides]
        J_C = np.concatenate([self.tasks.J[rows] for rows in soles])
        J_A = self.tasks.J[self.sets[support].critical]
        rank, base_rank, critical_rank = refuse_infeasible(k * self.dt, J_C, J_A)
        kind = (support.label, len(J_C), rank, base_rank, len(J_A), critical_rank)
        start, count = self.phases.get(kind, (k * self.dt, 0))
        self.phases[kind] = (start, count + 1)

    def finish(self) -> JointTrajectory:
        """The joint trajectory, with every task measured anew at every sample.

        Raises:
            IkError: a critical task is missed.
            JointLimitError: a joint leaves its range.
        """
        errors = self._refuse_misses(self.configurations)
        joints = self.configurations[:, FLOATING_BASE_NQ:].copy()
        if not self.solver.keep:
            refuse_limits(self.robot, joints, self.dt)
        judged = judged_rows(self.tasks, self.tasks.parts)
        report = PrioritizedReport(
            phases=tuple(
                Phase(round(start, 9), *kind, count) for kind, (start, count) in self.phases.items()
            ),
            corrections=self.corrections,
            worst_errors={task.name: float(task.sizes(errors).max()) for task in judged},
        )
        return JointTrajectory(joints, report=report)
