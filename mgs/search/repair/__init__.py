"""Repair of motions that mgs did not plan: the nearest motion that holds."""

from mgs.search.repair.figures import Figures, figures_of, link_distance
from mgs.search.repair.run import GOALS, Repaired, repair

__all__ = ["GOALS", "Figures", "Repaired", "figures_of", "link_distance", "repair"]
