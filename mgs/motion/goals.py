"""What servos are told along a motion, at any rate, for one physical robot if its unit is known.

Commanded angles compensate the yielding of the servos, with the stiffness of the physical robot
where it is known; its play, zeros, scales and signs go into either kind (mgs.motion.commanded).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from mgs.core.arrays import Array
from mgs.core.short_repr import short_repr
from mgs.motion.commanded import commanded
from mgs.motion.motion import Motion
from mgs.motion.sampled import sample
from mgs.robot.servos import is_modelled, servos_of
from mgs.robot.unit import Unit, servos_of_unit

GoalKind = Literal["commanded", "planned"]


@dataclass(frozen=True, eq=False)
class Goals:
    """Joint angles that servos are told."""

    kind: GoalKind  # what they are before corrections of the physical robot
    unit: str | None  # name of the physical robot that they are corrected for
    rate: float  # [Hz]
    position: Array  # (K, n) [rad]

    __repr__ = short_repr

    @property
    def times(self) -> Array:
        """Motion times (K,) of the goals [s]."""
        return np.arange(len(self.position), dtype=np.float64) / self.rate


def goals_along(
    motion: Motion,
    rate: float | None = None,
    kind: GoalKind | None = None,
    unit: Unit | None = None,
) -> Goals:
    """Joint goals along a motion.

    Args:
        motion: the plan.
        rate: goals per second [Hz]; None: that of the motion. The last goal is the last sample.
        kind: "commanded" or "planned"; None: commanded if robot.yaml describes the servos.
        unit: corrections of the physical robot; None: none.

    Raises:
        ConfigError: commanded angles are asked for and a servo in use has no stiffness.
    """
    if kind is None:
        kind = "commanded" if is_modelled(motion.robot) else "planned"
    servos = None
    if kind == "commanded":
        servos = servos_of(motion.robot)
        servos = servos if unit is None else servos_of_unit(servos, unit)
    plan = sample(motion, rate)
    return Goals(
        kind=kind,
        unit=None if unit is None else unit.name,
        rate=plan.fps,
        position=commanded(plan, unit, servos).joints,
    )
