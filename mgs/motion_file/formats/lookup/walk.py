"""One walk of a table: its cycle and the velocity that it is found by.

All cycles of a table begin with the first sample of single support on the left sole, so that the
same phase means the same in all of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mgs.core.contact import Support
from mgs.core.short_repr import short_repr
from mgs.motion import Motion
from mgs.motion.cycle import Cycle, find_cycle
from mgs.motion.sampled import SampledMotion, sample


@dataclass(frozen=True, eq=False)
class Walk:
    """A cycle that can be repeated, and its velocity."""

    velocity: tuple[float, float, float]  # forward, to the left [m/s], turning to the left [rad/s]
    sampled: SampledMotion  # closed: it ends with its first frame

    __repr__ = short_repr

    @property
    def n_frames(self) -> int:
        """Frames of a period, the first one counted once."""
        return self.sampled.n_frames - 1


def walk_of(motion: Motion, fps: float, digits: int) -> Walk:
    """Walk of a motion, with its velocity rounded.

    Args:
        motion: a walk of at least 5 equal steps.
        fps: frames per second [Hz], at which a period is a whole number of frames.
        digits: after the point, of the velocity.

    Raises:
        CycleError: the motion has no two steps that could be repeated.
        ConfigError: the rate does not fit the period.
    """
    cycle = find_cycle(motion, Support.LEFT)
    vx, vy, wz = (round(v, digits) + 0.0 for v in mean_velocity(cycle, motion.dt))
    return Walk((vx, vy, wz), sample(motion, fps, cycle, closed=True))


def mean_velocity(cycle: Cycle, dt: float) -> tuple[float, float, float]:
    """Steady velocity in the frame of the robot that has the displacement of a cycle.

    With the turn a of a period T, the displacement d and the half angle h = a / 2,

        v T = h / sin(h) R(-h) d
    """
    x, y, turn = cycle.displacement.tolist()
    period, h = cycle.n_samples * dt, 0.5 * turn
    longer = 1.0 / float(np.sinc(h / math.pi))
    c, s = math.cos(h), math.sin(h)
    return longer * (c * x + s * y) / period, longer * (c * y - s * x) / period, turn / period
