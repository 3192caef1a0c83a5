"""Inverse kinematics that optimises the null-space motion of a whole trajectory at once.

    min over q_0 .. q_N-1   sum_k [ weight_joint H_joint(q_k) + weight_grav H_grav(q_k) ] dt
                            + sum_k [ weight_limit barrier(q_k) + weight_acceleration |qdd_k|^2 ] dt
    s.t.                    every task of every sample met

qdd are second differences; the robot is at rest before and after. Both ends are free: a motion
begins and ends in the best posture for its stance, so that motions can follow each other. With
`start` "posture" the first two samples stay those of the closed-loop IK, which begins as close to
the half-sitting posture as the tasks permit.

The method is Gauss-Newton in the null spaces. With an orthonormal basis Z_k of the null space of
the task Jacobian J_k,

    q_k <- q_k + step Z_k z_k,    A z = -Z^T grad    (A symmetric, positive definite, banded)

where A contains the curvature of H_joint, dtau^T W dtau of H_grav and the second differences.
Newton steps J^+ error then bring every sample back onto its tasks. `step` is halved until the
objective falls, so that it falls in every iteration. An iteration takes O(N) operations. H_grav and
W are those of `clik`; the option `double_support` defines the torques in double support.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.progress import Progress
from mgs.gait import IkParameters
from mgs.gait.ik import TrajectoryParameters
from mgs.ik_solver.banded import band_matrix, second_differences, solve_band
from mgs.ik_solver.clik import ClosedLoopIk
from mgs.ik_solver.gains import gravity_gain_profile, gravity_scale
from mgs.ik_solver.joint_trajectory import JointTrajectory
from mgs.ik_solver.limit_barrier import limit_barrier
from mgs.ik_solver.residuals import refuse_limits, refuse_misses
from mgs.ik_solver.tree.batch import TreeBatch
from mgs.ik_solver.tree.static_loads import StaticLoads
from mgs.ik_solver.tree.targets import TREE_TASKS, refuse_torso
from mgs.ik_solver.tree.tasks import N_TASKS
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

PINNED = 2  # samples at the beginning that do not move with start: posture
ON_TASK = 1e-7  # [m] and [rad], task error at which Newton steps end
FAR = 0.3  # [m] and [rad], task error above which no Newton steps are tried
NEAR = 3e-3  # [m] and [rad], task error below which the Jacobians are kept
MAX_CORRECTIONS = 12
MAX_HALVINGS = 12
SUFFICIENT = 1e-4  # part of the decrease predicted by the gradient that a step has to bring


@dataclass(frozen=True, kw_only=True)
class TrajectoryIk:
    """Settings of the IK that optimises the whole trajectory."""

    closed_loop: ClosedLoopIk  # gives the first trajectory
    tuning: TrajectoryParameters
    keep_limits: bool  # False: record a joint outside its range instead of refusing the motion

    @classmethod
    def from_parameters(cls, parameters: IkParameters) -> TrajectoryIk:
        """Solver with the settings of a gait file."""
        unlimited = parameters.model_copy(update={"on_limit": "record"})
        return cls(
            closed_loop=ClosedLoopIk.from_parameters(unlimited),
            tuning=parameters.trajectory,
            keep_limits=parameters.on_limit != "record",
        )

    def solve(
        self,
        robot: Robot,
        tasks: TaskTrajectory,
        com: ComTrajectory,
        progress: Progress | None = None,
    ) -> JointTrajectory:
        """Improve on the closed-loop IK; see `IkSolver.solve` for the errors."""
        refuse_torso(tasks, "trajectory")
        first = self.closed_loop.solve(robot, tasks, com).angles
        problem = Problem(self, robot, tasks, com)
        motion, history = minimise(problem, first, progress)
        errors = np.zeros((tasks.n_samples, N_TASKS))
        errors[:, problem.batch.rows] = motion.error
        refuse_misses(TREE_TASKS, errors, tasks.dt)
        if self.keep_limits:
            refuse_limits(robot, motion.q, tasks.dt)
        report = TrajectoryReport(history, len(history) - 1, problem.projected_gradient(motion))
        return JointTrajectory(motion.q, report=report)


@dataclass(frozen=True)
class TrajectoryReport:
    """How the IK of the whole trajectory fared."""

    objective: list[float]  # before the first iteration and after each one
    iterations: int
    projected_gradient: float  # largest entry of the gradient in the null spaces at the end

    def to_dict(self) -> dict[str, object]:
        """The report as plain data."""
        return asdict(self)


@dataclass(frozen=True, eq=False)
class Point:
    """A motion that meets its tasks, with its errors, Jacobians, torques and objective."""

    q: Array  # (N, n)
    error: Array  # (N, m)
    J: Array  # (N, m, n)
    tau: Array  # (N, n)
    dtau: Array  # (N, n, n)
    objective: float


class Problem:
    """Objective, gradient and curvature of a motion."""

    def __init__(
        self, solver: TrajectoryIk, robot: Robot, tasks: TaskTrajectory, com: ComTrajectory
    ) -> None:
        self.tuning = tuning = solver.tuning
        self.dt = tasks.dt
        given = tuning.start == "posture" or tasks.start is not None
        self.pinned = PINNED if given else 0
        sharing, loads = solver.closed_loop.double_support, None
        in_time = np.ones(tasks.n_samples)
        if sharing == "off":
            in_time = gravity_gain_profile(
                tasks.support, tasks.dt, solver.closed_loop.gamma_grav_ramp
            )
        else:
            loads = StaticLoads(robot, tasks, com, sharing)
        self.batch = TreeBatch(robot, tasks, com, loads)
        scale = gravity_scale(robot, tasks.com_height[0])
        self.weight_grav = self.dt * tuning.weight_grav * scale * in_time  # (N,)
        self.lower, self.upper = robot.lower, robot.upper
        self.weight_limit = self.dt * tuning.weight_limit
        self.middle = 0.5 * (robot.upper + robot.lower)
        self.weight_joint = self.dt * tuning.weight_joint / (robot.upper - robot.lower) ** 2  # (n,)
        self.weight_acceleration = tuning.weight_acceleration / self.dt**3

    def at(self, q: Array) -> Point | None:
        """The motion near q (N, n) that meets the tasks; None if Newton steps do not find it.

        Jacobians are renewed as long as the errors are large; those of the result are exact up to
        terms of the size `NEAR`.
        """
        error, J = self.batch.tasks_at(q)
        for _ in range(MAX_CORRECTIONS):
            worst = np.abs(error[self.pinned :]).max()
            if worst < ON_TASK:
                tau, dtau = self.batch.torques_at(q)
                return Point(q, error, J, tau, dtau, self._objective(q, tau))
            if not worst < FAR:
                break
            step = np.linalg.solve(J @ J.transpose(0, 2, 1), error[..., None])
            step = (J.transpose(0, 2, 1) @ step)[..., 0]
            step[: self.pinned] = 0.0
            q = q + step
            if worst > NEAR:
                error, J = self.batch.tasks_at(q)
            else:
                error = self.batch.errors_at(q)
        return None

    def cost(self, q: Array) -> float:
        """Integral of the weighted H_joint and H_grav along q (N, n)."""
        return self._secondary(q, self.batch.torques_at(q)[0])

    def _secondary(self, q: Array, tau: Array) -> float:
        joint = 0.5 * np.sum(self.weight_joint * (q - self.middle) ** 2)
        return float(joint + 0.5 * np.sum(self.weight_grav[:, None] * tau**2))

    def _objective(self, q: Array, tau: Array) -> float:
        wall = self.weight_limit * limit_barrier(q, self.lower, self.upper)[0]
        bends = self.weight_acceleration * float(np.sum(second_differences(q) ** 2))
        return self._secondary(q, tau) + wall + bends

    def gradient(self, point: Point) -> Array:
        """Gradient of the objective, (N, n)."""
        q = point.q
        tau = self.weight_grav[:, None] * point.tau
        twice = second_differences(second_differences(q))
        return np.asarray(
            self.weight_joint * (q - self.middle)
            + self.weight_limit * limit_barrier(q, self.lower, self.upper)[1]
            + (tau[:, None] @ point.dtau)[:, 0]
            + 2.0 * self.weight_acceleration * twice
        )

    def null_spaces(self, point: Point) -> Array:
        """Orthonormal bases (N, n, p) of the null spaces of the tasks."""
        m = point.J.shape[1]
        Q = np.linalg.qr(point.J.transpose(0, 2, 1), mode="complete").Q
        return np.ascontiguousarray(Q[:, :, m:])

    def newton(self, point: Point) -> tuple[Array, float]:
        """Step (N, n) and the decrease of the objective that it predicts to first order."""
        Z = self.null_spaces(point)
        g = (self.gradient(point)[:, None] @ Z)[:, 0]
        T = point.dtau @ Z
        B = self.weight_grav[:, None, None] * (T.transpose(0, 2, 1) @ T)
        wall = limit_barrier(point.q, self.lower, self.upper)[2]
        diagonal = self.weight_joint + self.weight_limit * wall
        B += Z.transpose(0, 2, 1) @ (diagonal[..., None] * Z)
        band = band_matrix(B, Z, 2.0 * self.weight_acceleration, self.pinned)
        z = solve_band(band, g[self.pinned :])
        step = np.zeros_like(point.q)
        step[self.pinned :] = (Z[self.pinned :] @ z[..., None])[..., 0]
        return step, -float(np.sum(g[self.pinned :] * z))

    def projected_gradient(self, point: Point) -> float:
        """Largest entry of the gradient in the null spaces."""
        g = self.gradient(point)[:, None] @ self.null_spaces(point)
        return float(np.abs(g[self.pinned :]).max())


def minimise(
    problem: Problem, q: Array, progress: Progress | None = None
) -> tuple[Point, list[float]]:
    """The motion found from q (N, n), and the objective at the start and after each iteration.

    Raises:
        ArithmeticError: Newton steps do not bring q onto its tasks.
    """
    here = problem.at(q)
    if here is None:
        raise ArithmeticError("Newton's method does not bring the closed-loop IK onto its tasks")
    history = [here.objective]
    tuning = problem.tuning
    for iteration in range(tuning.iterations):
        if progress is not None:  # in samples, as with all solvers
            progress(len(q) * iteration // tuning.iterations, len(q))
        step, fall = problem.newton(here)
        if fall < tuning.tolerance * here.objective:
            break
        found = _search(problem, here, step, fall)
        if found is None:
            break
        here = found
        history.append(here.objective)
        if history[-2] - history[-1] < tuning.tolerance * here.objective:
            break
    if progress is not None:
        progress(len(q), len(q))
    return here, history


def _search(problem: Problem, here: Point, step: Array, fall: float) -> Point | None:
    """The motion after the longest part of a step (N, n) that lowers the objective enough.

    The step is halved until it does; None if no part of it does.
    """
    size = 1.0
    for _ in range(MAX_HALVINGS):
        found = problem.at(here.q + size * step)
        if found is not None and found.objective <= here.objective - SUFFICIENT * size * fall:
            return found
        size *= 0.5
    return None
