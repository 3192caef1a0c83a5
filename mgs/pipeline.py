"""The four stages in a row: from a gait to a motion, without any file."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from mgs.com_generator import ComTrajectory, generate_com
from mgs.dynamics import analyse, place_on_soles
from mgs.gait import Gait, WalkGait
from mgs.ik_solver import JointTrajectory, solve_ik
from mgs.motion import Motion
from mgs.motion_planner import MotionPlan, plan_motion
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories

T = TypeVar("T")
Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class Stages:
    """The products of the four stages and the motion made of them."""

    plan: MotionPlan
    tasks: TaskTrajectory
    com: ComTrajectory
    joints: JointTrajectory
    motion: Motion
    seconds: dict[str, float] = field(default_factory=dict)  # wall time of each stage


def generate(
    robot: Robot, gait: Gait, name: str = "gait", progress: Progress | None = None
) -> Stages:
    """Run the four stages.

    Args:
        robot: the robot.
        gait: what it shall do.
        name: name of the gait, for the motion file.
        progress: called with samples done and samples in all by the IK.

    Raises:
        ConfigError: values of the gait that do not fit each other or this robot.
        InfeasibleGaitError: the robot cannot do it; names time, task or joint, and the remedy.
    """
    seconds: dict[str, float] = {}
    plan = _timed(seconds, "motion_planner", lambda: plan_motion(robot, gait))
    tasks = _timed(seconds, "trajectory_planner", lambda: plan_trajectories(plan))
    preview = gait.com if isinstance(gait, WalkGait) else None
    com = _timed(seconds, "com_generator", lambda: generate_com(tasks, preview))
    joints = _timed(seconds, "ik_solver", lambda: solve_ik(robot, tasks, com, gait.ik, progress))
    motion = _timed(
        seconds, "dynamics", lambda: assemble(robot, gait, name, plan, tasks, com, joints)
    )
    return Stages(plan, tasks, com, joints, motion, seconds)


def assemble(
    robot: Robot,
    gait: Gait,
    name: str,
    plan: MotionPlan,
    tasks: TaskTrajectory,
    com: ComTrajectory,
    joints: JointTrajectory,
) -> Motion:
    """Motion of the four products: what was asked beside what the joints do."""
    q = place_on_soles(robot, joints.angles, tasks.root, tasks.soles)
    body = analyse(robot, q, tasks.dt, tasks.load_left)
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
        solver={**joints.report, **gait.ik.model_dump()},
    )


def _timed(seconds: dict[str, float], stage: str, work: Callable[[], T]) -> T:
    start = time.perf_counter()
    product = work()
    seconds[stage] = time.perf_counter() - start
    return product
