"""The plan of picking something up: rest, above the object, at it, above it, rest.

Each key is a static posture that is found before the robot moves. It gives the CoM, the torso and
the joints that the hand leaves free; the reaching arm and the legs follow from hand, CoM and torso.
The payload counts from the grasp on. Its weight is taken over during the pause, so that the common
CoM of robot and payload moves without a jump.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.gait import PickUpGait, PickUpParameters
from mgs.motion_planner.motion_plan import KeyframePlan, KeyTimes, Payload
from mgs.motion_planner.standing import StandingFigures, feet_abreast, standing_figures
from mgs.motion_planner.static_pose import StaticPose, find_pose
from mgs.robot import Robot, arm_mask, leg_length, leg_mask

CLEARANCE = 0.15  # height above the object at which the hand stops first, in leg lengths


def plan_pick_up(robot: Robot, gait: PickUpGait) -> KeyframePlan:
    """Keys of the body from rest to the object and back; see `plan_motion` for the errors."""
    pick_up, rest = gait.pick_up, standing_figures(robot)
    asked = _asked_hands(robot, pick_up, rest)
    at = _goals(pick_up, rest, asked)
    above = at + np.array([0.0, 0.0, pick_up.clearance or CLEARANCE * leg_length(robot)])
    begin = np.where(asked[:, None], rest.hands, np.nan)
    poses = _poses(robot, pick_up, rest, (begin, above, at))
    times, n_samples = _key_times(gait)
    held = ~leg_mask(robot)
    for side in Side:
        if asked[side]:
            held &= ~arm_mask(robot, side)
    masses = gait.payload(gait.dt * np.arange(n_samples, dtype=np.float64))
    return KeyframePlan(
        dt=gait.dt,
        n_samples=n_samples,
        footsteps=feet_abreast(robot),
        times=times,
        com=np.array([pose.com for pose in poses]),
        torso=np.array([pose.torso for pose in poses]),
        hands=np.where(asked[:, None], [begin, above, at, at, above, begin], np.nan),
        posture=np.array([pose.joints for pose in poses]),
        held=held,
        payload=None if masses is None else Payload(masses, robot.mass),
    )


def _asked_hands(
    robot: Robot, pick_up: PickUpParameters, rest: StandingFigures
) -> NDArray[np.bool_]:
    """Mask (2,) of the hands that reach for the object."""
    asked = np.array([pick_up.hand in ("both", side.label) for side in Side])
    for side in Side:
        if asked[side] and np.isnan(rest.hands[side]).any():
            raise ConfigError(
                "pick_up.hand",
                f"{side.label}: {robot.spec.name} cannot move this hand relative to its torso",
            )
    return asked


def _key_times(gait: PickUpGait) -> tuple[KeyTimes, int]:
    """Samples at which the hand arrives at and leaves the keys, and the number of samples."""
    pick_up, dt = gait.pick_up, gait.dt
    arrivals = np.round(np.array([0.0, *pick_up.times[1:]]) / dt).astype(np.intp)
    departures = arrivals.copy()
    n_samples = round(pick_up.duration / dt) + 1
    departures[[0, -1]] = round(pick_up.rest / dt), n_samples - 1
    return KeyTimes(arrivals, departures), n_samples


def _goals(pick_up: PickUpParameters, rest: StandingFigures, asked: NDArray[np.bool_]) -> Array:
    """Points (2, 3) at which the hands grasp [m]; NaN for a hand that does not."""
    apart = np.zeros((2, 3))
    if asked.all():
        width = pick_up.width or float(np.ptp(rest.hands[:, 1]))
        apart[:, 1] = [0.5 * width, -0.5 * width]
    return np.where(asked[:, None], pick_up.object + apart, np.nan)


def _poses(
    robot: Robot, pick_up: PickUpParameters, rest: StandingFigures, goals: tuple[Array, ...]
) -> list[StaticPose]:
    """Postures at rest, above the object and at it; then, laden, at it, above it and at rest."""
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
