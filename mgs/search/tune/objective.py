"""What is wanted of a walk, as one number that is the larger the better.

A walk that fails is scored by how far it came through the stages of its evaluation, always below
every walk that passes, so that the search is drawn towards walks that pass:

    planning fails        -4
    static checks         -4 to -3   the less the limits are exceeded, the higher
    replays in MuJoCo     -3 to -2   the more replays pass and the later the robot falls
    random conditions     -2 to -1   the more are survived, the higher
    replays in all        -1 to 0
    passes                above 0, in the unit of the objective
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, get_args

import numpy as np

from mgs.core.constants import GRAVITY
from mgs.core.contact import Side, Support
from mgs.core.spans import spans
from mgs.motion import Motion
from mgs.motion.energy import energy_of, way_of_soles
from mgs.robot import Robot, leg_length
from mgs.robot.support_polygon import corners_of_soles

ObjectiveName = Literal["robust", "speed", "energy", "torque"]
OBJECTIVES: tuple[ObjectiveName, ...] = get_args(ObjectiveName)
LEAST_CLEARANCE = 0.04  # height of the swing sole at its highest, as part of the leg length
UNITS = {
    "robust": "least survival rate of all columns",
    "speed": "m/s",
    "energy": "weight times way per joule of positive work",
    "torque": "1 / RMS torque [1/(N m)]",
}


def foot_clearance(motion: Motion) -> float:
    """Least of the heights that the swing soles reach in their swings [m]; infinite: no swing.

    The height of a sole that is not level is that of its lowest corner.
    """
    lowest = corners_of_soles(motion.robot, motion.soles)[..., 2].min(axis=-1)  # (N, 2)
    least = np.inf
    for side in Side:
        swings = motion.support == Support.single(side.other)
        for start, end in spans(swings):
            if swings[start]:
                feet = lowest[start:end, side]
                low = max(feet[0], feet[-1])
                least = min(least, float(feet.max() - low))
    return least


def least_clearance(robot: Robot) -> float:
    """Height that every swing sole has to reach [m]."""
    return LEAST_CLEARANCE * leg_length(robot)


def mean_speed(motion: Motion) -> float:
    """Speed of the steady walk [m/s].

    It is the way of the midpoint between the soles divided by the duration of all steps but one,
    since the first step and the closing step advance by half a step each.
    """
    single = motion.support != Support.DOUBLE
    starts = np.flatnonzero(np.diff(single.astype(np.int8)) == 1)
    if len(starts) < 2:
        return 0.0
    return way_of_soles(motion.soles) / float((starts[-1] - starts[0]) * motion.dt)


def plan_figures(motion: Motion) -> dict[str, float]:
    """Figures of a plan that objectives depend on."""
    energy = energy_of(motion)
    assert energy is not None  # a walk is balanced
    rms = float(np.sqrt(energy.torque_squared / max(motion.duration, motion.dt)))
    return {
        "speed": mean_speed(motion),
        "clearance": foot_clearance(motion),
        "positive_work": energy.positive_work,
        "cost_of_transport": energy.cost_of_transport or np.inf,
        "torque_rms": rms,
    }


def known_score(objective: ObjectiveName, figures: Mapping[str, float]) -> float | None:
    """Score of a plan, should it pass everything; None: it is known after all replays."""
    if objective == "speed":
        return figures["speed"]
    if objective == "energy":
        return 1.0 / figures["cost_of_transport"]
    if objective == "torque":
        return 1.0 / figures["torque_rms"]
    return None


def froude_number(speed: float, leg: float) -> float:
    """Froude number v^2 / (g l) of a speed [m/s] with the leg length [m]."""
    return speed**2 / (GRAVITY * leg)
