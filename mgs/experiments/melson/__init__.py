"""Experiments of the article on Melson: secondary tasks S1 to S3, joint drift over 30 steps.

The article is "Inverse kinematics of a humanoid robot modelled as a tree-shaped manipulator"; the
experiments are in its section 5. All runs of one length have the same task trajectory and differ in
the gains of the null-space tasks:

    S1  gamma_joint 0      gamma_grav 0       gait melson/s1
    S2  gamma_joint 1      gamma_grav 0       gait melson/s2
    S3  gamma_joint 0.35   gamma_grav 1.6     gait melson/s3

The article walks two steps in S1 to S3, and thirty steps in S1 and S2. We add a walk of eight steps
in S1 to S3, in order to measure every single support phase of a walk that does not consist of its
beginning and end. There are no Newton updates: the closed-loop inverse kinematics alone has to meet
the tasks.
"""

from mgs.experiments.melson.claims import all_claims
from mgs.experiments.melson.runs import solve
from mgs.experiments.melson.variants import VARIANTS

__all__ = ["VARIANTS", "all_claims", "solve"]
