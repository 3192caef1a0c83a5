"""The product of stage 3."""

from __future__ import annotations

from dataclasses import dataclass

from mgs.core.arrays import Array
from mgs.core.short_repr import short_repr


@dataclass(frozen=True, eq=False)
class ComTrajectory:
    """Stage 3: motion of the centre of mass; world frame, first axis time."""

    position: Array  # (N, 3) [m]
    velocity: Array  # (N, 3) [m/s]
    acceleration: Array  # (N, 3) [m/s^2]
    zmp: Array  # (N, 2) of the cart-table model [m]

    __repr__ = short_repr
