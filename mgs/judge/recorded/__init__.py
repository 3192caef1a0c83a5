"""Motions of others as motions of mgs: layout, base and contacts are found out and told."""

from mgs.judge.recorded.layout import layouts, read_placed
from mgs.judge.recorded.motion import motion_of
from mgs.judge.recorded.placed import Choices, Placed, QuaternionOrder

__all__ = ["Choices", "Placed", "QuaternionOrder", "layouts", "motion_of", "read_placed"]
