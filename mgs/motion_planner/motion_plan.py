"""The product of stage 1: one type of plan for each way to describe a motion.

World frame: origin on the ground midway between the soles at the start, x forward, y left, z up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Footstep, Support
from mgs.core.curves import Knots
from mgs.core.scene import EMPTY, Scene
from mgs.core.short_repr import short_repr
from mgs.gait import AnyChannel
from mgs.gait.walk import SwingProfile


@dataclass(frozen=True, eq=False)
class SwingPath:
    """Path of a swing sole that is not the usual step; times count from lift-off."""

    planar: Knots  # x, y [m], yaw [rad]
    height: Knots  # z [m]

    __repr__ = short_repr


@dataclass(frozen=True)
class Phase:
    """One support phase: samples start <= k < end."""

    start: int
    end: int
    support: Support
    feet: tuple[int, int]  # indices of the left and right footstep under the robot at its start
    target: int | None = None  # index of the footstep that the swing foot lands on
    path: SwingPath | None = None  # None: the usual step

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class LegReach:
    """Largest distance of the soles from the CoM: ankles within a leg's length of the hips."""

    hips: Array  # (2, 3) from the CoM, robot facing along x [m]
    ankles: Array  # (2, 3) from the sole, in the sole's frame [m]
    length: float  # largest distance of an ankle from its hip [m]

    __repr__ = short_repr


@dataclass(frozen=True)
class FootRoll:
    """How far soles turn about their toes before lift-off and about their heels after landing."""

    toe_off: float  # pitch at lift-off of the longest step [rad]
    heel_strike: float  # pitch at touch-down of the longest step, toes up [rad]
    sole_lengths: tuple[float, float]  # of the left and right sole [m]


@dataclass(frozen=True, eq=False, kw_only=True)
class CommonPlan:
    """What every plan has."""

    dt: float  # sampling period [s]
    n_samples: int
    footsteps: tuple[Footstep, ...]  # the initial left and right ones first, then one per step
    scene: Scene = EMPTY

    __repr__ = short_repr


@dataclass(frozen=True, eq=False, kw_only=True)
class WalkPlan(CommonPlan):
    """Footsteps and support phases of a walk, of stairs or of a kick; the CoM follows the ZMP.

    Phases tile the samples 0 to n_samples - 1; the last sample belongs to the last phase.
    """

    phases: tuple[Phase, ...]
    step_height: float  # [m]
    swing_profile: SwingProfile = "minimum_jerk"
    landing: float = 0.0  # last part of a single support, in which the sole comes straight down
    roll: FootRoll | None = None  # None: the soles stay level
    com_height: float  # above the ground [m]
    zmp_offset: tuple[float, float]  # forward and inward of the sole's centre [m]
    zmp_travel: float = 0.0  # from heel to toe in each single support [m]
    hand_offsets: Array  # (2, 3) from the CoM, axes turned with the heading [m]; NaN: free
    arm_swing: float = 0.0  # forward motion of a hand as a part of that of the opposite foot
    hands_held: bool = True  # whether the hands have a task
    torso: Array  # (4,) orientation at rest, robot facing along x, quaternion xyzw
    reach: LegReach | None = None  # bound of the CoM's height; None: the height is as asked

    __repr__ = short_repr


@dataclass(frozen=True, eq=False, kw_only=True)
class BalancePlan(CommonPlan):
    """CoM, torso and hands follow the sum of channels over feet that stay.

    One factor of all channels fades them in and out: it is 0 up to sample `start` and from `end`
    on, and 1 from `start + ease` to `end - ease`.
    """

    start: int
    end: int
    ease: int  # number of samples
    channels: tuple[AnyChannel, ...]
    com: Array  # (3,) at rest [m]
    com_height: float  # height that the channel com_z adds to [m]
    hands: Array  # (2, 3) at rest [m]; NaN: free
    torso: Array  # (4,) orientation at rest, quaternion xyzw

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class KeyTimes:
    """The body rests in key k from sample arrivals[k] to departures[k]; the first is the start."""

    arrivals: NDArray[np.intp]  # (K,)
    departures: NDArray[np.intp]  # (K,)

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class Payload:
    """Masses that the hands carry."""

    masses: Array  # (N, 2) in the left and right hand at every sample [kg]
    robot_mass: float  # [kg]

    __repr__ = short_repr


@dataclass(frozen=True, eq=False, kw_only=True)
class KeyframePlan(CommonPlan):
    """CoM, torso, hands and joints go through K keys over feet that stay."""

    times: KeyTimes
    com: Array  # (K, 3) [m]
    torso: Array  # (K, 4) quaternion xyzw
    hands: Array  # (K, 2, 3) [m]; NaN: free
    posture: Array  # (K, n) preferred joint angles [rad]
    held: NDArray[np.bool_]  # (n,) joints that follow their angles exactly
    payload: Payload | None = None

    __repr__ = short_repr


@dataclass(frozen=True, eq=False, kw_only=True)
class PosturePlan(CommonPlan):
    """Joint angles go through K keys; how the robot balances on the way is not planned."""

    times: KeyTimes
    posture: Array  # (K, n) joint angles [rad]
    base: Array  # (2, 4) orientation of the base at the start and at the end, quaternion xyzw

    __repr__ = short_repr


MotionPlan = WalkPlan | BalancePlan | KeyframePlan | PosturePlan
