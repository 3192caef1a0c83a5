"""The experiments of Faraji and Ijspeert on COMAN's legs: tasks A to H, methods ik1 to ik5.

"Singularity-tolerant inverse kinematics for bipedal robots", section 3, and task H of the two-page
abstract. Both feet fixed, the CoM soft; parameters as in its Table I:

    Q = I, R = 1e-2 I, gamma = 10, n = 15 (and 3), qdot_max = 4 rad/s, q_s = 0

The gaits are those in gaits/coman_legs; amplitudes and periods, which the paper does not state, are
ours. A claim that rests on the iteration limit of the paper's solver is not applicable here.
"""

from mgs.experiments.faraji.claims import all_claims
from mgs.experiments.faraji.runs import solve

__all__ = ["all_claims", "solve"]
