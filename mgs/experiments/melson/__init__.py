"""The experiments of the Melson paper: secondary tasks S1 to S3, and joint drift over 30 steps.

"Inverse kinematics of a humanoid robot modelled as a tree-shaped manipulator", section 5. Every
run solves one and the same task trajectory; only the null-space gains differ:

    S1  gamma_joint 0      gamma_grav 0
    S2  gamma_joint 1      gamma_grav 0
    S3  gamma_joint 0.35   gamma_grav 1.6
    drift over 30 steps    gamma_joint 0 and 1, gamma_grav 0

No Newton updates are taken, so that the closed-loop IK alone has to meet the tasks.
"""

from mgs.experiments.melson.claims import all_claims
from mgs.experiments.melson.runs import solve

__all__ = ["all_claims", "solve"]
