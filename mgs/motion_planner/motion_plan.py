"""The product of stage 1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.contact import Footstep, Support

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Phase:
    """One support phase: samples start <= k < end.

    `feet` are the footsteps (left, right) under the robot when the phase begins, as indices into
    `MotionPlan.footsteps`; in single support `target` is the one that the swing foot lands on.
    """

    start: int
    end: int
    support: Support
    feet: tuple[int, int]
    target: int | None = None


@dataclass(frozen=True, eq=False)
class MotionPlan:
    """Stage 1: what touches the ground where and when.

    Phases tile samples 0 .. n_samples - 1; the last sample belongs to the last phase.
    """

    dt: float  # [s]
    n_samples: int
    footsteps: tuple[Footstep, ...]  # the two initial ones first, then one per step
    phases: tuple[Phase, ...]
    step_height: float  # [m]
    com_height: float  # [m]
    zmp_offset: tuple[float, float]  # forward and inward of the sole centre [m]
    hand_offsets: Array  # (2, 3) hands from the CoM, in axes turned with the heading [m]
