"""Torques of the most stretched and the most crouched runs as physics engines measure them."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

from mgs.experiments.crouch.runs import COMAN, JUDGED, MotionName, Sweep, squared_torques
from mgs.sim import EngineName, ServoName, available_engines, replay

REPLAYED: tuple[MotionName, ...] = ("sway", "walk")
SERVOS: tuple[ServoName, ...] = ("ideal", "pd")


@dataclass(frozen=True)
class Measured:
    """Mean sums of the squared torques [(N m)^2] on stretched and on crouched legs."""

    motion: MotionName
    engine: EngineName
    servo: ServoName
    planned: tuple[float, float]  # by inverse dynamics, over the whole motion
    measured: tuple[float, float]
    fell: bool  # whether the robot falls in one of the two

    @property
    def planned_ratio(self) -> float:
        """Crouched over stretched, by inverse dynamics."""
        return self.planned[1] / self.planned[0]

    @property
    def ratio(self) -> float:
        """Crouched over stretched, measured."""
        return self.measured[1] / self.measured[0]


def measure(sweeps: Mapping[tuple[str, MotionName, str], Sweep]) -> tuple[Measured, ...]:
    """Replay both ends of two sweeps of COMAN in every engine that is installed."""
    found = []
    for name in REPLAYED:
        made = sweeps[COMAN, name, JUDGED].made
        if len(made) < 2:
            continue
        ends = made[0].motion, made[-1].motion
        planned = [float(squared_torques(motion).sum(axis=1).mean()) for motion in ends]
        for engine, servo in itertools.product(available_engines(), SERVOS):
            replays = [replay(motion, engine, servo=servo) for motion in ends]
            sums = [sum(rms**2 for rms in one.torque_rms.values()) for one in replays]
            fell = any(one.fell for one in replays)
            both = (planned[0], planned[1]), (sums[0], sums[1])
            found.append(Measured(name, engine, servo, *both, fell))
    return tuple(found)
