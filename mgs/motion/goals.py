"""What servos are told along a motion, at any rate, for one physical robot if its unit is known.

    goal = command for (position, torque) by the law of the physical robot (mgs.robot.unit)
    position = commanded joint angle (mgs.motion.servo_commands) or planned joint angle

The commanded angle holds the droop already; its stiffness is then that of the physical robot, where
known, and the law of the physical robot adds play, zero, scale and sign alone. Rates other than
that of the motion are met by cubic splines through its samples (mgs.core.spline).
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.short_repr import short_repr
from mgs.core.spline import evaluate, spline_at_rest
from mgs.motion.motion import Motion
from mgs.motion.servo_commands import servo_commands
from mgs.robot.servos import is_modelled, servos_of
from mgs.robot.unit import Unit

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
    position = _goals(motion, kind, unit)
    return Goals(
        kind=kind,
        unit=None if unit is None else unit.name,
        rate=1.0 / motion.dt if rate is None else rate,
        position=position if rate is None else at_rate(position, motion.dt, rate),
    )


def at_rate(values: Array, dt: float, rate: float) -> Array:
    """Values (K, n) at k / rate, K = 1 + ceil(duration rate), from values (N, n) at k dt.

    A time past the end has the last value, so that a motion ends where it should.
    """
    duration = (len(values) - 1) * dt
    times = np.arange(1 + int(np.ceil(duration * rate - 1e-9)), dtype=np.float64) / rate
    return evaluate(spline_at_rest(values, dt), np.minimum(times, duration))[0]


def _goals(motion: Motion, kind: GoalKind, unit: Unit | None) -> Array:
    """Goals (N, n) at the samples of the motion."""
    if kind == "planned":
        position = motion.q[:, FLOATING_BASE_NQ:]
        return position if unit is None else unit.command_for(position, motion.torque)
    servos = servos_of(motion.robot)
    if unit is None:
        return servo_commands(motion, servos=servos).position
    known = unit.compliance > 0.0
    stiffness = np.where(known, 1.0 / np.where(known, unit.compliance, 1.0), servos.stiffness)
    servos = dataclasses.replace(servos, stiffness=stiffness)
    position = servo_commands(motion, servos=servos).position
    rest = dataclasses.replace(unit, compliance=np.zeros_like(unit.compliance))
    return rest.command_for(position, motion.torque)
