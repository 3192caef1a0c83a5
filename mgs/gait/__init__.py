"""Gait files: what the robot shall do, as written by a person.

One module for each block of a file. SI units; x forward, y left, z up; angles in rad.
"""

from mgs.gait.balance import (
    COM_TOLERANCE,
    AnyChannel,
    BalanceParameters,
    ConstantChannel,
    FigureEightChannel,
    RampChannel,
    SineChannel,
)
from mgs.gait.find import find_gait, list_gaits, shipped_folder
from mgs.gait.ik import FarajiParameters, IkParameters, PrioritizedParameters
from mgs.gait.kinds import (
    GAITS,
    MAX_SAMPLES,
    BalanceGait,
    Gait,
    GaitFile,
    SequenceGait,
    SequencePart,
    SingleGait,
    WalkGait,
    gait_schema,
)
from mgs.gait.load import load_gait, parse_gait
from mgs.gait.walk import ComParameters, WalkParameters

__all__ = [
    "COM_TOLERANCE",
    "GAITS",
    "MAX_SAMPLES",
    "AnyChannel",
    "BalanceGait",
    "BalanceParameters",
    "ComParameters",
    "ConstantChannel",
    "FarajiParameters",
    "FigureEightChannel",
    "Gait",
    "GaitFile",
    "IkParameters",
    "PrioritizedParameters",
    "RampChannel",
    "SequenceGait",
    "SequencePart",
    "SineChannel",
    "SingleGait",
    "WalkGait",
    "WalkParameters",
    "find_gait",
    "gait_schema",
    "list_gaits",
    "load_gait",
    "parse_gait",
    "shipped_folder",
]
