"""The product of stage 2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array


@dataclass(frozen=True, eq=False)
class TaskTrajectory:
    """Stage 2: references at every sample; world frame, first axis time, then (left, right)."""

    dt: float  # [s]
    support: NDArray[np.int8]  # (N,) values of Support
    root: NDArray[np.int8]  # (N,) Side of the sole that the IK stands on
    zmp_ref: Array  # (N, 2)
    load_left: Array  # (N,) share of the weight on the left sole, 0 to 1
    soles: Array  # (N, 2, 7) x, y, z, quaternion xyzw
    hands: Array  # (N, 2, 3) from the CoM, world axes; NaN: nothing is asked of this hand
    com_height: Array  # (N,)
    torso: Array  # (N, 4) quaternion xyzw; a preference only unless `torso_asked`
    torso_asked: bool = False
    com: Array | None = None  # (N, 3) where the CoM itself is asked for; None: by the ZMP
    start: Array | None = None  # (n,) joint angles begun from [rad]; None: half-sitting posture
    posture: Array | None = None  # (N, n) joint angles to prefer [rad]; None: half-sitting
    held: NDArray[np.bool_] | None = None  # (n,) joints that follow `posture` before all else
    payload: Array | None = None  # (N, 2) in the hands [kg]; None: none

    @property
    def n_samples(self) -> int:
        """Number of samples N."""
        return len(self.support)

    @property
    def hands_asked(self) -> tuple[bool, bool]:
        """Whether anything is asked of the left and of the right hand."""
        left, right = np.isfinite(self.hands[0]).all(axis=1)
        return bool(left), bool(right)
