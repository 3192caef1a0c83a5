"""The product of stage 1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Footstep, Support
from mgs.core.curves import Knots
from mgs.core.scene import EMPTY, Scene
from mgs.gait import AnyChannel


@dataclass(frozen=True, eq=False)
class SwingPath:
    """How a swing sole travels, where not as a step over level ground; times from lift-off."""

    planar: Knots  # x, y [m], yaw [rad]
    height: Knots  # z [m]


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
    path: SwingPath | None = None


@dataclass(frozen=True, eq=False)
class LegReach:
    """How far soles may be from the CoM: ankles within a leg's length of the hips."""

    hips: Array  # (2, 3) from the CoM, heading ahead [m]
    ankles: Array  # (2, 3) from the sole, in its frame [m]
    length: float  # [m]


@dataclass(frozen=True, eq=False)
class BodyPlan:
    """Motion of CoM, torso and hands over feet that stay: the sum of channels, eased in and out.

    The factor of all channels is 0 for samples up to `start` and from `end` on, 1 from
    `start + ease` to `end - ease`.
    """

    start: int
    end: int
    ease: int  # samples
    channels: tuple[AnyChannel, ...]
    com: Array  # (3,) at rest [m]
    com_height: float  # that com_z adds to [m]
    hands: Array  # (2, 3) at rest, world [m]


@dataclass(frozen=True, eq=False)
class KeyPlan:
    """K instants at which the body rests over feet that stay; the first is the start.

    The body is in key k from sample `arrivals[k]` to `departures[k]`.
    """

    arrivals: NDArray[np.intp]  # (K,)
    departures: NDArray[np.intp]  # (K,)
    com: Array  # (K, 3) [m]
    torso: Array  # (K, 4) quaternion xyzw
    hands: Array  # (K, 2, 3) world [m]; NaN: nothing is asked of this hand
    posture: Array  # (K, n) joint angles that the IK prefers [rad]
    held: NDArray[np.bool_]  # (n,) joints that follow their posture before anything else
    payload: Array | None = None  # (N, 2) in the hands at every sample [kg]
    mass: float = 0.0  # of the robot [kg], beside a payload
    base: Array | None = None  # (4,) quaternion xyzw of the base at the start, without balance


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
    landing: float  # part of a single support in which the swing sole comes straight down
    com_height: float  # [m]
    zmp_offset: tuple[float, float]  # forward and inward of the sole centre [m]
    hand_offsets: Array  # (2, 3) hands from the CoM, axes turned with the heading; NaN: free [m]
    torso: Array  # (4,) quaternion xyzw of the torso at rest, heading ahead
    zmp_travel: float = 0.0  # from heel to toe in a single support [m]
    arm_swing: float = 0.0  # way of a hand as a part of that of the opposite foot
    scene: Scene = EMPTY
    reach: LegReach | None = None  # bounds the CoM's height; None: it is as asked
    body: BodyPlan | None = None  # None: the CoM follows from the ZMP, or from `keys`
    keys: KeyPlan | None = None
