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
from mgs.gait.ik import (
    FarajiParameters,
    IkParameters,
    PrioritizedParameters,
    WholeBodyIkParameters,
)
from mgs.gait.keyframes import Keyframe, KeyframesParameters
from mgs.gait.kinds import (
    GAITS,
    BalanceGait,
    Gait,
    GaitFile,
    KeyframesGait,
    PickUpGait,
    WalkGait,
    gait_schema,
)
from mgs.gait.load import find_gait, list_gaits, load_gait, parse_gait, shipped_folder
from mgs.gait.pick_up import PickUpParameters
from mgs.gait.walk import ComParameters, WalkParameters

__all__ = [
    "COM_TOLERANCE",
    "GAITS",
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
    "Keyframe",
    "KeyframesGait",
    "KeyframesParameters",
    "PickUpGait",
    "PickUpParameters",
    "PrioritizedParameters",
    "RampChannel",
    "SineChannel",
    "WalkGait",
    "WalkParameters",
    "WholeBodyIkParameters",
    "find_gait",
    "gait_schema",
    "list_gaits",
    "load_gait",
    "parse_gait",
    "shipped_folder",
]
