"""The experiments of Mistry et al. on COMAN: CoG sway, and a hand's figure eight over it.

M. Mistry, J. Nakanishi, G. Cheng and S. Schaal, "Inverse kinematics with floating base and
constraints for full body humanoid robot control", Humanoids 2008. Level A soles and horizontal CoM,
B the hand, E torso and CoM height; gaits coman/sway and coman/hand_eight. The paper names
constraint switching as future work: a walk of Melson shows it.
"""

from mgs.experiments.mistry.claims import all_claims
from mgs.experiments.mistry.runs import solve

__all__ = ["all_claims", "solve"]
