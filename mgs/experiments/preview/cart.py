"""The example of Kajita et al.: a cart-table whose ZMP follows steps, with two preview windows."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from mgs.com_generator.preview import respond
from mgs.core.arrays import Array
from mgs.experiments.preview.servo import Servo
from mgs.experiments.variant import Variant
from mgs.gait import ComParameters

REST = 3.0  # [s] before the first step and after the last one
N_STEPS = 4


@dataclass(frozen=True)
class Cart:
    """Settings of the example; sizes of the steps and their duration are ours."""

    dt: float = 0.005  # [s]
    com_height: float = 0.814  # [m]
    weight_jerk: float = 1e-6
    preview: float = 1.6  # [s]
    step_length: float = 0.3  # [m]
    step_width: float = 0.2  # [m]
    step_time: float = 0.8  # [s]

    @property
    def servo(self) -> Servo:
        """Preview servo of the cart-table."""
        parameters = ComParameters(preview=self.preview, weight_jerk=self.weight_jerk)
        return Servo(self.dt, self.com_height, parameters)

    def changed(self, variant: Variant) -> Cart:
        """Cart of a variant, whose settings are values of fields of this class."""
        pairs = (text.split("=") for text in variant.settings)
        cart = dataclasses.replace(self, **{key: float(value) for key, value in pairs})
        return dataclasses.replace(
            cart,
            step_length=cart.step_length * variant.amplitude,
            step_width=cart.step_width * variant.amplitude,
            step_time=cart.step_time / variant.speed,
        )

    def reference(self) -> Array:
        """ZMP reference (N, 2) [m] that jumps from footprint to footprint."""
        places = [[0.0, 0.0]]
        for k in range(N_STEPS):
            places.append([k * self.step_length, 0.5 * self.step_width * (-1.0) ** k])
        places.append([(N_STEPS - 1) * self.step_length, 0.0])
        counts = [round(REST / self.dt)] + N_STEPS * [round(self.step_time / self.dt)]
        return np.repeat(places, [*counts, counts[0]], axis=0)

    def follow(self) -> tuple[Array, Array]:
        """ZMP (N, 2) and CoM (N, 2) [m] of the cart-table under preview control."""
        reference = self.reference()
        height = np.full(len(reference), self.com_height)
        com = respond(reference, height, self.dt, self.servo.parameters)
        return com.zmp, com.position[:, :2]

    def errors(self) -> Array:
        """RMS error (2,) of the ZMP along x and y, relative to step length and step width.

        The window reaches from one step time before the first footprint to one after the last one.
        """
        gap = (self.follow()[0] - self.reference())[self.window()]
        rms = np.sqrt(np.mean(gap**2, axis=0))
        return np.asarray(rms / [self.step_length, self.step_width])

    def overshoot(self) -> float:
        """Distance of the ZMP beyond the range of its reference, relative to the step length."""
        zmp, reference = self.follow()[0], self.reference()
        beyond = np.maximum(zmp - reference.max(axis=0), reference.min(axis=0) - zmp)
        return float((beyond / [self.step_length, self.step_width]).max())

    def window(self) -> slice:
        """Samples in which the cart walks."""
        step, rest = round(self.step_time / self.dt), round(REST / self.dt)
        return slice(rest - step, rest + (N_STEPS + 1) * step)
