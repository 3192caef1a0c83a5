"""Experiments of the article on Melson: secondary tasks S1 to S3, joint drift over 30 steps.

The article is "Inverse kinematics of a humanoid robot modelled as a tree-shaped manipulator"; the
experiments are in its section 5. All runs have the same task trajectory and differ in the gains of
the null-space tasks:

    S1  gamma_joint 0      gamma_grav 0
    S2  gamma_joint 1      gamma_grav 0
    S3  gamma_joint 0.35   gamma_grav 1.6
    drift over 30 steps    gamma_joint 0 and 1, gamma_grav 0

There are no Newton updates: the closed-loop inverse kinematics alone has to meet the tasks.
"""

from mgs.experiments.melson.claims import all_claims
from mgs.experiments.melson.runs import solve
from mgs.experiments.variant import Variant

__all__ = ["VARIANTS", "all_claims", "solve"]

VARIANTS: tuple[Variant, ...] = ()
