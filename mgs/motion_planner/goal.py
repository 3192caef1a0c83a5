"""Steps to a goal: along one arc, or turn, walk and turn, whichever takes fewer steps.

The arc is the motion of constant twist (v_x, v_y, omega) from the start to the goal. A sideways
step that is larger than the trailing foot may make towards the support foot is taken by the leading
foot alone, and the trailing foot follows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.core.geometry import compose_planar, wrap_angle
from mgs.core.limits import MAX_STEPS
from mgs.gait import GoalParameters

ROUNDING = 1e-9  # tolerance of a number of steps


@dataclass(frozen=True)
class StepLimits:
    """Largest step on the way to a goal."""

    length: float  # forward or backward [m]
    lateral: float  # sideways, leading foot [m]
    inward: float  # sideways, trailing foot towards the support foot [m]
    yaw: float  # turn [rad]


def way_to_goal(goal: GoalParameters, swing: Side, limits: StepLimits) -> list[Array]:
    """Centre pose x, y [m], yaw [rad] (3,) after each step except the closing one.

    Args:
        goal: the pose to reach.
        swing: side of the foot that takes the first step.
        limits: largest step.

    Raises:
        ConfigError: the goal takes more steps than a walk may have.
    """
    target = np.array([goal.x, goal.y, goal.yaw])
    ahead = math.atan2(goal.y, goal.x)
    distance = math.hypot(goal.x, goal.y)
    ways = [[_twist_to(target)]]
    for turn, sign in ((ahead, 1.0), (float(wrap_angle(ahead + math.pi)), -1.0)):
        final = float(wrap_angle(goal.yaw - turn))
        way = ([0.0, 0.0, turn], [sign * distance, 0.0, 0.0], [0.0, 0.0, final])
        ways.append([np.array(section) for section in way])
    fewest = min(sum(_n_steps(section, limits) for section in way) for way in ways)
    if fewest >= MAX_STEPS:
        raise ConfigError(
            "walk.goal",
            f"the goal is {fewest} or more steps away, {MAX_STEPS} allowed; use a nearer goal or "
            "a larger walk.step_length",
        )
    paths = [_centres(way, swing, limits) for way in ways]
    return min(paths, key=len)


def _centres(sections: list[Array], swing: Side, limits: StepLimits) -> list[Array]:
    """Centre pose (3,) after each step along sections of constant twist (3,)."""
    start, centres = np.zeros(3), list[Array]()
    for section in sections:
        n, in_pairs = _n_advances(section, limits)
        for i in range(1, n + 1):
            if in_pairs and swing.sign * section[1] < 0.0:  # the trailing foot only follows
                centres.append(centres[-1] if centres else np.zeros(3))
                swing = swing.other
            centres.append(compose_planar(start, along_twist(section, i / n)))
            swing = swing.other
        start = compose_planar(start, along_twist(section, 1.0))
    return centres


def _n_advances(section: Array, limits: StepLimits) -> tuple[int, bool]:
    """Number of steps that advance, and whether only the leading foot takes them."""
    straight = max(_parts(section[0], limits.length), _parts(section[2], limits.yaw))
    inward = max(straight, _parts(section[1], limits.inward))
    in_pairs = max(straight, _parts(section[1], limits.lateral))
    return (in_pairs, True) if 2 * in_pairs < inward else (inward, False)


def _n_steps(section: Array, limits: StepLimits) -> int:
    """Number of steps along a section, those of the following foot included."""
    n, in_pairs = _n_advances(section, limits)
    return 2 * n if in_pairs else n


def _parts(way: float, largest: float) -> int:
    """Number of equal parts into which a way is divided so that none exceeds the largest."""
    return math.ceil(min(abs(float(way)) / float(largest), MAX_STEPS) - ROUNDING)


def along_twist(twist: Array, part: float) -> Array:
    """Planar pose (3,) after a part of the time unit in which a constant twist (3,) acts."""
    x, y, turn = part * twist
    # (sin t / t, (1 - cos t) / t) for a turn t, in a form that is exact near zero
    along, across = np.sinc(turn / np.pi), 0.5 * turn * np.sinc(0.5 * turn / np.pi) ** 2
    return np.array([along * x - across * y, across * x + along * y, turn])


def _twist_to(pose: Array) -> Array:
    """Constant twist (3,) that leads to a planar pose (3,) in one time unit; |turn| < 2 pi."""
    x, y, turn = pose
    along, across = np.sinc(turn / np.pi), 0.5 * turn * np.sinc(0.5 * turn / np.pi) ** 2
    scale = along**2 + across**2
    return np.array([(along * x + across * y) / scale, (along * y - across * x) / scale, turn])
