"""The dynamic filter: what a CoM motion lacks, because a robot is more than one mass.

Second stage of Kajita et al., "Biped walking pattern generation by using preview control of
zero-moment point", ICRA 2003, section 4: the difference between the ZMP that was planned and the
one that the whole robot would have goes through the same preview controller, and its response is
added to the CoM. The loop around it, through inverse kinematics and dynamics, is the pipeline's.
"""

from __future__ import annotations

import numpy as np

from mgs.com_generator.com_trajectory import ComTrajectory
from mgs.com_generator.generate import FOLLOWS_REFERENCE
from mgs.com_generator.preview import require_rest, respond
from mgs.core.arrays import Array
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
        InfeasibleGaitError: the corrected CoM is not at rest when the motion ends.
    """
    if parameters.generator != FOLLOWS_REFERENCE:
        parameters = parameters.model_copy(update={"weight_error": 1.0, "weight_jerk": STIFF})
    response = respond(rest_window(zmp_ref)[:, None] * error, com.position[:, 2], dt, parameters)
    position = com.position.copy()
    position[:, :2] += response.position[:, :2]
    corrected = ComTrajectory(
        position=position,
        velocity=com.velocity + response.velocity * [1.0, 1.0, 0.0],
        acceleration=com.acceleration + response.acceleration * [1.0, 1.0, 0.0],
        zmp=com.zmp + response.zmp,
    )
    require_rest(corrected, zmp_ref[-1])
    return corrected


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
