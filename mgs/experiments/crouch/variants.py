"""Variants of the crouch experiment, for `mgs experiment crouch --sensitivity`."""

from __future__ import annotations

from mgs.experiments.variant import Variant

VARIANTS = (
    Variant("dt 5 ms", ("dt=0.005",)),
    Variant("masses +20 %", masses=1.2),
    Variant("leg masses -20 %", leg_masses=0.8),
    Variant("amplitude -50 %", amplitude=0.5),
)
