"""The products of stage 2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.short_repr import short_repr


@dataclass(frozen=True, eq=False)
class PreferredPosture:
    """Joint angles that inverse kinematics shall come near to."""

    angles: Array  # (N, n) [rad]
    held: NDArray[np.bool_]  # (n,) joints that follow their angles before any other task

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class TaskTrajectory:
    """References of all tasks at every sample; world frame, first axis time, then (left, right)."""

    dt: float  # sampling period [s]
    support: NDArray[np.int8]  # (N,) values of Support
    root: NDArray[np.int8]  # (N,) Side of the sole that inverse kinematics starts from
    zmp_ref: Array  # (N, 2) [m]
    load_left: Array  # (N,) share of the weight on the left sole, 0 to 1
    soles: Array  # (N, 2, 7) x, y, z [m], quaternion xyzw
    hands: Array  # (N, 2, 3) from the CoM, world axes [m]; NaN: this hand is free
    com_height: Array  # (N,) [m]
    torso: Array  # (N, 4) quaternion xyzw; only a preference unless `torso_asked`
    torso_asked: bool = False
    com: Array | None = None  # (N, 3) CoM asked for [m]; None: stage 3 derives it from the ZMP
    start: Array | None = None  # (n,) joint angles at the start [rad]; None: half-sitting
    posture: PreferredPosture | None = None  # None: half-sitting at every sample, no joint held
    # (N, 2, 3) planned centres of pressure of both soles [m]; None: the centres of the soles
    pressure: Array | None = None
    payload: Array | None = None  # (N, 2) masses in the hands [kg]; None: no payload

    __repr__ = short_repr

    @property
    def n_samples(self) -> int:
        """Number of samples N."""
        return len(self.support)

    @property
    def hands_asked(self) -> tuple[bool, bool]:
        """Whether there is a reference for the left and for the right hand."""
        left, right = np.isfinite(self.hands[0]).all(axis=1)
        return bool(left), bool(right)


@dataclass(frozen=True, eq=False)
class PostureTrajectory:
    """Joint angles and the orientation of the base at every sample of a motion without balance."""

    dt: float  # sampling period [s]
    angles: Array  # (N, n) [rad]
    base: Array  # (N, 4) quaternion xyzw

    __repr__ = short_repr
