"""The product of stage 4."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mgs.core.short_repr import short_repr


@dataclass(frozen=True, eq=False)
class JointTrajectory:
    """Joint angles at every sample, in the order of `Robot.joint_names`.

    `velocities` are those that a solver finds by itself, not by differences of the angles (ik2).
    `report` says how the solver fared, as plain data for the motion file.
    """

    angles: NDArray[np.float64]  # (N, n) [rad]
    velocities: NDArray[np.float64] | None = None  # (N, n) [rad/s]
    report: dict[str, object] = field(default_factory=dict)

    __repr__ = short_repr
