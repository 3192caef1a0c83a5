"""The four stages in a row, for a gait of one part."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

import numpy as np

from mgs.com_generator import ComTrajectory, follow_com
from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError
from mgs.core.progress import Progress
from mgs.core.short_repr import short_repr
from mgs.gait import Gait, KickGait, RecordedGait, SequenceGait, SingleGait, ZmpGait
from mgs.gait.remedies import remedies_for
from mgs.ik_solver import JointTrajectory, refuse_speed
from mgs.motion import Motion
from mgs.motion.dynamics import analyse, place_lowest
from mgs.motion.provenance import FilterReport
from mgs.motion_planner import MotionPlan, PosturePlan, for_robot, plan_motion
from mgs.pipeline.assemble import assemble
from mgs.pipeline.dynamic_filter import Passes, filter_passes
from mgs.pipeline.timing import timed
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory, plan_posture_trajectory, plan_trajectories


@dataclass(frozen=True, eq=False)
class Stages:
    """The products of the four stages and the motion made of them."""

    plan: MotionPlan
    tasks: TaskTrajectory
    com: ComTrajectory
    joints: JointTrajectory
    motion: Motion
    seconds: dict[str, float] = field(default_factory=dict)  # wall time of each stage

    __repr__ = short_repr

    @property
    def gait(self) -> SingleGait:
        """The gait that was asked for."""
        assert not isinstance(self.motion.gait, SequenceGait | RecordedGait)
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
        gait: the gait, which may not be a sequence: each part of a sequence has its own stages.
        name: name of the gait in the motion file.
        progress: called with the number of samples that the IK has done, and with that of all.
        start: joint angles (n,) that the IK starts from [rad]; None: the half-sitting posture.

    Raises:
        ConfigError: values of the gait do not fit each other or this robot.
        InfeasibleGaitError: the robot cannot do it; the message names time, task or joint, and a
            remedy in keys of this kind of gait.
    """
    if isinstance(gait, SequenceGait):
        raise TypeError("a sequence has no stages of its own; use mgs.pipeline.generate")
    if isinstance(gait, RecordedGait):
        raise ConfigError(name, "was recorded, so that there is no gait that could be planned")
    gait = for_robot(gait, robot)
    with remedies_for(gait):
        return _run(robot, gait, name, progress, start)


def _run(
    robot: Robot, gait: SingleGait, name: str, progress: Progress | None, start: Array | None
) -> Stages:
    """Run the stages of a gait whose sizes are resolved; see `run_stages`."""
    seconds: dict[str, float] = {}
    plan = timed(seconds, "motion_planner", lambda: plan_motion(robot, gait))
    if isinstance(plan, PosturePlan):
        return _run_postures(robot, gait, name, plan, seconds)
    tasks = timed(seconds, "trajectory_planner", lambda: plan_trajectories(plan))
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


def _run_postures(
    robot: Robot, gait: SingleGait, name: str, plan: PosturePlan, seconds: dict[str, float]
) -> Stages:
    """Stages of a motion without balance, of which only the joint angles are planned.

    Which contacts carry the robot on the way is not known, so that torques are left at zero. For
    viewers the lowest point of the robot is put on the ground. References are what the joints do.
    """
    n = plan.n_samples
    planned = timed(seconds, "trajectory_planner", lambda: plan_posture_trajectory(plan))
    q = place_lowest(robot, planned.angles, planned.base)
    equal_load = np.full(n, 0.5)
    body = timed(seconds, "dynamics", lambda: analyse(robot, q, plan.dt, equal_load))
    body = dataclasses.replace(body, torque=np.zeros_like(body.torque), zmp=body.com[:, :2].copy())
    tasks = TaskTrajectory(
        dt=plan.dt,
        support=np.full(n, Support.DOUBLE, np.int8),
        root=np.full(n, Side.LEFT, np.int8),
        zmp_ref=body.zmp,
        load_left=equal_load,
        soles=body.soles,
        hands=np.full((n, 2, 3), np.nan),
        com_height=body.com[:, 2],
        torso=body.torso[:, 3:],
        com=body.com,
    )
    com, joints = follow_com(body.com, plan.dt), JointTrajectory(planned.angles)
    motion = assemble(robot, gait, name, plan, tasks, com, joints, body)
    return Stages(plan, tasks, com, joints, motion, seconds)
