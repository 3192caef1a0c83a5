"""Variants of the experiments of Faraji and Ijspeert, for `mgs experiment faraji --sensitivity`."""

from __future__ import annotations

from mgs.experiments.variant import Variant

VARIANTS = (
    Variant("dt 5 ms", ("dt=0.005",)),
    Variant("dt 20 ms", ("dt=0.02",)),
    Variant("Q = diag(100, 100, 1)", ("ik.faraji.soft.com=[100, 100, 1]",)),
    Variant("amplitude +50 %", amplitude=1.5),
    Variant("amplitude -50 %", amplitude=0.5),
    Variant("speed +50 %", speed=1.5),
    Variant("speed -50 %", speed=0.5),
    Variant("leg masses +20 %", leg_masses=1.2),
    Variant("leg masses -20 %", leg_masses=0.8),
    Variant("joint stops -10 %", stops=0.9),
    Variant("gamma 5", ("ik.faraji.gamma=5",)),
    Variant("gamma 20", ("ik.faraji.gamma=20",)),
    Variant("R 1e-3", ("ik.faraji.damping=1e-3",)),
)
