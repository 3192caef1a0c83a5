"""What a repaired motion has to hold, as residuals with their Jacobians, sample by sample.

    pose    the sole that stands is at its place, level, on the floor           r = 0
    floor   no corner of a sole is below the floor; one that swings is above it r <= 0
    range   joints are inside their ranges                                      r <= 0
    speed   joints are not faster than their servos, from sample to sample      r <= 0
    zmp     the ZMP of the whole robot is inside the soles that bear            r <= 0

A sole bears as long as it stands, but for the first and last moments: the ZMP does not jump.
Lengths are in m, angles in rad; rotations of soles count by half their length, so that they are
lengths too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

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
from mgs.judge.audit.body import SMOOTHING_TIME, Body
from mgs.motion.dynamics import zmp_at
from mgs.robot import Robot
from mgs.search.repair.stances import Bools, Stances

N_FACES = 8  # of the hull of two rectangles
RANGE_MARGIN = 2e-3  # [rad]
SPEED_SHARE = 0.99  # of the limit
ZMP_MARGIN = 0.005  # [m]
CLEARANCE = 8e-3  # [m] of a sole that swings, since one that skims the floor may touch it
RISE_TIME = 0.06  # [s] in which a sole reaches this clearance
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
    com: Array  # (T, 3, p)
    com_at: Array  # (T, 3) the CoM itself [m]
    turning: Array  # (T, 2, p) L_y / m and -L_x / m, L angular momentum about the CoM, by speeds

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
        self.normals, self.bounds = _polygons(robot, stances, bearing_soles(stances.stands, dt))
        away = np.stack([_steps_from(stances.stands[:, side]) for side in Side], axis=1) * dt
        self.clearance = CLEARANCE * np.minimum(1.0, away / RISE_TIME)

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
        low = self.clearance[..., None] - body.corners[..., 2]
        floor = np.where(stands[..., None], -1.0, low)
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
        soles, com = np.empty((len(q), 2, 6, p)), np.empty((len(q), 3, p))
        turning, com_at = np.empty((len(q), 2, p)), np.empty((len(q), 3))
        for k in range(len(q)):
            com[k] = pin.jacobianCenterOfMass(model, data, q[k], False)
            com_at[k] = data.com[0]
            momentum = pin.computeCentroidalMap(model, data, q[k])
            turning[k] = np.stack([momentum[4], -momentum[3]]) / robot.mass
            pin.updateFramePlacements(model, data)
            for side in Side:
                soles[k, side] = pin.getFrameJacobian(
                    model, data, robot.sole_frames[side], pin.LOCAL_WORLD_ALIGNED
                )
        soles[:, :, 3:] *= self.arm[None, :, None, None]
        return Jacobians(soles, np.zeros((len(q), 2, 4, p)), com, com_at, turning)

    def corner_jacobians(self, jacobians: Jacobians, body: Body) -> Array:
        """Jacobians (T, 2, 4, p) of the heights of the corners of the soles."""
        arm = body.corners - body.soles[:, :, None]
        turn = jacobians.soles[:, :, 3:] / self.arm[None, :, None, None]
        z = jacobians.soles[:, :, None, 2]
        return np.asarray(
            z + turn[:, :, None, 0] * arm[..., 1, None] - turn[:, :, None, 1] * arm[..., 0, None]
        )

    def zmp_jacobians(self, jacobians: Jacobians, body: Body, k: NDArray[np.intp]) -> list[Array]:
        """Jacobians (m, 2, p) of the ZMP at samples k (m,): of the sample before, k, and the next.

        With the CoM c and the angular momentum L = A(q) v about it (D. E. Orin, A. Goswami and
        S.-H. Lee, "Centroidal dynamics of a humanoid robot", Autonomous Robots 35, 2013), both with
        second differences, and near c''_z = 0:

            zmp = c - (c_z c'' + (L'_y, -L'_x) / m) / (g + c''_z)
        """
        lever = (zmp_at(body.wrench, np.zeros(len(body.wrench))) - jacobians.com_at[:, :2])[k]
        height = jacobians.com_at[k, 2, None, None]
        second = np.array([1.0, -2.0, 1.0]) / (GRAVITY * self.dt**2)
        found = []
        for i in (-1, 0, 1):
            com = jacobians.com[k + i]
            moved = height * com[:, :2] + lever[:, :, None] * com[:, 2:] + jacobians.turning[k]
            found.append(float(i == 0) * com[:, :2] - second[i + 1] * moved)
        return found


def bearing_soles(stands: Bools, dt: float) -> Bools:
    """Which soles (T, 2) stand for as long before and after as the audit averages forces."""
    half = max(1, round(SMOOTHING_TIME / dt)) // 2
    bears = stands.copy()
    for shift in range(1, half + 1):
        bears[shift:] &= stands[:-shift]
        bears[:-shift] &= stands[shift:]
    alone = ~bears.any(axis=1)
    bears[alone] = stands[alone]
    return bears


def _steps_from(mask: Bools) -> Array:
    """Number of samples (T,) from each sample to the nearest one at which a mask (T,) is true."""
    k, where = np.arange(len(mask)), np.flatnonzero(mask)
    if not len(where):
        return np.full(len(mask), np.inf)
    after = np.minimum(np.searchsorted(where, k), len(where) - 1)
    before = np.maximum(after - 1, 0)
    return np.minimum(np.abs(where[after] - k), np.abs(where[before] - k)).astype(float)


def _polygons(robot: Robot, stances: Stances, bears: Bools) -> tuple[Array, Array]:
    """Faces (T, 8, 2) and bounds (T, 8) of the soles that bear, n . z <= bound, made narrower."""
    n_samples = len(bears)
    normals, bounds = np.zeros((n_samples, N_FACES, 2)), np.ones((n_samples, N_FACES))
    key = np.concatenate(
        [bears, np.where(bears[..., None], stances.places, 0.0).reshape(-1, 6)], axis=1
    )
    _, first, same = np.unique(key, axis=0, return_index=True, return_inverse=True)
    for i, k in enumerate(first):
        corners = [
            sole_corners(stances.places[k, side], spec.length, spec.width)
            for side in Side
            if bears[k, side] and (spec := robot.sole_spec(side))
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
