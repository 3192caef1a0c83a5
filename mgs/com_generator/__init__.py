"""Stage 3: from the ZMP reference to the motion of the centre of mass."""

from mgs.com_generator.com_trajectory import ComTrajectory
from mgs.com_generator.dynamic_filter import correct_com, rest_window
from mgs.com_generator.from_positions import follow_com
from mgs.com_generator.generate import ComGenerator, generate_com, planned_zmp

__all__ = [
    "ComGenerator",
    "ComTrajectory",
    "correct_com",
    "follow_com",
    "generate_com",
    "planned_zmp",
    "rest_window",
]
