"""Gaits one after the other as one motion."""

from mgs.sequence.generate import Made, generate_motion, labelled_parts
from mgs.sequence.join import Displacement, displacement, join, moved

__all__ = [
    "Displacement",
    "Made",
    "displacement",
    "generate_motion",
    "join",
    "labelled_parts",
    "moved",
]
