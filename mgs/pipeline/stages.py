"""The four stages in a row, for a gait of one part."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

import numpy as np

from mgs.com_generator import ComTrajectory, follow_com
from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.geometry import quintic, slerp
from mgs.core.progress import Progress
from mgs.gait import Gait, KickGait, SequenceGait, SingleGait, ZmpGait
from mgs.ik_solver import JointTrajectory, refuse_speed
from mgs.motion import Motion
from mgs.motion.dynamics import analyse, place_lowest
from mgs.motion.provenance import FilterReport
from mgs.motion_planner import MotionPlan, for_robot, plan_motion
from mgs.pipeline.assemble import assemble
from mgs.pipeline.dynamic_filter import Passes, filter_passes
from mgs.pipeline.timing import timed
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories


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


def run_stages(
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
        raise TypeError("a sequence has no stages of its own; use mgs.pipeline.generate")
    seconds: dict[str, float] = {}
    gait = for_robot(gait, robot)
    plan = timed(seconds, "motion_planner", lambda: plan_motion(robot, gait))
    tasks = timed(seconds, "trajectory_planner", lambda: plan_trajectories(plan))
    if not gait.is_balanced:
        return _unbalanced(robot, gait, name, plan, tasks, seconds)
    if start is not None:
        tasks = dataclasses.replace(tasks, start=start)
    passes = Passes(robot, gait, tasks, seconds, progress)
    report: FilterReport | None = None
    if isinstance(gait, ZmpGait):
        best = filter_passes(passes, gait.com)
        com, joints, body, report = best.com, best.joints, best.body, best.report
    else:
        com = passes.first_com()
        joints, body = passes.run(com)
    if isinstance(gait, KickGait):
        refuse_speed(robot, joints.angles, gait.dt)
    motion = timed(
        seconds,
        "dynamics",
        lambda: assemble(robot, gait, name, plan, tasks, com, joints, body, report),
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
    body = timed(seconds, "dynamics", lambda: analyse(robot, q, tasks.dt, tasks.load_left))
    body = dataclasses.replace(body, torque=np.zeros_like(body.torque), zmp=body.com[:, :2].copy())
    com = follow_com(body.com, tasks.dt)
    tasks = dataclasses.replace(
        tasks, soles=body.soles, zmp_ref=body.zmp, com=body.com, com_height=body.com[:, 2],
        torso_asked=False,
    )  # fmt: skip
    motion = assemble(robot, gait, name, plan, tasks, com, joints, body)
    return Stages(plan, tasks, com, joints, motion, seconds)
