"""A robot that stands still on both soles with a payload: joint torques, CoM and gaps.

    tau = g(q) + sum_hands m g J_z^T - sum_soles f_i (J_z + y_i J_roll - x_i J_pitch)^T

The soles share the weight according to the position of the CoM between them. The force f_i acts at
the point (x_i, y_i): the sole's centre, shifted by the offset of the CoM from the line between the
two centres.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV, GRAVITY
from mgs.core.contact import Side, Support
from mgs.robot import Robot
from mgs.robot.support_polygon import support_polygon


@dataclass(frozen=True, eq=False)
class Standing:
    """Quantities of one posture; world frame, origin on the ground midway between the soles."""

    right_sole: Array  # (6,) error of the right sole's pose, log map [m], [rad]
    hands: Array  # (2, 3) [m]
    com: Array  # (3,) of the robot alone [m]
    loaded_com: Array  # (3,) with the payload [m]
    torque: Array  # (n,) [N m]
    gaps: Array  # (p,) distances of the measured pairs of bodies, negative inside [m]


class StandingModel:
    """Postures of one robot whose left sole stays where it is at rest."""

    def __init__(self, robot: Robot, payload: Array) -> None:
        """Model of a robot with a payload (2,) in its left and right hand [kg]."""
        self.robot, self.payload = robot, payload
        self.model, self.data = robot.model, robot.model.createData()
        self.geometry_data = robot.geometry.createData()
        self.q = robot.standing_q.copy()
        pin.framesForwardKinematics(self.model, self.data, self.q)
        self.soles = [self.data.oMf[frame].copy() for frame in robot.sole_frames]
        self.pairs: list[int] = []  # collision pairs whose gaps are measured

    def place(self, joints: Array) -> Array:
        """Configuration (7 + n,) for joint angles (n,) [rad]; updates placements and Jacobians."""
        q, data = self.q, self.data
        q[:FLOATING_BASE_NQ] = pin.neutral(self.model)[:FLOATING_BASE_NQ]
        q[FLOATING_BASE_NQ:] = joints
        pin.forwardKinematics(self.model, data, q)
        frame = self.robot.sole_frames[Side.LEFT]
        base = self.soles[Side.LEFT] * pin.updateFramePlacement(self.model, data, frame).inverse()
        q[:FLOATING_BASE_NQ] = pin.SE3ToXYZQUAT(base)
        pin.computeJointJacobians(self.model, data, q)
        pin.updateFramePlacements(self.model, data)
        return q

    def stand(self, joints: Array) -> Standing:
        """Quantities of the posture with joint angles (n,) [rad]."""
        robot, model, data = self.robot, self.model, self.data
        q = self.place(joints)
        hands = np.array([data.oMf[frame].translation for frame in robot.hand_frames])
        right = self.soles[Side.RIGHT].actInv(data.oMf[robot.sole_frames[Side.RIGHT]])
        com = pin.centerOfMass(model, data, q, False).copy()
        total = robot.mass + self.payload.sum()
        loaded_com = (robot.mass * com + self.payload @ hands) / total
        torque = pin.computeGeneralizedGravity(model, data, q).copy()
        for side, frame in enumerate(robot.hand_frames):
            if self.payload[side]:
                J = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
                torque += GRAVITY * self.payload[side] * J[2]
        torque -= self._sole_forces(loaded_com, GRAVITY * total)
        return Standing(
            right_sole=pin.log6(right).vector,
            hands=hands,
            com=com,
            loaded_com=loaded_com,
            torque=torque[FLOATING_BASE_NV:],
            gaps=self._gaps(q),
        )

    def torso(self, joints: Array) -> Array:
        """Orientation (4,) of the torso, quaternion xyzw."""
        self.place(joints)
        rotation = self.data.oMf[self.robot.torso_frame].rotation
        return np.array(pin.Quaternion(rotation).coeffs())

    def collisions(self, joints: Array) -> list[int]:
        """Indices of the pairs of bodies that touch although they may not."""
        geometry, geometry_data = self.robot.geometry, self.geometry_data
        q = self.place(joints)
        pin.computeCollisions(self.model, self.data, geometry, geometry_data, q, False)
        return [i for i, r in enumerate(geometry_data.collisionResults) if r.isCollision()]

    def names_of(self, pair: int) -> str:
        """Names of the two links of a pair."""
        geometry = self.robot.geometry
        both = (geometry.collisionPairs[pair].first, geometry.collisionPairs[pair].second)
        frames = (geometry.geometryObjects[i].parentFrame for i in both)
        return " and ".join(self.model.frames[frame].name for frame in frames)

    def polygon(self) -> Array:
        """Support polygon (m, 2), counter-clockwise [m]."""
        poses = np.array([pin.SE3ToXYZQUAT(sole) for sole in self.soles])
        return support_polygon(self.robot, poses, Support.DOUBLE)

    def _sole_forces(self, com: Array, weight: float) -> Array:
        """Generalised forces (6 + n,) of the ground on the soles for a CoM (3,) [N], [N m]."""
        left, right = (sole.translation[:2] for sole in self.soles)
        across = left - right
        share = float((com[:2] - right) @ across / (across @ across))
        forces = np.zeros(self.model.nv)
        shift = com[:2] - (share * left + (1.0 - share) * right)
        for side, part in zip(Side, (share, 1.0 - share), strict=True):
            x, y = self.soles[side].translation[:2] + shift
            J = pin.getFrameJacobian(self.model, self.data, self.robot.sole_frames[side], pin.WORLD)
            forces += part * weight * (J[2] + y * J[3] - x * J[4])
        return forces

    def _gaps(self, q: Array) -> Array:
        """Distances (p,) of the measured pairs of bodies [m]."""
        geometry, geometry_data = self.robot.geometry, self.geometry_data
        if not self.pairs:
            return np.empty(0)
        pin.updateGeometryPlacements(self.model, self.data, geometry, geometry_data)
        return np.array(
            [pin.computeDistance(geometry, geometry_data, i).min_distance for i in self.pairs]
        )
