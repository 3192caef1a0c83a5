"""Picking up: rest, above the object, at it, above it, rest, each a static posture found before.

The postures give CoM, torso and the joints that the hand leaves free; the reaching arm and the legs
follow from hand, CoM and torso. A payload weighs from the grasp on, and its weight is taken over in
the pause, so that the CoM of both moves without a jump.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.gait import PickUpGait, PickUpParameters
from mgs.motion_planner.motion_plan import KeyPlan, MotionPlan
from mgs.motion_planner.standing import StandingFigures, standing_figures, standing_plan
from mgs.motion_planner.static_pose import StaticPose, find_pose
from mgs.robot import Robot, arm_mask, leg_length, leg_mask

CLEARANCE = 0.15  # of the leg length


def plan_pick_up(robot: Robot, gait: PickUpGait) -> MotionPlan:
    """One phase on both feet and the keys of the body in it; see `plan_motion` for the errors."""
    pick_up, rest = gait.pick_up, standing_figures(robot)
    sides = tuple(Side) if pick_up.hand == "both" else (Side[pick_up.hand.upper()],)
    for side in sides:
        if np.isnan(rest.hands[side]).any():
            raise ConfigError(
                "pick_up.hand",
                f"{side.label}: {robot.spec.name} cannot move this hand against its torso",
            )
    asked = np.array([side in sides for side in Side])
    at = _goals(pick_up, rest, asked)
    above = at + np.array([0.0, 0.0, pick_up.clearance or CLEARANCE * leg_length(robot)])
    begin = np.where(asked[:, None], rest.hands, np.nan)
    poses = _poses(robot, pick_up, rest, (begin, above, at))
    arrivals = np.round(np.array([0.0, *pick_up.times[1:]]) / gait.dt).astype(np.intp)
    departures = arrivals.copy()
    departures[0] = round(pick_up.rest / gait.dt)
    n_samples = round(pick_up.duration / gait.dt) + 1
    departures[-1] = n_samples - 1
    times = gait.dt * np.arange(n_samples, dtype=np.float64)
    free = ~leg_mask(robot)
    for side in sides:
        free &= ~arm_mask(robot, side)
    return standing_plan(
        robot,
        gait.dt,
        n_samples,
        rest,
        KeyPlan(
            arrivals=arrivals,
            departures=departures,
            com=np.array([pose.com for pose in poses]),
            torso=np.array([pose.torso for pose in poses]),
            hands=np.where(asked[:, None], [begin, above, at, at, above, begin], np.nan),
            posture=np.array([pose.joints for pose in poses]),
            held=free,
            payload=gait.payload(times),
            mass=robot.mass,
        ),
    )


def _goals(pick_up: PickUpParameters, rest: StandingFigures, asked: NDArray[np.bool_]) -> Array:
    """Where the hands (2, 3) grasp."""
    apart = np.zeros((2, 3))
    if asked.all():
        width = pick_up.width or float(np.ptp(rest.hands[:, 1]))
        apart[:, 1] = [0.5 * width, -0.5 * width]
    return np.where(asked[:, None], pick_up.object + apart, np.nan)


def _poses(
    robot: Robot, pick_up: PickUpParameters, rest: StandingFigures, goals: tuple[Array, ...]
) -> list[StaticPose]:
    """Postures at rest, above, at the object, then with the payload: at, above and at rest."""
    begin, above, at = goals
    still = StaticPose(robot.posture, rest.com, rest.torso, rest.hands)
    hands = ~np.isnan(begin[:, 0])
    payload = pick_up.payload * hands / hands.sum()
    over = find_pose(robot, above, 0.0 * payload, robot.posture)
    down = find_pose(robot, at, 0.0 * payload, over.joints)
    if not pick_up.payload:
        return [still, over, down, down, over, still]
    laden = [
        find_pose(robot, goal, payload, pose.joints)
        for goal, pose in ((at, down), (above, over), (begin, still))
    ]
    return [still, over, down, *laden]
