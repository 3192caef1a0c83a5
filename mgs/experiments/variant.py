"""Variant of an experiment: the same runs with one setting changed."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import pinocchio as pin

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side
from mgs.robot import Robot


@dataclass(frozen=True)
class Variant:
    """What differs from the settings of the experiment.

    Attributes:
        name: text in tables, such as "dt 5 ms".
        settings: KEY=VALUE settings of the gait, put after those of the experiment.
        masses: factor on the masses and inertias of all links.
        leg_masses: factor on those of the links of the legs, in addition.
        stops: factor on the stops of all joints; a stop at zero, such as that of a straight knee,
            remains.
        amplitude: factor on the amplitude of the motion, or on the length of its steps.
        speed: factor on the speed of the motion.
        gains: factor on the gains of null-space motions.
    """

    name: str
    settings: tuple[str, ...] = ()
    masses: float = 1.0
    leg_masses: float = 1.0
    stops: float = 1.0
    amplitude: float = 1.0
    speed: float = 1.0
    gains: float = 1.0

    def robot(self, robot: Robot) -> Robot:
        """Robot with the masses and joint stops of this variant."""
        if self.masses == self.leg_masses == self.stops == 1.0:
            return robot
        model = robot.model.copy()
        legs = {n for side in Side for n in robot.spec.groups.get(f"{side.label}_leg", ())}
        for i, name in enumerate(model.names[1:], start=1):
            factor = self.masses * (self.leg_masses if name in legs else 1.0)
            link = model.inertias[i]
            model.inertias[i] = pin.Inertia(factor * link.mass, link.lever, factor * link.inertia)
        lower, upper = self.stops * robot.lower, self.stops * robot.upper
        model.lowerPositionLimit[FLOATING_BASE_NQ:] = lower
        model.upperPositionLimit[FLOATING_BASE_NQ:] = upper
        return dataclasses.replace(robot, model=model, lower=lower, upper=upper)


BASE = Variant("as shipped")
