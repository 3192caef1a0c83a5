"""Lengths and durations of a walk derived from the size of the robot.

Walks of robots of different size are alike if lengths are proportional to the leg length L and
durations to sqrt(L / g): their Froude numbers v^2 / (g L) are equal (R. McN. Alexander, "The gaits
of bipedal and quadrupedal animals", Int. J. Robotics Research 3(2), 1984). The factors below give a
slow walk with a Froude number of 0.0002. On servos that give way a robot sways on one leg; with the
times of single support that were tried, longer ones let more robots stay up (docs/robots.md). Where
the sway gets near the edge of the sole (`mgs.motion_planner.sway`) it takes twice the time: the
foot leaves the ground more slowly and the sway fades. The swing foot also hangs lower than planned
when servos give way. It is lifted higher than stiff servos would need, and it comes straight down,
since a foot that meets the ground while it still moves forward shortens the step; it is lifted less
where the robot sways or steps quickly, since lifting a foot pushes the robot to the side.
"""

from __future__ import annotations

import math
from typing import Any

from mgs.core.config import build
from mgs.core.constants import GRAVITY
from mgs.gait import (
    BalanceGait,
    ComParameters,
    KeyframesGait,
    KickGait,
    PickUpGait,
    SingleGait,
    WalkGait,
    WalkParameters,
)
from mgs.motion_planner.scaled_standing import (
    scaled_balance,
    scaled_keyframes,
    scaled_kick,
    scaled_pick_up,
)
from mgs.motion_planner.sway import swing_of_zmp
from mgs.robot import Robot, leg_length
from mgs.robot.legs import missing_turn

STEP_LENGTH, STEP_HEIGHT, ZMP_TOLERANCE = 0.12, 0.05, 5e-4  # in leg lengths
SINGLE_SUPPORT, DOUBLE_SUPPORT = 5.0, 2.9  # in sqrt(L / g)
LANDING = 0.25  # share of single support in which the foot comes straight down
SWAYING_SINGLE_SUPPORT = 10.0  # of robots whose sway may tip the sole
LOW_STEP_HEIGHT, LOW_LANDING = 0.04, 0.2  # of these, and of robots that only sway their trunk
SWAY_LIMIT = 0.9  # half widths of the sole: below 1, since no servo is as stiff as its figures say
QUICK_SINGLE_SUPPORT, QUICK_DOUBLE_SUPPORT = 1.2, 0.5  # of robots that only sway their trunk
QUICK_PASSES = 8  # passes of the dynamic filter for such robots
REST = 3.0  # [s] before and after the steps; with less, hips exceed their RMS torque on some robots
RELATIVE = frozenset({"step_length", "lateral", "step_height"})  # `sizes: relative` scales them
SIZED = "walk gait, sized by the robot"  # for messages
DIGITS = 4  # decimal places of derived values


def for_robot(gait: SingleGait, robot: Robot) -> SingleGait:
    """The gait in metres, seconds and joint angles of the robot; unchanged with `sizes: given`.

    Raises:
        ConfigError: the robot lacks a joint or a hand that the gait names.
    """
    if isinstance(gait, WalkGait) and gait.walk.sizes != "given":
        return _scaled_walk(gait, robot)
    if isinstance(gait, KeyframesGait) and gait.keyframes.sizes == "relative":
        return scaled_keyframes(gait, robot)
    if isinstance(gait, BalanceGait) and gait.balance.sizes == "relative":
        return scaled_balance(gait, robot)
    if isinstance(gait, KickGait) and gait.kick.sizes == "relative":
        return scaled_kick(gait, robot)
    if isinstance(gait, PickUpGait) and gait.pick_up.sizes == "relative":
        return scaled_pick_up(gait, robot)
    return gait


def _scaled_walk(gait: WalkGait, robot: Robot) -> WalkGait:
    """Values that the gait file states stay; the others are derived from leg length and soles."""
    stated = _stated(gait.walk)
    if gait.walk.sizes == "relative":
        for name in RELATIVE & stated.keys():
            stated[name] = round(stated[name] * leg_length(robot), DIGITS)
    walk = {**_walk_sizes(gait, robot), **stated, "sizes": "given"}
    com = {**_com_sizes(robot), **_stated(gait.com)}
    return build(WalkGait, gait.model_dump() | {"walk": walk, "com": com}, SIZED)


def _walk_sizes(gait: WalkGait, robot: Robot) -> dict[str, Any]:
    """Derived values of the block `walk`."""
    length = leg_length(robot)
    time = math.sqrt(length / GRAVITY)
    quick = missing_turn(robot) == "roll"
    sways = swing_of_zmp(robot) > SWAY_LIMIT
    low = sways or quick
    single, double = SINGLE_SUPPORT, DOUBLE_SUPPORT
    if quick:
        single, double = QUICK_SINGLE_SUPPORT, QUICK_DOUBLE_SUPPORT
    elif sways:
        single = SWAYING_SINGLE_SUPPORT
    return {
        "step_length": round(STEP_LENGTH * length, DIGITS) if gait.walk.n_steps != 1 else 0.0,
        "step_height": round((LOW_STEP_HEIGHT if low else STEP_HEIGHT) * length, DIGITS),
        "landing": LOW_LANDING if low else LANDING,
        "single_support": _whole(single * time, gait.dt),
        "double_support": _whole(double * time, gait.dt),
        "lead_in": REST,
        "lead_out": REST,
    }


def _com_sizes(robot: Robot) -> dict[str, Any]:
    """Derived values of the block `com`."""
    default = ComParameters.model_fields["passes"].default
    return {
        "passes": QUICK_PASSES if missing_turn(robot) == "roll" else default,
        "zmp_tolerance": round(ZMP_TOLERANCE * leg_length(robot), 6),
    }


def _stated(block: WalkParameters | ComParameters) -> dict[str, Any]:
    """Values that the gait file states."""
    return {key: getattr(block, key) for key in block.model_fields_set}


def _whole(duration: float, dt: float) -> float:
    """The nearest duration that is a whole number of samples [s]."""
    return round(round(duration / dt) * dt, 6)
