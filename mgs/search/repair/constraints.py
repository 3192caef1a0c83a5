"""What a repaired motion has to hold, as residuals with their Jacobians, sample by sample.

    pose    the sole that stands is at its place, level, on the floor           r = 0
    floor   no corner of a sole is below the floor                              r <= 0
    range   joints are inside their ranges                                      r <= 0
    speed   joints are not faster than their servos, from sample to sample      r <= 0
    zmp     the ZMP of the whole robot is inside the soles that stand           r <= 0

Lengths are in m, angles in rad; rotations of soles count by half their length, so that they are
lengths too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV, GRAVITY
from mgs.core.contact import Side
from mgs.core.geometry import (
    convex_hull,
    quat_xyzw_from_yaw,
    rotations_from_quat_xyzw,
    sole_corners,
)
from mgs.core.short_repr import short_repr
from mgs.ik_solver.rotations import rotation_vectors
from mgs.judge.audit import GivenMotion
from mgs.judge.audit.body import Body
from mgs.motion.dynamics import zmp_at
from mgs.robot import Robot
from mgs.search.repair.stances import Stances

N_FACES = 8  # of the hull of two rectangles
RANGE_MARGIN = 2e-3  # [rad]
SPEED_SHARE = 0.99  # of the limit
ZMP_MARGIN = 0.005  # [m]
WIDEST_SHARE = 0.4  # of half the width of a sole, that the margin takes at most


@dataclass(frozen=True, eq=False)
class Residuals:
    """Residuals of all constraints at one motion; zero where one does not apply."""

    pose: Array  # (T, 2, 6)
    floor: Array  # (T, 2, 4)
    range: Array  # (T, 2, n) above the upper, below the lower limit
    speed: Array  # (T - 1, 2, n) in one and in the other direction
    zmp: Array  # (T, 8)

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class Jacobians:
    """Jacobians with respect to steps in the tangent of the configuration."""

    soles: Array  # (T, 2, 6, p) place and scaled rotation, world axes
    corners: Array  # (T, 2, 4, p) heights
    com: Array  # (T, 2, p) horizontal

    __repr__ = short_repr


class Constraints:
    """The constraints of one repair."""

    def __init__(self, robot: Robot, stances: Stances, dt: float) -> None:
        self.robot, self.stances, self.dt = robot, stances, dt
        self.lower, self.upper = robot.lower + RANGE_MARGIN, robot.upper - RANGE_MARGIN
        self.stride = SPEED_SHARE * robot.speed_limit * dt
        self.arm = 0.5 * np.array([robot.sole_spec(side).length for side in Side])
        quat = quat_xyzw_from_yaw(stances.places[..., 2])
        self.turn = rotations_from_quat_xyzw(quat)  # (T, 2, 3, 3)
        self.normals, self.bounds = _polygons(robot, stances)
        data = robot.model.createData()
        self.com_height = float(pin.centerOfMass(robot.model, data, robot.standing_q)[2])

    def residuals(self, given: GivenMotion, body: Body) -> Residuals:
        """Residuals of a motion."""
        stands, places = self.stances.stands, self.stances.places
        pose = np.zeros((*stands.shape, 6))
        pose[..., :2] = body.soles[..., :2] - places[..., :2]
        pose[..., 2] = body.soles[..., 2]
        for side in Side:
            off = body.turns[:, side] @ self.turn[:, side].transpose(0, 2, 1)
            pose[:, side, 3:] = self.arm[side] * rotation_vectors(off)
        pose[~stands] = 0.0
        floor = np.where(stands[..., None], -1.0, -body.corners[..., 2])
        q = given.joints
        step = np.diff(q, axis=0)
        zmp = zmp_at(body.wrench, np.zeros(len(q)))
        inside = np.einsum("tfi,ti->tf", self.normals, zmp) - self.bounds
        inside[[0, -1]] = -1.0  # no acceleration is known there
        return Residuals(
            pose=pose,
            floor=floor,
            range=np.stack([q - self.upper, self.lower - q], axis=1),
            speed=np.stack([step - self.stride, -step - self.stride], axis=1),
            zmp=inside,
        )

    def jacobians(self, q: Array) -> Jacobians:
        """Jacobians at configurations q (T, 7 + n)."""
        robot, model = self.robot, self.robot.model
        data, p = model.createData(), FLOATING_BASE_NV + robot.n
        soles, com = np.empty((len(q), 2, 6, p)), np.empty((len(q), 2, p))
        for k in range(len(q)):
            com[k] = pin.jacobianCenterOfMass(model, data, q[k], False)[:2]
            pin.updateFramePlacements(model, data)
            for side in Side:
                soles[k, side] = pin.getFrameJacobian(
                    model, data, robot.sole_frames[side], pin.LOCAL_WORLD_ALIGNED
                )
        soles[:, :, 3:] *= self.arm[None, :, None, None]
        return Jacobians(soles, np.zeros((len(q), 2, 4, p)), com)

    def corner_jacobians(self, jacobians: Jacobians, body: Body) -> Array:
        """Jacobians (T, 2, 4, p) of the heights of the corners of the soles."""
        arm = body.corners - body.soles[:, :, None]
        turn = jacobians.soles[:, :, 3:] / self.arm[None, :, None, None]
        z = jacobians.soles[:, :, None, 2]
        return np.asarray(
            z + turn[:, :, None, 0] * arm[..., 1, None] - turn[:, :, None, 1] * arm[..., 0, None]
        )

    @property
    def cart(self) -> Array:
        """Parts of the CoM at three samples in a row in the ZMP between them: (3,)."""
        a = self.com_height / (GRAVITY * self.dt**2)
        return np.array([-a, 1.0 + 2.0 * a, -a])


def _polygons(robot: Robot, stances: Stances) -> tuple[Array, Array]:
    """Faces (T, 8, 2) and bounds (T, 8) of the soles that stand, n . z <= bound, made narrower."""
    n_samples = len(stances.stands)
    normals, bounds = np.zeros((n_samples, N_FACES, 2)), np.ones((n_samples, N_FACES))
    key = np.concatenate(
        [stances.stands, np.where(stances.stands[..., None], stances.places, 0.0).reshape(-1, 6)],
        axis=1,
    )
    _, first, same = np.unique(key, axis=0, return_index=True, return_inverse=True)
    for i, k in enumerate(first):
        corners = [
            sole_corners(stances.places[k, side], spec.length, spec.width)
            for side in Side
            if stances.stands[k, side] and (spec := robot.sole_spec(side))
        ]
        if not corners:
            continue
        hull = convex_hull(np.concatenate(corners))
        edges = np.roll(hull, -1, axis=0) - hull
        n = np.stack([edges[:, 1], -edges[:, 0]], axis=1)
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        width = min(robot.sole_spec(side).width for side in Side)
        margin = min(ZMP_MARGIN, WIDEST_SHARE * 0.5 * width)
        where = np.ravel(same) == i
        normals[where, : len(n)] = n
        bounds[where, : len(n)] = np.sum(n * hull, axis=1) - margin
    return normals, bounds
