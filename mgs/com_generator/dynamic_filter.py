"""The dynamic filter: what a CoM motion lacks, because a robot is more than one mass.

Second stage of Kajita et al., "Biped walking pattern generation by using preview control of
zero-moment point", ICRA 2003, section 4: the difference between the ZMP that was planned and the
one that the whole robot would have goes through the same preview controller, and its response is
added to the CoM. The loop around it, through inverse kinematics and dynamics, is the pipeline's.
Whatever of the response still moves at the end is brought to rest within the rest of the gait.
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
    response = respond(rest_window(zmp_ref)[:, None] * error, com.position[:, 2], dt, parameters)
    ends = _end_state(response, dt * _rest_at_end(zmp_ref), dt)
    place, speed, acceleration = (part[:, :2] for part in _parts(response))
    lever = com.position[0, 2] / GRAVITY
    zeros = np.zeros((len(zmp_ref), 1))
    return ComTrajectory(
        position=com.position + np.hstack([place - ends[0], zeros]),
        velocity=com.velocity + np.hstack([speed - ends[1], zeros]),
        acceleration=com.acceleration + np.hstack([acceleration - ends[2], zeros]),
        zmp=com.zmp + response.zmp - (ends[0] - lever * ends[2]),
    )


def _parts(com: ComTrajectory) -> tuple[Array, Array, Array]:
    return com.position, com.velocity, com.acceleration


def _end_state(response: ComTrajectory, rest: float, dt: float) -> tuple[Array, Array, Array]:
    """Position, speed and acceleration (N, 2) of what is still moving at the end of a response.

    It is the polynomial of fifth degree that is at rest until the robot rests and has the state of
    the response at the last sample. Less this polynomial the response ends at rest, however short
    the rest is; in a long one the preview control has come to rest, and the polynomial is zero.
    """
    x, v, a = (part[-1, :2] for part in _parts(response))
    v, a = rest * v, rest**2 * a  # in the unit `rest` of time
    cubic, quartic, quintic = (
        10.0 * x - 4.0 * v + 0.5 * a, -15.0 * x + 7.0 * v - a, 6.0 * x - 3.0 * v + 0.5 * a
    )  # fmt: skip
    n = len(response.position)
    s = np.maximum(1.0 - dt * np.arange(n)[::-1, None] / rest, 0.0)
    place = s**3 * (cubic + s * (quartic + s * quintic))
    speed = s**2 * (3.0 * cubic + s * (4.0 * quartic + 5.0 * s * quintic))
    acceleration = s * (6.0 * cubic + s * (12.0 * quartic + 20.0 * s * quintic))
    return place, speed / rest, acceleration / rest**2


def _rest_at_end(zmp_ref: Array) -> int:
    """Number of samples after the last motion of the ZMP reference (N, 2), at least 1."""
    moving = np.flatnonzero(np.any(zmp_ref[1:] != zmp_ref[:-1], axis=1))
    return max(1, len(zmp_ref) - 1 - (int(moving[-1]) if len(moving) else 0))


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
