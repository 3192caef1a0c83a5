"""One optimal-control problem over a whole motion, with full dynamics and contact wrenches."""

from mgs.search.whole_body.problem import Weights
from mgs.search.whole_body.run import Figures, Optimised, default_hands, optimise

__all__ = ["Figures", "Optimised", "Weights", "default_hands", "optimise"]
