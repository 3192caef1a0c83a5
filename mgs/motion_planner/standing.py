"""Where the parts of a robot are while it stands in its half-sitting posture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.contact import Footstep, Side, Support
from mgs.motion_planner.motion_plan import KeyPlan, LegReach, MotionPlan, Phase
from mgs.robot import Robot, midpoint_width

STRETCH = 0.97  # of a straight leg that is made use of
LEAST_ARM_JOINTS = 3  # that can place a hand anywhere about a point


@dataclass(frozen=True, eq=False)
class StandingFigures:
    """World frame, origin on the ground midway between the soles."""

    com: Array  # (3,) [m]
    hands: Array  # (2, 3) left and right [m]; NaN: it cannot be moved freely against the torso
    torso: Array  # (4,) quaternion xyzw


def standing_figures(robot: Robot) -> StandingFigures:
    """Figures of the half-sitting posture."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.standing_q)
    com = pin.centerOfMass(robot.model, data, robot.standing_q, False).copy()
    hands = np.array([data.oMf[frame].translation for frame in robot.hand_frames])
    supports, frames = robot.model.supports, robot.model.frames
    trunk = set(supports[frames[robot.torso_frame].parentJoint])
    for side, frame in enumerate(robot.hand_frames):
        arm = set(supports[frames[frame].parentJoint]) - trunk
        if len(arm) < LEAST_ARM_JOINTS:
            hands[side] = np.nan
    torso = pin.Quaternion(data.oMf[robot.torso_frame].rotation).coeffs()
    return StandingFigures(com, hands, np.array(torso))


def leg_reach(robot: Robot) -> LegReach:
    """Hips and ankles of the half-sitting posture, and how far apart they may be."""
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, robot.standing_q)
    com = pin.centerOfMass(model, data, robot.standing_q, False).copy()
    hips, ankles, lengths = np.empty((2, 3)), np.empty((2, 3)), []
    for side in Side:
        frame = robot.sole_frames[side]
        chain = [joint for joint in model.supports[model.frames[frame].parentJoint] if joint > 1]
        hips[side] = data.oMi[chain[0]].translation - com
        ankles[side] = data.oMf[frame].actInv(data.oMi[chain[-1]].translation)
        places = [model.jointPlacements[joint].translation for joint in chain[1:]]
        lengths.append(sum(float(np.linalg.norm(place)) for place in places))
    return LegReach(hips, ankles, STRETCH * min(lengths))


def standing_plan(
    robot: Robot, dt: float, n_samples: int, rest: StandingFigures, keys: KeyPlan
) -> MotionPlan:
    """A plan of one phase on both feet, where they are at rest."""
    width = midpoint_width(robot)
    return MotionPlan(
        dt=dt,
        n_samples=n_samples,
        footsteps=tuple(Footstep(side, 0.0, 0.5 * side.sign * width, 0.0) for side in Side),
        phases=(Phase(0, n_samples, Support.DOUBLE, (0, 1)),),
        step_height=0.0,
        landing=0.0,
        com_height=float(rest.com[2]),
        zmp_offset=(0.0, 0.0),
        hand_offsets=np.full((2, 3), np.nan),
        torso=rest.torso,
        keys=keys,
    )
