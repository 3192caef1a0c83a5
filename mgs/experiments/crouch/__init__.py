"""Power against the crouch of the legs, for standing, swaying and walking, with several solvers.

Figure 7 of S. Faraji and A. J. Ijspeert, "Singularity-tolerant inverse kinematics for bipedal
robots: An efficient use of computational power to reduce energy consumption", IEEE Robotics and
Automation Letters, 2017, shows the electric power of the robot COMAN for a lateral motion with
torso twist on stretched and on crouched legs. Here three motions are repeated at CoM heights from
that of straight legs downwards, each with the solvers that can follow it. What is measured is the
sum of the squared joint torques, since the motors of COMAN are not known; for Melson with servos
whose motors have been identified, it is the electric power.
"""

from mgs.experiments.crouch.claims import all_claims
from mgs.experiments.crouch.study import solve
from mgs.experiments.crouch.variants import VARIANTS

__all__ = ["VARIANTS", "all_claims", "solve"]
