"""A way to a pose: equal steps along an arc, or turn, walk and turn, whichever takes fewer steps.

The arc is the motion of constant twist (v_x, v_y, omega) that leads from here to there. A step
sideways beyond what the trailing foot may close in is taken by the leading foot alone, and the
other one follows it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.core.geometry import compose_planar, wrap_angle
from mgs.gait import GoalParameters
from mgs.gait.walk import MAX_STEPS

ROUNDING = 1e-9  # of a number of steps


@dataclass(frozen=True)
class StepLimits:
    """The largest step."""

    length: float  # [m]
    lateral: float  # of the leading foot [m]
    inward: float  # of the trailing foot, towards the support foot [m]
    yaw: float  # [rad]


def way_to_goal(goal: GoalParameters, swing: Side, limits: StepLimits) -> list[Array]:
    """Centre (3,) after each step but the closing one; `swing` is the side of the first.

    Raises:
        ConfigError: more steps than a walk may have.
    """
    target = np.array([goal.x, goal.y, goal.yaw])
    ahead = math.atan2(goal.y, goal.x)
    distance = math.hypot(goal.x, goal.y)
    ways = [[_twist_to(target)]]
    for turn, sign in ((ahead, 1.0), (float(wrap_angle(ahead + math.pi)), -1.0)):
        final = float(wrap_angle(goal.yaw - turn))
        ways.append(
            [np.array(leg) for leg in ([0, 0, turn], [sign * distance, 0, 0], [0, 0, final])]
        )
    fewest = min(sum(_n_steps(leg, limits) for leg in way) for way in ways)
    if fewest >= MAX_STEPS:
        raise ConfigError(
            "walk.goal",
            f"{fewest} steps away, {MAX_STEPS} allowed; use a nearer goal or a larger "
            "walk.step_length",
        )
    paths = [_centres(way, swing, limits) for way in ways]
    return min(paths, key=len)


def _centres(legs: list[Array], swing: Side, limits: StepLimits) -> list[Array]:
    """Centre (3,) after each step along legs of constant twist (3,)."""
    start, centres = np.zeros(3), list[Array]()
    for leg in legs:
        n, in_pairs = _n_advances(leg, limits)
        for i in range(1, n + 1):
            if in_pairs and swing.sign * leg[1] < 0.0:  # the trailing foot follows, or waits
                centres.append(centres[-1] if centres else np.zeros(3))
                swing = swing.other
            centres.append(compose_planar(start, along_twist(leg, i / n)))
            swing = swing.other
        start = compose_planar(start, along_twist(leg, 1.0))
    return centres


def _n_advances(leg: Array, limits: StepLimits) -> tuple[int, bool]:
    """Number of steps that advance, and whether only the leading foot does."""
    straight = max(_parts(leg[0], limits.length), _parts(leg[2], limits.yaw))
    inward = max(straight, _parts(leg[1], limits.inward))
    in_pairs = max(straight, _parts(leg[1], limits.lateral))
    return (in_pairs, True) if 2 * in_pairs < inward else (inward, False)


def _n_steps(leg: Array, limits: StepLimits) -> int:
    n, in_pairs = _n_advances(leg, limits)
    return 2 * n if in_pairs else n


def _parts(way: float, largest: float) -> int:
    """Number of parts of a way that are no larger than allowed."""
    return math.ceil(abs(way) / largest - ROUNDING)


def along_twist(twist: Array, part: float) -> Array:
    """Planar pose (3,) after a part of the time at constant twist (3,) for one unit of it."""
    x, y, turn = part * twist
    # (sin t / t, (1 - cos t) / t), exact near zero
    along, across = np.sinc(turn / np.pi), 0.5 * turn * np.sinc(0.5 * turn / np.pi) ** 2
    return np.array([along * x - across * y, across * x + along * y, turn])


def _twist_to(pose: Array) -> Array:
    """Twist (3,) that leads to a planar pose (3,) in one unit of time; |turn| < 2 pi."""
    x, y, turn = pose
    along, across = np.sinc(turn / np.pi), 0.5 * turn * np.sinc(0.5 * turn / np.pi) ** 2
    scale = along**2 + across**2
    return np.array([(along * x + across * y) / scale, (along * y - across * x) / scale, turn])
