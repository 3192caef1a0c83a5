"""Closed-loop IK with a gradient-projected secondary task.

Equations (9) to (14) of "Inverse kinematics of a humanoid robot modelled as a tree-shaped
manipulator". The task Jacobian J (m, n) has full row rank, m < n:

    q[k+1] = q[k] + dt v
    v  = v0 + J^T y,   (J J^T + damping^2 I) y = (t[k+1] - f(q[k])) / dt - J v0
    v0 = - gamma_joint grad H_joint - gamma_grav grad H_grav
    H_joint = 1/2 sum ((q - q_mid) / (q_max - q_min))^2,   H_grav = 1/2 tau^T W tau,   W = s^2 I

The tree is rooted at the support sole. In the paper H_grav makes sense in single support only:
gamma_grav falls linearly to zero before double support and rises after it. With the option
`double_support` the torques tau take into account how two soles share the weight, and gamma_grav
stays on.

The paper leaves the orientation of the torso free, and it drifts. With the option `torso` it is a
task of lower priority than J and of higher priority than v0. Its step is taken in the null space of
J, so that it is met where the robot can meet it, and never at the cost of soles, hands or CoM
(B. Siciliano and J.-J. Slotine, "A general framework for managing multiple tasks in highly
redundant robotic systems", ICAR 1991). With `gamma_momentum` the angular momentum about the
vertical is a task below the torso (`mgs.ik_solver.tree.lower_tasks`).

The equations know no hard limits. With `on_limit: hold`, a span in which a joint leaves its range
or exceeds its speed is solved again, with that joint held at its limit
(`mgs.ik_solver.tree.joint_bounds`).
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
import pinocchio as pin

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.errors import IkError
from mgs.core.progress import Progress
from mgs.core.spans import spans
from mgs.gait import IkParameters
from mgs.gait.ik import OnLimit
from mgs.ik_solver.gains import (
    gravity_gain_profile,
    gravity_scale,
    refuse_stiff_gravity_gain,
    refuse_stiff_joint_gain,
    rest_profile,
)
from mgs.ik_solver.joint_trajectory import JointTrajectory
from mgs.ik_solver.residuals import refuse_limits, refuse_misses, refuse_speed
from mgs.ik_solver.tree.joint_bounds import JointBounds
from mgs.ik_solver.tree.least_norm import LeastNorm
from mgs.ik_solver.tree.lower_tasks import LowerTasks
from mgs.ik_solver.tree.static_loads import Sharing, StaticLoads, loaded_gravity
from mgs.ik_solver.tree.targets import (
    TREE_TASKS,
    TorsoMode,
    refuse_torso,
    task_steps,
    tree_targets,
)
from mgs.ik_solver.tree.tasks import N_TASKS, TreeTasks
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

DAMPING = 1e-6  # Levenberg term, in the unit of J
UPDATE_ABOVE = 1e-5  # [m] and [rad], task error that calls for a Newton update
MAX_UPDATES = 10  # per sample; one or two are enough where they converge
MAX_START_UPDATES = 50


@dataclass(frozen=True, kw_only=True)
class ClosedLoopIk:
    """Settings of the closed-loop IK."""

    gamma_joint: float  # gain of the joint-limit gradient [rad^2/s]
    gamma_grav: float  # gain of the gravity-torque gradient [1/((N m)^2 s)]
    gamma_grav_ramp: float  # time over which gamma_grav rises and falls [s]
    double_support: Sharing  # how two soles share the weight; off: gamma_grav is 0 there
    iterations: int | None  # Newton updates per sample; None: until UPDATE_ABOVE is met
    gamma_momentum: float  # part of the angular momentum that is taken away in the null space
    torso: TorsoMode  # the orientation of the torso that is kept in the null space
    on_limit: OnLimit  # what becomes of a motion in which a joint reaches its limit

    @classmethod
    def from_parameters(cls, parameters: IkParameters) -> ClosedLoopIk:
        """Solver with the settings of a gait file."""
        return cls(
            gamma_joint=parameters.gamma_joint,
            gamma_grav=parameters.gamma_grav,
            gamma_grav_ramp=parameters.gamma_grav_ramp,
            double_support=parameters.double_support,
            iterations=parameters.iterations,
            gamma_momentum=parameters.gamma_momentum,
            torso=parameters.torso,
            on_limit=parameters.on_limit,
        )

    def solve(
        self,
        robot: Robot,
        tasks: TaskTrajectory,
        com: ComTrajectory,
        progress: Progress | None = None,
    ) -> JointTrajectory:
        """Follow the tasks from the half-sitting posture; see `IkSolver.solve` for the errors."""
        return _Run(self, robot, tasks, com).follow(progress)


@dataclass(frozen=True)
class ClosedLoopReport:
    """How the closed-loop IK fared."""

    newton_updates: int  # in all samples together
    held_steps: int = 0  # steps, Newton updates among them, that a limit has changed

    def to_dict(self) -> dict[str, object]:
        """The report as plain data."""
        return asdict(self)


class _Run:
    """One pass over a trajectory: the buffers and the loop over samples."""

    def __init__(
        self, settings: ClosedLoopIk, robot: Robot, tasks: TaskTrajectory, com: ComTrajectory
    ) -> None:
        refuse_torso(tasks, "clik")
        self.settings, self.robot, self.tasks, self.com = settings, robot, tasks, com
        self.trees = tuple(TreeTasks(robot, side, tasks.hands_asked) for side in Side)
        exact = settings.iterations is None
        self.max_updates = MAX_UPDATES if settings.iterations is None else settings.iterations
        self.threshold2 = UPDATE_ABOVE**2 if exact else 0.0
        self.updates = self.held = 0
        self.inverse_range2 = 1.0 / (robot.upper - robot.lower) ** 2
        self.middle = 0.5 * (robot.upper + robot.lower)
        self.loads: StaticLoads | None = None
        self._set_gains()
        self.lower = LowerTasks(robot, tasks, settings.torso, settings.gamma_momentum)
        self.angles = np.empty((tasks.n_samples, robot.n))

    def _set_gains(self) -> None:
        """Both gains times dt at every sample, zero at both ends of the motion."""
        settings, tasks, ramp = self.settings, self.tasks, self.settings.gamma_grav_ramp
        rest = rest_profile(tasks.n_samples, tasks.dt, ramp)
        self.gain_joint = tasks.dt * settings.gamma_joint * rest
        self.scale = gravity_scale(self.robot, tasks.com_height[0])
        if settings.double_support == "off":
            rest = rest * gravity_gain_profile(tasks.support, tasks.dt, ramp)
        else:
            rest = rest**2 * (3.0 - 2.0 * rest)  # torques are large at once: speed must not jump
            if settings.gamma_grav:
                self.loads = StaticLoads(self.robot, tasks, self.com, settings.double_support)
        self.gain_grav = (tasks.dt * settings.gamma_grav * self.scale * rest).tolist()

    def follow(self, progress: Progress | None) -> JointTrajectory:
        """Follow each span that stands on one sole in turn, since each sole has its own tree."""
        tasks, dt = self.tasks, self.tasks.dt
        q = self.robot.posture if tasks.start is None else tasks.start
        for start, end in spans(tasks.root):
            root = tasks.root[start]
            tree = self.trees[root]
            tree.place(pin.XYZQUATToSE3(tasks.soles[start, root]))
            positions, rotations = tree_targets(tasks, self.com.position, start, end)
            q_tree = q[tree.order]
            bounds = self._bounds(tree)
            if start == 0:
                q_tree = self._start(tree, q_tree, positions[0], rotations[0], bounds)
            path, errors = self._follow_span(tree, q_tree, start, positions, rotations)
            self._take(tree, slice(start, end), path)
            if bounds is not None and not bounds.are_kept(q_tree, path):
                held = self._follow_span(tree, q_tree, start, positions, rotations, bounds)
                self._accept_held(tree, q, start, *held, errors)
                self.held += bounds.held
            else:
                refuse_misses(TREE_TASKS, errors, dt, start)
            if self.settings.on_limit != "record":
                refuse_limits(self.robot, self.angles[start:end], dt, start)
            q = self.angles[end - 1]
            if progress is not None:
                progress(end, tasks.n_samples)
        return JointTrajectory(self.angles, report=ClosedLoopReport(self.updates, self.held))

    def _accept_held(
        self, tree: TreeTasks, q: Array, start: int, path: Array, errors: Array, free: Array
    ) -> None:
        """Take joint angles path (N, n), in which joints are held at limits, into `angles`.

        If they miss a task, the error states the cause that the free motion shows, which is in
        `angles` now: its own miss, or else the joint that leaves its limit.

        Args:
            tree: tree of the support sole.
            q: (n,) joint angles before `start`.
            start: sample of the motion to which the first row of `path` belongs.
            path: joint angles in the order of the tree.
            errors: (N, m) task errors of `path`.
            free: (N, m) task errors of the free motion.
        """
        span, dt = slice(start, start + len(path)), self.tasks.dt
        try:
            refuse_misses(TREE_TASKS, errors, dt, start)
        except IkError:
            refuse_misses(TREE_TASKS, free, dt, start)
            refuse_limits(self.robot, self.angles[span], dt, start)
            refuse_speed(self.robot, np.vstack([q, self.angles[span]]), dt, start - 1)
            raise
        self._take(tree, span, path)

    def _take(self, tree: TreeTasks, span: slice, path: Array) -> None:
        """Take joint angles path (N, n) of a tree into `angles`; followers follow."""
        self.angles[span, tree.order] = path
        if self.robot.coupling is not None:
            self.robot.coupling.complete(self.angles[span])

    def _bounds(self, tree: TreeTasks) -> JointBounds | None:
        """Limits of the joints, if joints are to be held at them."""
        if self.settings.on_limit != "hold":
            return None
        return JointBounds(self.robot, tree.order, tree.asked_rows, self.tasks.dt)

    def _follow_span(
        self,
        tree: TreeTasks,
        q: Array,
        start: int,
        positions: Array,
        rotations: Array,
        bounds: JointBounds | None = None,
    ) -> tuple[Array, Array]:
        """Joint angles (N, n) from sample `start`, beginning at q (n,); task errors left (N, m)."""
        span = slice(start, start + len(positions))
        pull = self.gain_joint[span, None] * self.inverse_range2[tree.order]
        aim = pull * self.middle[tree.order]  # aim - pull q = - dt gamma_joint grad H_joint
        advance = _advance(tree, positions, rotations)
        path, errors = np.empty_like(pull), np.empty_like(advance)
        solver = LeastNorm(tree.rows, DAMPING)
        v0, gain_grav, error = solver.v, self.gain_grav, errors[0]
        has_lower = bool(self.lower)
        tree.update(q)
        tree.error(positions[0], rotations[0], error)
        rows = zip(positions, rotations, advance, aim, pull, path, errors, strict=True)
        for k, (x, R, step, aim_k, pull_k, q_next, error_next) in enumerate(rows, start):
            np.subtract(aim_k, pull_k * q, v0)
            if gain_grav[k]:
                tau, dtau = loaded_gravity(tree, self.loads, k, q)
                v0 -= tau.dot(dtau) * gain_grav[k]
            dq = solver.step(error + step)
            if has_lower:
                dq = self.lower.add(tree, solver, dq, q, k)
            if bounds is not None:
                dq = bounds.limit(dq, q, q, tree.J, error + step, self.lower.rows(tree))
            q_last, q = q, np.add(q, dq, q_next)
            error = error_next  # t[k] - f(q[k]); with the next step t[k+1] - f(q[k])
            tree.update(q)
            tree.error(x, R, error)
            if error.dot(error) > self.threshold2:
                self._correct(tree, solver, q, x, R, error, bounds, q_last)
        return path, errors

    def _correct(
        self,
        tree: TreeTasks,
        solver: LeastNorm,
        q: Array,
        x: Array,
        R: Array,
        error: Array,
        bounds: JointBounds | None,
        q_last: Array,
    ) -> None:
        """Newton updates of q (n,) and of its task error (m,) at one sample, in place.

        With `bounds` they keep to what the joints can reach from q_last (n,) of the sample before.
        """
        solver.v[:] = 0.0
        for _ in range(self.max_updates):
            dq = solver.step(error)
            if bounds is not None:
                dq = bounds.limit(dq, q, q_last, tree.J, error, self.lower.rows(tree))
            q += dq
            tree.update(q)
            tree.error(x, R, error)
            self.updates += 1
            if not error.dot(error) > self.threshold2:
                break

    def _start(
        self, tree: TreeTasks, posture: Array, x: Array, R: Array, bounds: JointBounds | None
    ) -> Array:
        """Joint angles (n,) on the tasks of the first sample, found from a posture (n,)."""
        settings, dt = self.settings, self.tasks.dt
        q = self._reach(tree, posture, x, R, None)
        if bounds is not None and not np.all((q >= bounds.lower) & (q <= bounds.upper)):
            q = self._reach(tree, posture, x, R, bounds)
        refuse_stiff_joint_gain(self.robot, settings.gamma_joint, dt)
        if settings.gamma_grav:
            refuse_stiff_gravity_gain(self.robot, tree, q, settings.gamma_grav, self.scale, dt)
        return q

    def _reach(
        self, tree: TreeTasks, posture: Array, x: Array, R: Array, bounds: JointBounds | None
    ) -> Array:
        """Joint angles (n,) on the tasks of one sample, by Newton's method from a posture (n,)."""
        q, error = posture.copy(), np.empty(tree.n_rows)
        any_speed = np.full_like(q, np.nan)
        solver = LeastNorm(tree.rows, DAMPING)
        for _ in range(MAX_START_UPDATES):
            tree.update(q)
            tree.error(x, R, error)
            # Damping by the error (T. Sugihara, "Solvability-unconcerned inverse kinematics by the
            # Levenberg-Marquardt method", IEEE Trans. Robotics 27(5), 2011) settles at the nearest
            # posture where the goal is out of reach: the message then says how far it is.
            dq = solver.step(error, error.dot(error))
            off = error.dot(error)
            if self.lower.targets is not None:
                dq = self.lower.turn_torso(tree, solver, dq)
                off = max(off, dq.dot(dq))
            if off < UPDATE_ABOVE**4:  # quadratic convergence: the last one is exact
                break
            if bounds is not None:
                dq = bounds.limit(dq, q, any_speed, tree.J, error, self.lower.rows(tree))
            q += dq
        return q


def _advance(tree: TreeTasks, positions: Array, rotations: Array) -> Array:
    """t[k] - t[k-1] (N, m), zero in the rows of free hands and in those that hold the pelvis."""
    advance = np.zeros((len(positions), tree.n_rows))
    advance[:, :N_TASKS] = np.nan_to_num(task_steps(positions, rotations))  # NaN: a free hand
    advance[:, tree.held_rows] = 0.0
    return advance
