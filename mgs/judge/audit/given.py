"""What is audited: a motion of a robot as somebody gives it, with what the file says of it.

Positions alone define the motion. Velocities and times are statements about it, which the audit
compares with the positions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.geometry import rotations_from_quat_xyzw
from mgs.core.scene import EMPTY, Scene
from mgs.core.short_repr import short_repr
from mgs.motion import Motion
from mgs.robot import Robot

AngularFrame = Literal["world", "body"]
LinkPoint = Literal["origin", "com"]


@dataclass(frozen=True, eq=False)
class StatedLinks:
    """Velocities of links in the world frame, as a file states them."""

    names: tuple[str, ...]  # (B,)
    linear: Array  # (T, B, 3) of the point that `point` names [m/s]
    angular: Array | None  # (T, B, 3) [rad/s]
    point: LinkPoint = "origin"

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class GivenMotion:
    """Positions of a motion, and whatever else its file states; first axis time."""

    robot: Robot
    dt: float  # [s]
    q: Array  # (T, 7 + n) base position, base quaternion xyzw, joint angles
    scene: Scene = EMPTY
    joint_velocity: Array | None = None  # (T, n) [rad/s]
    base_linear: Array | None = None  # (T, 3) of the origin of the base, world frame [m/s]
    base_angular: Array | None = None  # (T, 3) [rad/s]
    angular_frame: AngularFrame = "world"  # in which `base_angular` is stated
    links: StatedLinks | None = None
    times: Array | None = None  # (T,) time stamps [s]
    payload: Array | None = None  # (T, 2) masses in the hands [kg]

    __repr__ = short_repr

    @property
    def n_samples(self) -> int:
        """Number of samples T."""
        return len(self.q)

    @property
    def joints(self) -> Array:
        """Joint angles (T, n) [rad]."""
        return self.q[:, FLOATING_BASE_NQ:]


def given_by(motion: Motion) -> GivenMotion:
    """A motion of mgs as what its file states: positions, the base twist and joint velocities."""
    R = rotations_from_quat_xyzw(motion.q[:, 3:7])
    return GivenMotion(
        robot=motion.robot,
        dt=motion.dt,
        q=motion.q,
        scene=motion.scene,
        joint_velocity=motion.v[:, FLOATING_BASE_NV:],
        base_linear=np.einsum("tij,tj->ti", R, motion.v[:, :3]),
        base_angular=motion.v[:, 3:FLOATING_BASE_NV],
        angular_frame="body",
        payload=motion.payload,
    )
