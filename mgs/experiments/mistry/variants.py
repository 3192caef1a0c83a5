"""Variants of the experiments of Mistry et al., for `mgs experiment mistry --sensitivity`."""

from __future__ import annotations

from mgs.experiments.variant import Variant

VARIANTS = (
    Variant("dt 5 ms", ("dt=0.005",)),
    Variant("dt 20 ms", ("dt=0.02",)),
    Variant("feedback 0.25", ("ik.prioritized.feedback=0.25",)),
    Variant("feedback 1", ("ik.prioritized.feedback=1.0",)),
    Variant("amplitude +50 %", amplitude=1.5),
    Variant("amplitude -50 %", amplitude=0.5),
    Variant("speed +50 %", speed=1.5),
    Variant("speed -50 %", speed=0.5),
    Variant("masses +20 %", masses=1.2),
    Variant("masses -20 %", masses=0.8),
    Variant("leg masses +20 %", leg_masses=1.2),
    Variant("leg masses -20 %", leg_masses=0.8),
    Variant("joint stops -10 %", stops=0.9),
)
