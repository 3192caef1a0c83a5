"""The product of all stages, and what follows from it: dynamics, cycles, servo commands."""

from mgs.motion.motion import Motion

__all__ = ["Motion"]
