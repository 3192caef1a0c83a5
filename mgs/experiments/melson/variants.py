"""Variants of the Melson experiments, for `mgs experiment melson --sensitivity`.

Besides the settings of the article they change what the article does not state: durations of the
phases, height of the swing sole, the first support leg, and joint stops and masses of the robot.
"""

from __future__ import annotations

from mgs.experiments.variant import Variant

VARIANTS = (
    Variant("dt 20 ms", ("dt=0.02",)),
    Variant("dt 5 ms", ("dt=0.005",)),
    Variant("joint stops -20 %", stops=0.8),
    Variant("joint stops -10 %", stops=0.9),
    Variant("joint stops +20 %", stops=1.2),
    Variant("masses +20 %", masses=1.2),
    Variant("masses -20 %", masses=0.8),
    Variant("leg masses +20 %", leg_masses=1.2),
    Variant("leg masses -20 %", leg_masses=0.8),
    Variant("right support first", ("walk.first_support=right",)),
    Variant("gains +50 %", gains=1.5),
    Variant("gains -50 %", gains=0.5),
    Variant("step length +50 %", amplitude=1.5),
    Variant("step length -50 %", amplitude=0.5),
    Variant("speed +50 %", speed=1.5),
    Variant("speed -50 %", speed=0.5),
    Variant("step height 10 mm", ("walk.step_height=0.01",)),
    Variant("gamma_grav ramp 0.1 s", ("ik.gamma_grav_ramp=0.1",)),
    Variant("gamma_grav ramp 0.4 s", ("ik.gamma_grav_ramp=0.4",)),
)
