"""The dynamic filter's loop: correct the CoM motion until the whole robot's ZMP is the planned one.

Every pass solves the inverse kinematics for one CoM motion and computes what the whole robot's ZMP
does then. `mgs.com_generator.correct_com` has the correction between two passes, and its source.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.com_generator import ComTrajectory, correct_com, follow_com, generate_com, planned_zmp
from mgs.core.arrays import Array
from mgs.core.errors import InfeasibleGaitError
from mgs.core.progress import Progress
from mgs.gait import ComParameters, SingleGait, ZmpGait
from mgs.ik_solver import JointTrajectory, solve_ik
from mgs.motion.dynamics import WholeBodyMotion
from mgs.motion.provenance import FilterReport, ZmpError
from mgs.pipeline.assemble import whole_body
from mgs.pipeline.timing import timed
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory


@dataclass(frozen=True, eq=False)
class Filtered:
    """The products of the best pass."""

    com: ComTrajectory
    joints: JointTrajectory
    body: WholeBodyMotion
    report: FilterReport


@dataclass(eq=False)
class Passes:
    """Inverse kinematics and dynamics of one CoM motion after the other.

    Its progress counts every pass that there may be.
    """

    robot: Robot
    gait: SingleGait
    tasks: TaskTrajectory
    seconds: dict[str, float]
    progress: Progress | None
    n_run: int = 0

    def first_com(self) -> ComTrajectory:
        """The CoM motion of stage 3."""
        return timed(
            self.seconds, "com_generator", lambda: first_com(self.robot, self.gait, self.tasks)
        )

    def run(self, com: ComTrajectory) -> tuple[JointTrajectory, WholeBodyMotion]:
        """Joints that follow a CoM motion, and what the whole robot does then."""
        joints = timed(
            self.seconds,
            "ik_solver",
            lambda: solve_ik(self.robot, self.tasks, com, self.gait.ik, self._tell),
        )
        self.n_run += 1
        body = timed(self.seconds, "dynamics", lambda: whole_body(self.robot, self.tasks, joints))
        return joints, body

    def correct(self, com: ComTrajectory, error: Array, parameters: ComParameters) -> ComTrajectory:
        """The CoM motion for the next pass, from the ZMP error (N, 2) of this one [m]."""
        zmp_ref, dt = self.tasks.zmp_ref, self.tasks.dt
        return timed(
            self.seconds,
            "com_generator",
            lambda: correct_com(com, zmp_ref, error, dt, parameters),
        )

    def _tell(self, done: int, total: int) -> None:
        if self.progress is not None:
            most = 1 + (self.gait.com.passes if isinstance(self.gait, ZmpGait) else 0)
            self.progress(done + min(self.n_run, most - 1) * total, most * total)


def first_com(robot: Robot, gait: SingleGait, tasks: TaskTrajectory) -> ComTrajectory:
    """The CoM motion of stage 3: the one that is asked for, or the one that the ZMP asks for."""
    if isinstance(gait, ZmpGait):
        return generate_com(robot, tasks, gait.com)
    if tasks.com is None:
        raise TypeError(f"a plan for motion {gait.motion} has to say where the CoM goes")
    return follow_com(tasks.com, tasks.dt)


def filter_passes(passes: Passes, parameters: ComParameters) -> Filtered:
    """Correct the CoM by what the whole robot's ZMP is off from the plan, and keep the best pass.

    The loop ends when the mean error is within `com.zmp_tolerance`, when a pass brings no better
    motion or none at all, and after `com.passes` corrections.
    """
    joints: JointTrajectory | None
    body: WholeBodyMotion | None
    com = passes.first_com()
    planned = planned_zmp(passes.tasks, com, parameters)
    joints, body = passes.run(com)
    error = planned - body.zmp
    before = after = _size(error)
    kept = 0
    while kept < parameters.passes and after.mean > parameters.zmp_tolerance:
        joints = body = None  # a long walk has no room for two of them
        try:
            corrected = passes.correct(com, error, parameters)
            joints, body = passes.run(corrected)
        except InfeasibleGaitError:
            break
        error = planned - body.zmp
        now = _size(error)
        if not now.mean < after.mean:
            joints = None
            break
        com, after, kept = corrected, now, kept + 1
    if joints is None or body is None:
        joints, body = passes.run(com)  # the best was the one before
    return Filtered(com, joints, body, FilterReport(before, after, kept))


def _size(error: Array) -> ZmpError:
    """Mean and largest length of errors (N, 2)."""
    distance = np.hypot(*error.T)
    return ZmpError(float(distance.mean()), float(distance.max()))
