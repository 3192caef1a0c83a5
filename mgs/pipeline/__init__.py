"""The four stages in a row: from a gait to a motion, without any file."""

from mgs.motion.provenance import FilterReport, ZmpError
from mgs.pipeline.assemble import assemble
from mgs.pipeline.dynamic_filter import first_com
from mgs.pipeline.generate import Generated, generate
from mgs.pipeline.join import Displacement, displacement, join, moved
from mgs.pipeline.stages import Stages, run_stages

__all__ = [
    "Displacement",
    "FilterReport",
    "Generated",
    "Stages",
    "ZmpError",
    "assemble",
    "displacement",
    "first_com",
    "generate",
    "join",
    "moved",
    "run_stages",
]
