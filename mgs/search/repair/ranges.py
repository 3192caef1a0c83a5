"""Joints that are beyond their ranges: two readings of what was meant.

    clipped    the joint was meant to be at the end of its range
    bridged    all of its way out of the range and back is wrong: it is left out, and the joint is
               interpolated from what is around it, without overshooting

A way out and back lasts from where the joint sets out until it has come to rest again: while it
moves towards the excursion at a tenth or more of the highest speed on this way.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from mgs.core.arrays import Array
from mgs.core.spans import spans
from mgs.robot import Robot

CALM = 0.1  # of the highest speed on the way to the excursion


def clipped(robot: Robot, joints: Array) -> Array:
    """Joint angles (T, n) [rad] at the ends of their ranges where they are beyond."""
    return np.clip(joints, robot.lower, robot.upper)


def bridged(robot: Robot, joints: Array) -> Array:
    """Joint angles (T, n) [rad] interpolated where they are on a way out of their ranges."""
    filled = joints.copy()
    samples = np.arange(len(joints))
    for j in range(joints.shape[1]):
        missing = np.zeros(len(joints), dtype=bool)
        for sign, beyond in (
            (1.0, joints[:, j] > robot.upper[j]),
            (-1.0, joints[:, j] < robot.lower[j]),
        ):
            for start, end in spans(beyond):
                if beyond[start]:
                    missing[_way(sign * joints[:, j], start, end)] = True
        known = np.flatnonzero(~missing)
        if missing.any() and len(known) > 1:
            # held where nothing is known before or after
            inside = np.clip(samples, known[0], known[-1])
            filled[:, j] = PchipInterpolator(known, joints[known, j])(inside)
    return clipped(robot, filled)


def _way(values: Array, start: int, end: int) -> slice:
    """Samples on the way up to the excursion start <= k < end of values (T,), and down again."""
    first = _foot(values[: start + 1][::-1])
    last = _foot(values[end - 1 :])
    return slice(start - first, end + last)


def _foot(down: Array) -> int:
    """Number of steps that a way down takes until it comes to rest."""
    speed = -np.diff(down)
    steepest, n = 0.0, 0
    for step in speed:
        steepest = max(steepest, float(step))
        if step < CALM * steepest or step <= 0.0:
            break
        n += 1
    return n
