"""The four stages in a row: from a gait to a motion, without any file."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from mgs.com_generator import ComTrajectory, correct_com, follow_com, generate_com, planned_zmp
from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.errors import InfeasibleGaitError
from mgs.core.geometry import quintic, slerp
from mgs.core.progress import Progress
from mgs.gait import ComParameters, Gait, KickGait, SequenceGait, SingleGait, ZmpGait
from mgs.ik_solver import JointTrajectory, refuse_speed, solve_ik
from mgs.motion import Motion
from mgs.motion.dynamics import WholeBodyMotion, analyse, place_lowest, place_on_soles
from mgs.motion_planner import MotionPlan, for_robot, plan_motion
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Stages:
    """The products of the four stages and the motion made of them."""

    plan: MotionPlan
    tasks: TaskTrajectory
    com: ComTrajectory
    joints: JointTrajectory
    motion: Motion
    seconds: dict[str, float] = field(default_factory=dict)  # wall time of each stage

    @property
    def gait(self) -> SingleGait:
        """What was asked."""
        assert not isinstance(self.motion.gait, SequenceGait)
        return self.motion.gait


def generate(
    robot: Robot,
    gait: Gait,
    name: str = "gait",
    progress: Progress | None = None,
    start: Array | None = None,
) -> Stages:
    """Run the four stages.

    Args:
        robot: the robot.
        gait: what it shall do; no sequence, which has stages for each of its parts.
        name: name of the gait, for the motion file.
        progress: called with samples done and samples in all by the IK.
        start: joint angles (n,) that the IK begins from [rad]; None: the half-sitting posture.

    Raises:
        ConfigError: values of the gait that do not fit each other or this robot.
        InfeasibleGaitError: the robot cannot do it; names time, task or joint, and the remedy.
    """
    if isinstance(gait, SequenceGait):
        raise TypeError("a sequence is what mgs.pipeline.generate_motion is for")
    seconds: dict[str, float] = {}
    gait = for_robot(gait, robot)
    plan = _timed(seconds, "motion_planner", lambda: plan_motion(robot, gait))
    tasks = _timed(seconds, "trajectory_planner", lambda: plan_trajectories(plan))
    if not gait.is_balanced:
        return _unbalanced(robot, gait, name, plan, tasks, seconds)
    if start is not None:
        tasks = dataclasses.replace(tasks, start=start)
    passes = _Passes(robot, gait, tasks, seconds, progress)
    error: dict[str, object] | None = None
    if isinstance(gait, ZmpGait):
        com, joints, body, error = _filter(passes, gait.com)
    else:
        com = passes.first_com()
        joints, body = passes.run(com)
    if isinstance(gait, KickGait):
        refuse_speed(robot, joints.angles, gait.dt)
    motion = _timed(
        seconds,
        "dynamics",
        lambda: assemble(robot, gait, name, plan, tasks, com, joints, body, error),
    )
    return Stages(plan, tasks, com, joints, motion, seconds)


def _unbalanced(
    robot: Robot,
    gait: SingleGait,
    name: str,
    plan: MotionPlan,
    tasks: TaskTrajectory,
    seconds: dict[str, float],
) -> Stages:
    """Joint postures alone: what bears the robot on the way is not known, hence no torques.

    For the eye the base turns from where it lies to upright, the robot's lowest point on the
    ground. All references are what the joints do.
    """
    assert plan.keys is not None and plan.keys.base is not None and tasks.posture is not None
    joints = JointTrajectory(tasks.posture)
    rise = quintic(np.arange(tasks.n_samples) / (tasks.n_samples - 1))
    turns = slerp(plan.keys.base, robot.standing_q[3:FLOATING_BASE_NQ], rise)
    q = place_lowest(robot, joints.angles, turns)
    body = _timed(seconds, "dynamics", lambda: analyse(robot, q, tasks.dt, tasks.load_left))
    body = dataclasses.replace(body, torque=np.zeros_like(body.torque), zmp=body.com[:, :2].copy())
    com = follow_com(body.com, tasks.dt)
    tasks = dataclasses.replace(
        tasks, soles=body.soles, zmp_ref=body.zmp, com=body.com, com_height=body.com[:, 2],
        torso_asked=False,
    )  # fmt: skip
    motion = assemble(robot, gait, name, plan, tasks, com, joints, body)
    return Stages(plan, tasks, com, joints, motion, seconds)


@dataclass(eq=False)
class _Passes:
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
        """Stage 3."""
        parameters = self.gait.com if isinstance(self.gait, ZmpGait) else None
        return _timed(
            self.seconds, "com_generator", lambda: generate_com(self.tasks, parameters, self.robot)
        )

    def run(self, com: ComTrajectory) -> tuple[JointTrajectory, WholeBodyMotion]:
        """Joints that follow a CoM motion, and what the whole robot does then."""
        joints = _timed(
            self.seconds,
            "ik_solver",
            lambda: solve_ik(self.robot, self.tasks, com, self.gait.ik, self._tell),
        )
        self.n_run += 1
        body = _timed(self.seconds, "dynamics", lambda: _whole_body(self.robot, self.tasks, joints))
        return joints, body

    def correct(self, com: ComTrajectory, error: Array, parameters: ComParameters) -> ComTrajectory:
        """The CoM motion for the next pass."""
        zmp_ref, dt = self.tasks.zmp_ref, self.tasks.dt
        return _timed(
            self.seconds,
            "com_generator",
            lambda: correct_com(com, zmp_ref, error, dt, parameters),
        )

    def _tell(self, done: int, total: int) -> None:
        if self.progress is not None:
            most = 1 + (self.gait.com.passes if isinstance(self.gait, ZmpGait) else 0)
            self.progress(done + min(self.n_run, most - 1) * total, most * total)


def _filter(
    passes: _Passes, parameters: ComParameters
) -> tuple[ComTrajectory, JointTrajectory, WholeBodyMotion, dict[str, object]]:
    """The dynamic filter: correct the CoM by what the whole robot's ZMP is off from the plan.

    It ends when the mean error is within tolerance, when a pass brings no better motion or none at
    all, and after com.passes. Returns the best pass, and its errors beside those of the first.
    """
    joints: JointTrajectory | None
    body: WholeBodyMotion | None
    com = passes.first_com()
    planned = planned_zmp(passes.tasks, com, parameters)
    joints, body = passes.run(com)
    error = planned - body.zmp
    before = after = _mean_and_max(error)
    kept = 0
    while kept < parameters.passes and after["mean"] > parameters.zmp_tolerance:
        joints = body = None  # a long walk has no room for two of them
        try:
            corrected = passes.correct(com, error, parameters)
            joints, body = passes.run(corrected)
        except InfeasibleGaitError:
            break
        error = planned - body.zmp
        now = _mean_and_max(error)
        if not now["mean"] < after["mean"]:
            joints = None
            break
        com, after, kept = corrected, now, kept + 1
    if joints is None or body is None:
        joints, body = passes.run(com)  # the best was the one before
    return com, joints, body, {"before": before, "after": after, "passes": kept}


def _mean_and_max(error: Array) -> dict[str, float]:
    """Of the lengths of errors (N, 2)."""
    distance = np.hypot(*error.T)
    return {"mean": float(distance.mean()), "max": float(distance.max())}


def _whole_body(robot: Robot, tasks: TaskTrajectory, joints: JointTrajectory) -> WholeBodyMotion:
    q = place_on_soles(robot, joints.angles, tasks.root, tasks.soles)
    return analyse(robot, q, tasks.dt, tasks.load_left, tasks.payload)


def assemble(
    robot: Robot,
    gait: SingleGait,
    name: str,
    plan: MotionPlan,
    tasks: TaskTrajectory,
    com: ComTrajectory,
    joints: JointTrajectory,
    body: WholeBodyMotion | None = None,
    zmp_error: dict[str, object] | None = None,
) -> Motion:
    """Motion of the four products: what was asked beside what the joints do.

    `body` is what the whole robot does, computed where it is not known yet.
    """
    body = _whole_body(robot, tasks, joints) if body is None else body
    hands = tasks.hands + com.position[:, None]
    return Motion(
        robot=robot,
        gait=gait,
        gait_name=name,
        dt=tasks.dt,
        footsteps=plan.footsteps,
        support=tasks.support,
        q=body.q,
        v=body.v,
        torque=body.torque,
        com=body.com,
        com_ref=com.position,
        zmp=body.zmp,
        zmp_ref=tasks.zmp_ref,
        soles=body.soles,
        soles_ref=tasks.soles,
        hands=body.hands,
        hands_ref=np.where(np.isfinite(hands), hands, body.hands[..., :3]),
        torso=body.torso,
        torso_ref=tasks.torso if tasks.torso_asked else body.torso[:, 3:],
        solver={
            **joints.report,
            **gait.ik.model_dump(),
            **({} if zmp_error is None else {"zmp_error": zmp_error}),
        },
        scene=plan.scene,
    )


def _timed(seconds: dict[str, float], stage: str, work: Callable[[], T]) -> T:
    """Add the time of `work` to its stage, which may be worked on more than once."""
    start = time.perf_counter()
    product = work()
    seconds[stage] = seconds.get(stage, 0.0) + time.perf_counter() - start
    return product
