"""Closed-loop IK with a gradient-projected secondary task.

Eqs. (9)-(14) of "Inverse kinematics of a humanoid robot modelled as a tree-shaped manipulator" (the
Melson paper). J has full row rank m < n, so that J^+ needs no SVD:

    q[k+1] = q[k] + dt v
    v  = v0 + J^T y,   (J J^T + damping^2 I) y = (t[k+1] - f(q[k])) / dt - J v0
    v0 = - gamma_joint grad H_joint - gamma_grav grad H_grav
    H_joint = 1/2 sum ((q - q_mid) / (q_max - q_min))^2,   H_grav = 1/2 tau^T W tau

The tree is rooted at the support sole. In the paper H_grav makes sense in single support only:
gamma_grav falls linearly to zero before double support and rises after it. Where `double_support`
says how two soles share the weight, tau holds throughout and gamma_grav stays on.
W = s^2 I with s = 0.70 kg m / (M z_c), so that a gain means the same on every robot.

The paper leaves the orientation of the torso free, and it drifts. With `torso` it is a task of
lower priority than J and of higher priority than v0. Its step is taken in the null space of J, so
that it is met where the robot can meet it, and never at the cost of soles, hands or CoM (Siciliano
and Slotine, "A general framework for managing multiple tasks in highly redundant robotic systems",
ICAR 1991).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError
from mgs.gait import IkParameters
from mgs.ik_solver.joint_trajectory import JointTrajectory
from mgs.ik_solver.residuals import refuse_limits
from mgs.ik_solver.tree.least_norm import LeastNorm
from mgs.ik_solver.tree.static_loads import Sharing, StaticLoads, loaded_gravity
from mgs.ik_solver.tree.targets import (
    refuse_task_misses,
    refuse_torso,
    root_spans,
    torso_targets,
    tree_targets,
)
from mgs.ik_solver.tree.tasks import N_TASKS, TURN, TreeTasks
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

TorsoMode = Literal["free", "upright", "hold"]
TORSO_DAMPING = 0.02  # of the torso's Jacobian in the null space, whose singular values are about 1
UPDATE_ABOVE = 1e-5  # [m] and [rad], task error that calls for a Newton update, inside TOLERANCES
MAX_UPDATES = 10  # per sample; converging ones need one or two
MAX_START_UPDATES = 50
REFERENCE_MOMENT = 0.70  # [kg m] M z_c of the robot that the gains were first chosen on


@dataclass(frozen=True, kw_only=True)
class ClosedLoopIk:
    """Tuning of the closed-loop IK."""

    gamma_joint: float = 0.35  # weight of the joint-limit gradient [rad^2/s]
    gamma_grav: float = 0.0  # weight of the gravity-torque gradient [1/((N m)^2 s)]
    gamma_grav_ramp: float = 0.2  # [s]
    double_support: Sharing = "shared"  # how soles share the weight; off: gamma_grav is 0 there
    iterations: int | None = None  # Newton updates per sample; None: until UPDATE_ABOVE is met
    torso: TorsoMode = "free"  # whether the null space holds the torso's orientation
    keep_limits: bool = True  # False: record a joint outside its range instead of refusing it
    damping: float = 1e-6  # Levenberg term, in the unit of J

    @classmethod
    def from_parameters(cls, parameters: IkParameters) -> ClosedLoopIk:
        """Solver with the tuning of a gait file."""
        return cls(
            gamma_joint=parameters.gamma_joint,
            gamma_grav=parameters.gamma_grav,
            gamma_grav_ramp=parameters.gamma_grav_ramp,
            double_support=parameters.double_support,
            iterations=parameters.iterations,
            torso=parameters.torso,
            keep_limits=parameters.on_limit == "refuse",
        )

    def solve(
        self,
        robot: Robot,
        tasks: TaskTrajectory,
        com: ComTrajectory,
        progress: Callable[[int, int], None] | None = None,
    ) -> JointTrajectory:
        """Follow the tasks from the half-sitting posture; see `IkSolver.solve` for the errors."""
        return _Run(self, robot, tasks, com).follow(progress)


def gravity_gain_profile(support: NDArray[np.int8], dt: float, ramp: float) -> Array:
    """Factor (N,) on gamma_grav: 1 in single support, falling to 0 over `ramp` [s] at its ends."""
    factor = np.zeros(len(support))
    edges = np.flatnonzero(np.diff(support)) + 1
    for start, end in zip([0, *edges], [*edges, len(support)], strict=True):
        if support[start] != Support.DOUBLE:
            k = np.arange(start, end)
            width = min(ramp, 0.5 * (end - start) * dt)
            factor[start:end] = np.clip(np.minimum(k - start, end - k) * dt / width, 0.0, 1.0)
    return factor


def rest_profile(n_samples: int, dt: float, ramp: float) -> Array:
    """Factor (N,) on all null-space motion: 0 at both ends of the motion, 1 beyond `ramp` [s]."""
    k = np.arange(n_samples)
    return np.clip(np.minimum(k, n_samples - 1 - k) * dt / ramp, 0.0, 1.0)


def _task_steps(positions: Array, rotations: Array) -> Array:
    """t[k] - t[k-1] (m, 15) of positions (m, 12) and rotations (m, 3, 3); zero for the first."""
    steps = np.zeros((len(positions), N_TASKS))
    steps[1:, :12] = np.diff(positions, axis=0)
    for i in np.flatnonzero(np.any(rotations[1:] != rotations[:-1], axis=(1, 2))) + 1:
        steps[i, TURN] = pin.log3(rotations[i] @ rotations[i - 1].T)
    return steps


class _Run:
    """One pass over a trajectory: the buffers and the loop over samples."""

    def __init__(
        self, tuning: ClosedLoopIk, robot: Robot, tasks: TaskTrajectory, com: ComTrajectory
    ) -> None:
        self.tuning, self.robot, self.tasks, self.com = tuning, robot, tasks, com.position
        refuse_torso(tasks, "clik")
        asked = tasks.hands_asked
        self.trees = (TreeTasks(robot, Side.LEFT, asked), TreeTasks(robot, Side.RIGHT, asked))
        self.max_updates = MAX_UPDATES if tuning.iterations is None else tuning.iterations
        self.threshold2 = UPDATE_ABOVE**2 if tuning.iterations is None else 0.0
        scale = REFERENCE_MOMENT / (robot.mass * tasks.com_height[0])
        self.gamma_grav = tuning.gamma_grav * scale**2  # W = scale^2 I
        rest = rest_profile(tasks.n_samples, tasks.dt, tuning.gamma_grav_ramp)
        self.gain_joint = tasks.dt * tuning.gamma_joint * rest
        self.loads: StaticLoads | None = None
        if tuning.double_support == "off":
            rest = rest * gravity_gain_profile(tasks.support, tasks.dt, tuning.gamma_grav_ramp)
        else:
            rest = rest**2 * (3.0 - 2.0 * rest)  # it is strong at once: no jump of speed
            if self.gamma_grav:
                self.loads = StaticLoads(robot, tasks, com, tuning.double_support)
        self.gain_grav = tasks.dt * self.gamma_grav * rest
        self.inverse_range2 = 1.0 / (robot.upper - robot.lower) ** 2
        self.middle = 0.5 * (robot.upper + robot.lower)
        self.angles = np.empty((tasks.n_samples, robot.n))
        self.torso = torso_targets(robot, tasks, tuning.torso)
        self.updates = 0
        self.m = self.trees[0].n_rows

    def follow(self, progress: Callable[[int, int], None] | None) -> JointTrajectory:
        """Walk through the spans that stand on one sole, since each has its own tree."""
        roots, n = self.tasks.root, self.tasks.n_samples
        q = self.robot.posture if self.tasks.start is None else self.tasks.start
        for start, end in root_spans(self.tasks):
            tree = self.trees[roots[start]]
            tree.place(pin.XYZQUATToSE3(self.tasks.soles[start, roots[start]]))
            positions, rotations = tree_targets(self.tasks, self.com, start, end)
            q_tree = q[tree.order]
            if start == 0:
                self._start(tree, q_tree, positions[0], rotations[0])
            errors = self._follow_span(tree, q_tree, start, positions, rotations)
            refuse_task_misses(errors, self.tasks.dt, start)
            if self.tuning.keep_limits:
                refuse_limits(self.robot, self.angles[start:end], self.tasks.dt, start)
            q = self.angles[end - 1]
            if progress is not None:
                progress(end, n)
        return JointTrajectory(self.angles, report={"newton_updates": self.updates})

    def _follow_span(
        self, tree: TreeTasks, q: Array, start: int, positions: Array, rotations: Array
    ) -> Array:
        """Fill `angles` from sample `start`, beginning at q (n,); remaining task errors (m, 15)."""
        span = slice(start, start + len(positions))
        pull = self.gain_joint[span, None] * self.inverse_range2[tree.order]
        aim = pull * self.middle[tree.order]  # v0 dt = aim - pull q
        advance = np.zeros((len(positions), self.m))
        advance[:, :N_TASKS] = np.nan_to_num(_task_steps(positions, rotations))  # NaN: free
        advance[:, tree.held_rows] = 0.0
        path, errors = np.empty_like(pull), np.empty_like(advance)
        tree.update(q)
        tree.error(positions[0], rotations[0], errors[0])
        gain_grav, error = self.gain_grav.tolist(), errors[0]
        solver = LeastNorm(tree.rows, self.tuning.damping)
        v0 = solver.v
        rows = zip(positions, rotations, advance, aim, pull, path, errors, strict=True)
        for k, (x, R, step, aim_k, pull_k, q_next, error_next) in enumerate(rows, start):
            np.subtract(aim_k, pull_k * q, v0)
            if gain_grav[k]:
                tau, dtau = loaded_gravity(tree, self.loads, k, q)
                v0 -= tau.dot(dtau) * gain_grav[k]
            dq = self._step(tree, solver, error + step, k)
            q = np.add(q, dq, q_next)
            tree.update(q)
            error = error_next  # t[k] - f(q[k]); with the next step t[k + 1] - f(q[k])
            tree.error(x, R, error)
            updates = self.max_updates
            while updates and error.dot(error) > self.threshold2:
                v0[:] = 0.0
                q += solver.step(error)
                tree.update(q)
                tree.error(x, R, error)
                updates -= 1
                self.updates += 1
        self.angles[span, tree.order] = path
        return errors

    def _step(
        self, tree: TreeTasks, solver: LeastNorm, error: Array, k: int, extra_damping2: float = 0.0
    ) -> Array:
        """Joint step (n,) for a task error (m,) at sample k, the torso's turn in its null space."""
        step = solver.step(error, extra_damping2)
        if self.torso is None:
            return step
        J_torso, turn = tree.torso_error(self.torso[k])
        return solver.add_below(step, J_torso, turn, TORSO_DAMPING)

    def _start(self, tree: TreeTasks, q: Array, positions: Array, rotation: Array) -> None:
        """Bring q (n,) from the half-sitting posture onto the tasks of the first sample."""
        error, solver = np.empty(self.m), LeastNorm(tree.rows, self.tuning.damping)
        for _ in range(MAX_START_UPDATES):
            tree.update(q)
            tree.error(positions, rotation, error)
            step = self._step(tree, solver, error, 0, error.dot(error))
            off = error.dot(error) if self.torso is None else max(error.dot(error), step.dot(step))
            if off < UPDATE_ABOVE**4:  # quadratic convergence: the last step was exact
                break
            # damping by the error (Sugihara, IEEE Trans. Robotics 27(5), 2011) settles at the
            # nearest posture where the goal is out of reach: the message then says how far it is
            q += step
        self._refuse_stiff_joint_gain()
        self._refuse_stiff_gravity_gain(tree, q)

    def _refuse_stiff_joint_gain(self) -> None:
        """Raise ConfigError where the explicit step down grad H_joint would overshoot."""
        product = self.tasks.dt * self.tuning.gamma_joint * self.inverse_range2.max()
        if product >= 1.0:
            raise self._too_stiff("gamma_joint", self.tuning.gamma_joint, product)

    def _refuse_stiff_gravity_gain(self, tree: TreeTasks, q: Array) -> None:
        """Raise ConfigError where the explicit step down grad H_grav would overshoot."""
        if not self.gamma_grav:
            return
        step = 1e-5
        gradients = []
        for i in range(len(q)):
            for sign in (1.0, -1.0):
                moved = q.copy()
                moved[i] += sign * step
                tau, dtau = tree.gravity(moved)
                gradients.append(tau @ dtau)
        hessian = (np.array(gradients[::2]) - np.array(gradients[1::2])) / (2.0 * step)
        tree.update(q)
        projector = np.eye(len(q)) - np.linalg.pinv(tree.J) @ tree.J
        curvature = np.linalg.eigvalsh(projector @ (0.5 * (hessian + hessian.T)) @ projector)[-1]
        product = self.tasks.dt * self.gamma_grav * curvature
        if product >= 1.0:
            raise self._too_stiff("gamma_grav", self.tuning.gamma_grav, product)

    def _too_stiff(self, key: str, gain: float, product: float) -> ConfigError:
        return ConfigError(
            f"ik.{key}",
            f"{gain:g} is too stiff for dt = {self.tasks.dt:g} s on {self.robot.spec.name}; "
            f"below {gain / product:.3g}, or a smaller dt",
        )
