"""Mechanical energy of a motion, from its planned joint torques and speeds.

    work   = integral of sum_j max(tau_j v_j, 0) dt        servos do not feed brake energy back
    effort = integral of sum_j tau_j^2 dt                  in proportion to the heat of DC motors
    cost of transport = work / (m g d)                     d: way of the midpoint between the soles

The cost of transport compares robots of any size (V. A. Tucker, "The energetic cost of moving
about", American Scientist 63(4), 1975); people walk at about 0.05 in mechanical terms (S. Collins
et al., "Efficient bipedal robots based on passive-dynamic walkers", Science 307, 2005).
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV, GRAVITY
from mgs.motion.motion import Motion

LEAST_WAY = 0.01  # [m] below which a motion has no cost of transport


@dataclass(frozen=True)
class Energy:
    """Energy of a whole motion."""

    positive_work: float  # [J]
    torque_squared: float  # integral of the squared torques of all joints [N^2 m^2 s]
    cost_of_transport: float | None  # None: the robot does not travel

    def to_dict(self) -> dict[str, float | None]:
        """Convert to plain data."""
        return asdict(self)


def energy_of(motion: Motion) -> Energy | None:
    """Energy of a motion; None for motions without balance, whose torques are not known."""
    if not motion.gait.is_balanced:
        return None
    work = float(positive_power(motion).sum() * motion.dt)
    squared = float(np.square(motion.torque).sum() * motion.dt)
    way = way_of_soles(motion.soles)
    weight = GRAVITY * motion.robot.mass
    cost = None if way < LEAST_WAY else work / (weight * way)
    return Energy(work, squared, cost)


def positive_power(motion: Motion) -> Array:
    """Sum (N,) over all joints of the power that they give, not of what they take up [W]."""
    power = motion.torque * motion.v[:, FLOATING_BASE_NV:]
    return np.asarray(np.maximum(power, 0.0).sum(axis=1))


def way_of_soles(soles: Array) -> float:
    """Length of the horizontal path of the midpoint between soles (N, 2, 7) [m]."""
    middle = soles[:, :, :2].mean(axis=1)
    return float(np.linalg.norm(np.diff(middle, axis=0), axis=1).sum())
