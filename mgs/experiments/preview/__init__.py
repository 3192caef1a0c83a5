"""Closed-loop analysis of the ZMP preview control of stage 3, with Melson's figures.

Poles, gains and Riccati solution against python-control and against derivations that share no code
with ours; the answer to a step of the reference that is known in advance; what the weight of the
jerk costs on fast steps.
"""

from mgs.experiments.preview.study import all_claims, solve

__all__ = ["all_claims", "solve"]
