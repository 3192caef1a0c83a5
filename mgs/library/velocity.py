"""Walks by their velocity: the steps that have it, and the velocity of steps.

The centre between the feet moves by one step forward, and with every second step by `lateral` to
the side too; each step turns by `step_yaw`, half of it before and half of it after:

    D = S(step_length, lateral) S(step_length, 0)
    S(x, y) = rot(step_yaw / 2) trans(x, y) rot(step_yaw / 2)

The velocity (vx, vy, wz) of the walk is the constant one, in the frame of the centre, that leads
to the same displacement D in the time 2 T of two steps, where T = single_support + double_support:

    D = exp(2 T (vx, vy, wz)), which is
    step_yaw = wz T, translation of D = 2 T V(2 step_yaw) (vx, vy)
    V(a) = [[sin a, cos a - 1], [1 - cos a, sin a]] / a

which is linear in step_length and lateral.
"""

from __future__ import annotations

import math

import numpy as np

from mgs.core.arrays import Array
from mgs.gait import WalkGait, WalkParameters

VELOCITIES = ("vx", "vy", "wz")  # keys of a sweep [m/s], [m/s], [rad/s]
STEPS = ("walk.step_length", "walk.lateral", "walk.step_yaw")  # what they become
DIGITS = 12  # of a velocity or a step, beyond which is rounding


def steps_of(velocity: Array, period: float) -> tuple[float, float, float]:
    """Step length [m], lateral [m] and yaw [rad] of a walk.

    Args:
        velocity: vx, vy [m/s] and wz [rad/s].
        period: of one step [s].
    """
    yaw = float(velocity[2]) * period
    moved = 2.0 * period * _mean_turn(2.0 * yaw) @ velocity[:2]
    length, lateral = np.linalg.solve(_columns(yaw), moved)
    return _rounded(length), _rounded(lateral), _rounded(yaw)


def velocity_of(walk: WalkParameters) -> tuple[float, float, float]:
    """Velocity vx, vy [m/s] and wz [rad/s] of the equal steps of a walk."""
    period = walk.single_support + walk.double_support
    moved = _columns(walk.step_yaw) @ [walk.step_length, walk.lateral]
    vx, vy = np.linalg.solve(_mean_turn(2.0 * walk.step_yaw), moved) / (2.0 * period)
    return _rounded(vx), _rounded(vy), _rounded(walk.step_yaw / period)


def has_velocity(gait: object) -> bool:
    """Whether a gait is a walk of equal steps whose sizes are given."""
    if not isinstance(gait, WalkGait):
        return False
    return gait.walk.n_steps is not None and gait.walk.sizes == "given"


def _columns(yaw: float) -> Array:
    """Translation (2, 2) of two steps by a unit of step length, and of lateral."""
    half = 0.5 * yaw
    length = [math.cos(half) + math.cos(3.0 * half), math.sin(half) + math.sin(3.0 * half)]
    return np.array([length, [-math.sin(half), math.cos(half)]]).T


def _mean_turn(angle: float) -> Array:
    """V(angle) (2, 2): mean of the rotations on the way to an angle [rad]."""
    if abs(angle) < 1e-6:
        return np.array([[1.0, -0.5 * angle], [0.5 * angle, 1.0]])
    s, c = math.sin(angle) / angle, (1.0 - math.cos(angle)) / angle
    return np.array([[s, -c], [c, s]])


def _rounded(value: float) -> float:
    return round(float(value), DIGITS) + 0.0  # no negative zero
