"""Closed-loop analysis of the ZMP preview control of stage 3, with the parameters of Melson.

ZMP is the zero-moment point; the method is that of Kajita et al., "Biped walking pattern generation
by using preview control of zero-moment point", ICRA, 2003. The study compares poles, gains and the
Riccati solution with python-control and with derivations that share no code with mgs. It also shows
the response to a step of the reference that is known in advance, and the influence of the weight of
the jerk on fast steps.
"""

from mgs.experiments.preview.study import all_claims, solve
from mgs.experiments.variant import Variant

__all__ = ["VARIANTS", "all_claims", "solve"]

VARIANTS: tuple[Variant, ...] = ()
