"""Gait files: descriptions of motions in YAML, one module for each block of a file.

Quantities are in SI units, angles in rad; x points forward, y to the left, z up.
"""

from mgs.core.constants import COM_TOLERANCE
from mgs.gait.balance import (
    AnyChannel,
    BalanceParameters,
    ConstantChannel,
    FigureEightChannel,
    RampChannel,
    SineChannel,
)
from mgs.gait.com import ComParameters
from mgs.gait.find import find_gait, list_gaits
from mgs.gait.gait_file import GaitFile
from mgs.gait.ik import FarajiParameters, IkParameters, PrioritizedParameters, WholeBodyIkParameters
from mgs.gait.keyframes import Keyframe, KeyframesParameters
from mgs.gait.kick import BallParameters, KickParameters
from mgs.gait.kinds import (
    GAITS,
    BalanceGait,
    Gait,
    KeyframesGait,
    KickGait,
    PickUpGait,
    SequenceGait,
    SequencePart,
    SingleGait,
    WalkGait,
    ZmpGait,
    gait_schema,
)
from mgs.gait.load import load_gait, parse_gait
from mgs.gait.pick_up import PickUpParameters
from mgs.gait.recorded import RecordedGait, RecordedParameters
from mgs.gait.walk import (
    BoxParameters,
    FootstepParameters,
    GoalParameters,
    StepParameters,
    WalkParameters,
)

__all__ = [
    "COM_TOLERANCE",
    "GAITS",
    "AnyChannel",
    "BalanceGait",
    "BalanceParameters",
    "BallParameters",
    "BoxParameters",
    "ComParameters",
    "ConstantChannel",
    "FarajiParameters",
    "FigureEightChannel",
    "FootstepParameters",
    "Gait",
    "GaitFile",
    "GoalParameters",
    "IkParameters",
    "Keyframe",
    "KeyframesGait",
    "KeyframesParameters",
    "KickGait",
    "KickParameters",
    "PickUpGait",
    "PickUpParameters",
    "PrioritizedParameters",
    "RampChannel",
    "RecordedGait",
    "RecordedParameters",
    "SequenceGait",
    "SequencePart",
    "SineChannel",
    "SingleGait",
    "StepParameters",
    "WalkGait",
    "WalkParameters",
    "WholeBodyIkParameters",
    "ZmpGait",
    "find_gait",
    "gait_schema",
    "list_gaits",
    "load_gait",
    "parse_gait",
]
