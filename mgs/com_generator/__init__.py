"""Stage 3: from the ZMP reference to the motion of the centre of mass."""

from mgs.com_generator.com_trajectory import ComTrajectory
from mgs.com_generator.generate import generate_com

__all__ = ["ComTrajectory", "generate_com"]
