"""The product of stage 3, and the choice of its generator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.gait import ComParameters
from mgs.trajectory_planner import TaskTrajectory

Array = NDArray[np.float64]
GRAVITY = 9.81  # [m/s^2]


@dataclass(frozen=True, eq=False)
class ComTrajectory:
    """Stage 3: motion of the centre of mass; world frame, first axis time."""

    position: Array  # (N, 3) [m]
    velocity: Array  # (N, 3) [m/s]
    acceleration: Array  # (N, 3) [m/s^2]
    zmp: Array  # (N, 2) of the cart-table model [m]


def generate_com(tasks: TaskTrajectory, parameters: ComParameters) -> ComTrajectory:
    """Stage 3: the CoM motion whose ZMP follows the reference.

    Raises:
        ConfigError: dt, CoM height or weights admit no stabilising gain.
        InfeasibleGaitError: the CoM is not at rest when the motion ends.
    """
    from mgs.com_generator.preview import follow_zmp

    return follow_zmp(tasks.zmp_ref, tasks.com_height, tasks.dt, parameters)
