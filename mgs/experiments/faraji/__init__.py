"""Experiments of Faraji and Ijspeert on the legs of COMAN: tasks A to H, methods ik1 to ik5.

S. Faraji and A. J. Ijspeert, "Singularity-tolerant inverse kinematics for bipedal robots: An
efficient use of computational power to reduce energy consumption", IEEE Robotics and Automation
Letters, 2017, section III; task H is from the two-page abstract by the same authors, "A
singularity-tolerant inverse kinematics including joint position and velocity limitations". Both
feet are fixed, the CoM is a soft task; the parameters are those of Table I:

    Q = I, R = 1e-2 I, gamma = 10, n = 15 (and 3), qdot_max = 4 rad/s, q_s = 0

The gaits are those in gaits/coman_legs. The paper does not state amplitudes and most periods; they
are our choice. Claims that depend on the iteration limit of the solver SNOPT are not applicable.
"""

from mgs.experiments.faraji.claims import all_claims
from mgs.experiments.faraji.runs import solve
from mgs.experiments.faraji.variants import VARIANTS

__all__ = ["VARIANTS", "all_claims", "solve"]
