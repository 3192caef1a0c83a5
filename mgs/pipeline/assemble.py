"""The motion made of what was asked and of what the joints do."""

from __future__ import annotations

import numpy as np

from mgs.com_generator import ComTrajectory
from mgs.core.plugins import COM_GENERATORS, IK_SOLVERS, Origin
from mgs.gait import SingleGait, ZmpGait
from mgs.ik_solver import JointTrajectory
from mgs.motion import Motion
from mgs.motion.dynamics import WholeBodyMotion, analyse, place_on_soles
from mgs.motion.provenance import FilterReport, Provenance
from mgs.motion_planner import MotionPlan
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory


def whole_body(robot: Robot, tasks: TaskTrajectory, joints: JointTrajectory) -> WholeBodyMotion:
    """What the whole robot does when its joints follow a trajectory, the support soles in place."""
    q = place_on_soles(robot, joints.angles, tasks.root, tasks.soles)
    return analyse(robot, q, tasks.dt, tasks.load_left, tasks.payload, tasks.pressure)


def assemble(
    robot: Robot,
    gait: SingleGait,
    name: str,
    plan: MotionPlan,
    tasks: TaskTrajectory,
    com: ComTrajectory,
    joints: JointTrajectory,
    body: WholeBodyMotion | None = None,
    zmp_error: FilterReport | None = None,
) -> Motion:
    """Motion of the four products: what was asked beside what the joints do.

    `body` is what the whole robot does, computed where it is not known yet.
    """
    body = whole_body(robot, tasks, joints) if body is None else body
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
        provenance=Provenance(
            solver=IK_SOLVERS.origin(gait.ik.solver),
            com_generator=_com_generator(gait),
            tuning=gait.ik.model_dump(),
            report={} if joints.report is None else joints.report.to_dict(),
            zmp_error=zmp_error,
        ),
        scene=plan.scene,
    )


def _com_generator(gait: SingleGait) -> Origin | None:
    return COM_GENERATORS.origin(gait.com.generator) if isinstance(gait, ZmpGait) else None
