"""The one physical robot in a replay that differs from what it was built as (mgs.robot.unit).

Its joints turn by sign scale c + zero_offset when they are told to go to c, its servos have its own
stiffness, and their teeth leave half of the backlash to either side, in which they exert no torque.
Commands are what an export for this robot holds, or what they are for a robot without errors.
Ideal servos do not yield: of them only zero, sign and scale differ.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.short_repr import short_repr
from mgs.motion import Motion
from mgs.motion.commanded import commanded
from mgs.motion.sampled import sample
from mgs.robot import Servos
from mgs.robot.unit import Unit, servos_of_unit


@dataclass(frozen=True, eq=False)
class OneRobot:
    """Errors of the simulated robot, and whether its commands are corrected for them."""

    unit: Unit
    corrected: bool = True

    __repr__ = short_repr

    def with_errors(self, servos: Servos) -> Servos:
        """Servos of this robot."""
        there = servos_of_unit(servos, self.unit)
        return dataclasses.replace(there, deadband=there.deadband + 0.5 * self.unit.backlash)

    def arriving(self, motion: Motion, servos: Servos | None, yields: bool) -> Array:
        """Angles (N, n) [rad] to which its unloaded joints go, told to follow a motion.

        Args:
            motion: the plan.
            servos: servos whose yielding the commands compensate; None: no servos of a model.
            yields: whether its servos yield, so that a correction compensates their stiffness.
        """
        plan = sample(motion)
        assumed = None if servos is None else self._assumed(servos)
        unit = self.unit if yields else stiff(self.unit)
        told = commanded(plan, unit if self.corrected else None, assumed).joints
        return self.unit.unloaded(told)

    def _assumed(self, servos: Servos) -> Servos:
        """Servos that feed-forward commands are computed for."""
        return servos_of_unit(servos, self.unit) if self.corrected else servos


def stiff(unit: Unit) -> Unit:
    """The robot without what shows under load only."""
    none = np.zeros_like(unit.backlash)
    return dataclasses.replace(unit, backlash=none, compliance=none)
