"""The product of stage 4."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class JointTrajectory:
    """Joint angles at every sample, in the order of `Robot.joint_names`."""

    angles: NDArray[np.float64]  # (N, n) [rad]
    newton_updates: int  # task-only updates taken beyond one step per sample
