"""Variants of the experiments of Mistry et al., for `mgs experiment mistry --sensitivity`."""

from __future__ import annotations

from mgs.experiments.variant import Variant

VARIANTS = (
    Variant("dt 5 ms", ("dt=0.005",)),
    Variant("masses +20 %", masses=1.2),
    Variant("masses -20 %", masses=0.8),
    Variant("leg masses +20 %", leg_masses=1.2),
    Variant("leg masses -20 %", leg_masses=0.8),
)
