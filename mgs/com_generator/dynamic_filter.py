"""The dynamic filter: what a CoM motion lacks, because a robot is more than one mass.

Second stage of Kajita et al., "Biped walking pattern generation by using preview control of
zero-moment point", ICRA 2003, section 4: the difference between the ZMP that was planned and the
one that the whole robot would have goes through the same preview controller, and its response is
added to the CoM. The loop around it, through inverse kinematics and dynamics, is the pipeline's.
The response begins before the error does and ends after it. Whatever of it would move at the first
and the last sample is brought to rest within the rests of the gait.
"""

from __future__ import annotations

import numpy as np

from mgs.com_generator.com_trajectory import ComTrajectory
from mgs.com_generator.generate import FOLLOWS_REFERENCE
from mgs.com_generator.preview import respond
from mgs.core.arrays import Array
from mgs.core.constants import GRAVITY
from mgs.core.geometry import quintic
from mgs.gait import ComParameters

REST_SHARE = 0.5  # of the rest at either end over which a correction sets in
STIFF = 1e-8  # R / Q_e that follows fast steps within 0.5 mm


def correct_com(
    com: ComTrajectory, zmp_ref: Array, error: Array, dt: float, parameters: ComParameters
) -> ComTrajectory:
    """The CoM motion plus the response of the preview control to a ZMP error.

    Args:
        com: the motion so far.
        zmp_ref: reference (N, 2) of the ZMP; it says how long the robot rests at either end.
        error: planned ZMP less that of the whole robot (N, 2) [m].
        dt: sampling period [s].
        parameters: tuning of the preview control; where the motion comes from another generator,
            stiff weights take the place of the generator's own.

    Raises:
        ConfigError: see `preview_gains`.
    """
    if parameters.generator != FOLLOWS_REFERENCE:
        parameters = parameters.model_copy(update={"weight_error": 1.0, "weight_jerk": STIFF})
    n_before = round(parameters.preview / dt)  # the control sees all that comes before it begins
    height = np.pad(com.position[:, 2], (n_before, 0), mode="edge")
    off = np.pad(rest_window(zmp_ref)[:, None] * error, ((n_before, 0), (0, 0)))
    response = respond(off, height, dt, parameters)
    place, speed, acceleration = (
        part[n_before:, :2]
        for part in (response.position, response.velocity, response.acceleration)
    )
    motion = [place, speed, acceleration]
    rests = _rests(zmp_ref)
    for end, rest in zip((0, -1), rests, strict=True):
        still = _standstill([part[end] for part in motion], end, dt * rest, dt, len(zmp_ref))
        motion = [part - less for part, less in zip(motion, still, strict=True)]
    zeros = np.zeros((len(zmp_ref), 1))
    place, speed, acceleration = (np.hstack([part, zeros]) for part in motion)
    lever = com.position[0, 2] / GRAVITY
    return ComTrajectory(
        position=com.position + place,
        velocity=com.velocity + speed,
        acceleration=com.acceleration + acceleration,
        zmp=com.zmp + (place - lever * acceleration)[:, :2],
    )


def _standstill(state: list[Array], end: int, rest: float, dt: float, n: int) -> list[Array]:
    """Position, speed and acceleration (n, 2) that bring a response to rest at one end.

    Less this polynomial of fifth degree the response, whose state (3 x 2) at the first (end = 0) or
    last (end = -1) sample is given, is at rest there, however short the rest [s] of the robot is.
    Where the rest is long, the response is at rest by itself and the polynomial is zero.
    """
    sign = 1.0 if end else -1.0  # of time, which runs backwards at the first sample
    x, v, a = state[0], sign * rest * state[1], rest**2 * state[2]  # in the unit `rest` of time
    cubic, quartic = 10.0 * x - 4.0 * v + 0.5 * a, -15.0 * x + 7.0 * v - a
    highest = 6.0 * x - 3.0 * v + 0.5 * a
    k = np.arange(n)[::-1] if end else np.arange(n)
    s = np.maximum(1.0 - dt * k[:, None] / rest, 0.0)
    place = s**3 * (cubic + s * (quartic + s * highest))
    speed = s**2 * (3.0 * cubic + s * (4.0 * quartic + 5.0 * s * highest))
    acceleration = s * (6.0 * cubic + s * (12.0 * quartic + 20.0 * s * highest))
    return [place, sign * speed / rest, acceleration / rest**2]


def _rests(zmp_ref: Array) -> tuple[int, int]:
    """Numbers of samples before and after the motion of the ZMP reference (N, 2), at least 1."""
    moving = np.flatnonzero(np.any(zmp_ref[1:] != zmp_ref[:-1], axis=1))
    first, last = (moving[0], moving[-1]) if len(moving) else (0, 0)
    return max(1, int(first)), max(1, len(zmp_ref) - 1 - int(last))


def rest_window(zmp_ref: Array) -> Array:
    """Factor (N,) of an error: 0 at both ends, 1 from halfway through the rests.

    The finite preview takes its input to be constant beyond both ends, and the differences taken
    there see the little that the CoM still moves as a jump. Without the factor every pass would
    magnify both, the ends' errors fivefold on Melson.
    """
    n = len(zmp_ref)
    moving = np.flatnonzero(np.any(zmp_ref[1:] != zmp_ref[:-1], axis=1))
    first, last = (moving[0] + 1, moving[-1]) if len(moving) else (n // 2, n // 2)
    k = np.arange(n)
    rests = np.minimum(k / max(1, first), (n - 1 - k) / max(1, n - 1 - last))
    return quintic(rests / REST_SHARE)
