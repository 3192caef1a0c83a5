"""The four stages in a row: from a gait to a motion, without any file."""

from mgs.pipeline.join import Displacement, displacement, join, moved
from mgs.pipeline.sequence import Made, generate_motion, labelled_parts
from mgs.pipeline.stages import Stages, assemble, generate

__all__ = [
    "Displacement",
    "Made",
    "Stages",
    "assemble",
    "displacement",
    "generate",
    "generate_motion",
    "join",
    "labelled_parts",
    "moved",
]
