"""Friction of a gear that grows with the torques on both of its sides.

The law M6 of Duclusaud, Passault, Padois and Ly (ICRA 2025, cited in `mgs.robot.identified`): dry
friction can take up any torque up to a bound, and brakes a joint that moves by as much. With the
torque of the motor, the external torque at the joint (gravity, contacts, other joints) and
s = exp(-(|v| / stribeck_speed)^stribeck_exponent), the bound is

    base + |external_coefficient external - motor_coefficient motor|
    + s (stribeck + |external_stribeck external - motor_stribeck motor| + quadratic)
    + viscous |v|

where quadratic is 0 if both torques have the same sign, else external_quadratic external^2 if the
motor torque is the larger one, else motor_quadratic motor^2.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.robot.identified import FrictionParameters

N_PASSES = 8  # the motor torque that overcomes friction; each pass leaves at most half of the error


@dataclass(frozen=True, eq=False)
class LoadFriction:
    """Parameters (n,) of the friction law at n joints, with the names of `FrictionParameters`."""

    base: Array
    stribeck: Array
    motor: Array
    external: Array
    motor_stribeck: Array
    external_stribeck: Array
    motor_quadratic: Array
    external_quadratic: Array
    stribeck_speed: Array
    stribeck_exponent: Array
    viscous: Array

    def bound(self, v: Array, motor: Array, external: Array) -> Array:
        """Largest torque (..., n) [N m] that friction can take up.

        Args:
            v: joint velocities (..., n) [rad/s].
            motor: torques (..., n) of the motors [N m].
            external: all other torques (..., n) at the joints [N m].
        """
        s = np.exp(-((np.abs(v) / self.stribeck_speed) ** self.stribeck_exponent))
        by_load = np.abs(self.external * external - self.motor * motor)
        by_load_at_rest = np.abs(self.external_stribeck * external - self.motor_stribeck * motor)
        smaller = np.where(
            np.abs(external) < np.abs(motor),
            self.external_quadratic * external**2,
            self.motor_quadratic * motor**2,
        )
        quadratic = np.where(external * motor < 0.0, smaller, 0.0)
        at_rest = self.stribeck + by_load_at_rest + quadratic
        return np.asarray(self.base + by_load + s * at_rest + self.viscous * np.abs(v))

    def to_overcome(self, v: Array, torque: Array) -> Array:
        """Friction (..., n) [N m] at joints that move at v [rad/s] and give a torque [N m]."""
        bound = np.zeros_like(torque)
        for _ in range(N_PASSES):
            bound = self.bound(v, torque + np.sign(v) * bound, -torque)
        return bound


def load_friction(parameters: Sequence[FrictionParameters]) -> LoadFriction:
    """Parameters of the friction law at several joints."""
    names = [field.name for field in dataclasses.fields(LoadFriction)]
    return LoadFriction(**{n: np.array([getattr(p, n) for p in parameters]) for n in names})
