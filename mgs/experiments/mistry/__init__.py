"""Experiments of Mistry et al. on COMAN: sway of the CoG, and a figure eight of a hand.

M. Mistry, J. Nakanishi, G. Cheng and S. Schaal, "Inverse kinematics with floating base and
constraints for full body humanoid robot control", IEEE-RAS Humanoids, 2008. CoG is the centre of
gravity, elsewhere called CoM. Level A has soles and horizontal CoM, level B the hand, level E torso
and CoM height; the gaits are coman/sway and coman/hand_eight. The paper names constraint switching
as future work; here a walk of Melson shows it.
"""

from mgs.experiments.mistry.claims import all_claims
from mgs.experiments.mistry.runs import solve
from mgs.experiments.mistry.variants import VARIANTS

__all__ = ["VARIANTS", "all_claims", "solve"]
