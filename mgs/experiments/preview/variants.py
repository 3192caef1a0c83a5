"""Variants of the preview control study, for `mgs experiment preview --sensitivity`.

Settings are fields of the cart-table example; masses, amplitude and speed also change the walks.
"""

from __future__ import annotations

from mgs.experiments.variant import Variant

VARIANTS = (
    Variant("dt 10 ms", ("dt=0.01",)),
    Variant("dt 2 ms", ("dt=0.002",)),
    Variant("CoM height +20 %", ("com_height=0.977",)),
    Variant("CoM height -20 %", ("com_height=0.651",)),
    Variant("weight_jerk 1e-5", ("weight_jerk=1e-5",)),
    Variant("weight_jerk 1e-7", ("weight_jerk=1e-7",)),
    Variant("masses +20 %", masses=1.2),
    Variant("masses -20 %", masses=0.8),
    Variant("leg masses +20 %", leg_masses=1.2),
    Variant("leg masses -20 %", leg_masses=0.8),
    Variant("amplitude +50 %", amplitude=1.5),
    Variant("amplitude -50 %", amplitude=0.5),
    Variant("speed +50 %", speed=1.5),
    Variant("speed -50 %", speed=0.5),
)
