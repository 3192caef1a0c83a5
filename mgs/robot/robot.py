"""Robot model: URDF and robot.yaml combined in a Pinocchio model with soles, hands and limits."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side
from mgs.robot.collision_shapes import collision_geometry
from mgs.robot.coupling import Coupling, Follower, coupling_of
from mgs.robot.spec import RobotSpec, SoleSpec

RMS_TORQUE_RATIO = 0.3  # of stall torque, which is no continuous rating


@dataclass(frozen=True, eq=False)
class Robot:
    """Humanoid robot: Pinocchio model with a floating base, operational frames and servo limits.

    Joint arrays have shape (n,) and follow `joint_names`; q is (7 + n,): base position, base
    quaternion xyzw, joints; v is (6 + n,): base twist in the base frame, joints.
    """

    spec: RobotSpec
    source: str
    urdf: str
    yaml: str
    model: pin.Model
    joint_names: tuple[str, ...]
    lower: Array  # [rad]
    upper: Array  # [rad]
    speed_limit: Array  # smaller of URDF velocity limit and servo no-load speed [rad/s]
    no_load_speed: Array  # no-load speed of the servo [rad/s]
    torque_limit: Array  # stall torque of the servo, at a follower that of its leader's [N m]
    armature: Array  # rotor inertia, reflected to the joint, 0 at a follower [kg m^2]
    posture: Array  # half-sitting joint angles [rad]
    sole_frames: tuple[int, int]  # frame ids in `model`, left and right
    hand_frames: tuple[int, int]  # frame ids; the torso frame twice for a robot without hands
    torso_frame: int
    followers: Mapping[str, Follower] = field(default_factory=dict)  # joints without a motor

    def __repr__(self) -> str:
        return f"<Robot {self.spec.name}: {self.n} joints, {self.mass:.2f} kg>"

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    @functools.cached_property
    def mass(self) -> float:
        """Total mass [kg]."""
        return float(pin.computeTotalMass(self.model))

    @functools.cached_property
    def lasting_torque(self) -> Array:
        """Largest root mean square torque (n,) of a motion [N m]."""
        return RMS_TORQUE_RATIO * self.torque_limit

    @functools.cached_property
    def coupling(self) -> Coupling | None:
        """How followers turn with their leaders; None if every joint has a motor of its own."""
        return coupling_of(self.joint_names, self.followers)

    @functools.cached_property
    def motors(self) -> NDArray[np.bool_]:
        """Mask (n,) of the joints that have a motor of their own."""
        coupling = self.coupling
        return np.ones(self.n, dtype=np.bool_) if coupling is None else coupling.motors

    def servo_of(self, joint: str) -> str:
        """Name of the servo model that turns a joint, of a follower that of its leader."""
        follower = self.followers.get(joint)
        return self.spec.joints[joint if follower is None else follower.leader]

    def sole_spec(self, side: Side) -> SoleSpec:
        """Contact rectangle of one sole."""
        return self.spec.soles.left if side is Side.LEFT else self.spec.soles.right

    @functools.cached_property
    def standing_q(self) -> Array:
        """Half-sitting posture (7 + n,), soles on the ground, the origin midway between them."""
        q = pin.neutral(self.model)
        q[FLOATING_BASE_NQ:] = self.posture
        data = self.model.createData()
        pin.framesForwardKinematics(self.model, data, q)
        left, right = (data.oMf[frame] for frame in self.sole_frames)
        middle = pin.SE3(left.rotation, 0.5 * (left.translation + right.translation))
        base = middle.inverse()  # in the neutral configuration the base frame is the world frame
        q[:FLOATING_BASE_NQ] = pin.SE3ToXYZQUAT(base)
        return q

    @functools.cached_property
    def geometry(self) -> pin.GeometryModel:
        """Collision shapes, with every pair of links that is neither adjacent nor ignored."""
        return collision_geometry(
            self.model, self.urdf, self.spec.ignore_collisions, f"{self.source}: {self.spec.urdf}"
        )
