"""A CoM motion that the task gives: only its derivatives and its ZMP are left to find."""

from __future__ import annotations

import numpy as np

from mgs.com_generator.com_trajectory import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.constants import GRAVITY


def follow_com(com: Array, dt: float) -> ComTrajectory:
    """CoM positions (N, 3) as they are, with central differences and the point mass's ZMP."""
    steps = np.zeros((len(com) + 1, 3))  # at rest before the first sample and after the last
    steps[1:-1] = np.diff(com, axis=0) / dt
    acceleration = np.diff(steps, axis=0) / dt
    lever = com[:, 2:] / (GRAVITY + acceleration[:, 2:])
    return ComTrajectory(
        position=com,
        velocity=0.5 * (steps[1:] + steps[:-1]),
        acceleration=acceleration,
        zmp=com[:, :2] - lever * acceleration[:, :2],
    )
