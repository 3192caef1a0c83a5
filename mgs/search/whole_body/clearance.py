"""Distances of links that come near each other, and their derivatives.

Distances and witness points are those of Coal, through Pinocchio. With the unit vector u from the
nearest point of the first link to that of the second, the distance d changes by
u . (velocity of the second point - velocity of the first).
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.robot import Robot

STEP = 5  # samples between those that are looked at: distances change slowly
NEAR = 0.1  # of a leg's length: pairs that are farther apart are left out
KEPT = 0.9  # part of its least distance in the plan that a pair keeps, if that is below CLEAR
CLEAR = 0.005  # [m]


@dataclass(frozen=True, eq=False)
class Clearances:
    """Pairs of links that are near each other, one at one sample in each row."""

    robot: Robot
    q: Array  # (T, 7 + n)
    samples: NDArray[np.intp]  # (m,)
    pairs: NDArray[np.intp]  # (m,) of the robot's geometry
    distance: Array  # (m,) [m], negative if they overlap
    least: Array  # (m,) distances that they have to keep [m]
    nearest: Array  # (m, 2, 3) points of both links [m]
    normal: Array  # (m, 3) unit vectors from the first link to the second

    @functools.cached_property
    def rows(self) -> Array:
        """Derivatives (m, 6 + n) of the distances."""
        model, data, geometry = self.robot.model, self.robot.model.createData(), self.robot.geometry
        joints = np.array([
            [geometry.geometryObjects[i].parentJoint for i in (pair.first, pair.second)]
            for pair in geometry.collisionPairs
        ])[self.pairs]  # fmt: skip
        J = np.empty((len(self.samples), 2, 6, model.nv))
        centres = np.empty((len(self.samples), 2, 3))
        last = -1
        for row, (k, both) in enumerate(zip(self.samples, joints.tolist(), strict=True)):
            if k != last:
                pin.computeJointJacobians(model, data, self.q[k])
                last = k
            for side, joint in enumerate(both):
                J[row, side] = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)
                centres[row, side] = data.oMi[joint].translation
        lever = np.cross(self.nearest - centres, self.normal[:, None])
        by_move = np.concatenate(
            [np.broadcast_to(self.normal[:, None], lever.shape), lever], axis=2
        )
        by_link = (by_move[:, :, None] @ J)[:, :, 0]
        return np.asarray(by_link[:, 1] - by_link[:, 0])


def distances(robot: Robot, data: pin.Data, found: pin.GeometryData, q: Array) -> Array:
    """Distance of each pair of links in a configuration q (7 + n,) [m]; `found` has the details."""
    pin.updateGeometryPlacements(robot.model, data, robot.geometry, found, q)
    pin.computeDistances(robot.geometry, found)
    return np.array([result.min_distance for result in found.distanceResults])


class Clearance:
    """The distances that the links of a robot have to keep."""

    def __init__(self, robot: Robot, plan: Array, leg: float) -> None:
        self.robot, self.near = robot, NEAR * leg
        data, found = robot.model.createData(), robot.geometry.createData()
        planned = np.min([distances(robot, data, found, q) for q in plan[::STEP]], axis=0)
        # links that touch in the plan are not kept apart
        self.least = np.where(planned > 0.0, np.minimum(CLEAR, KEPT * planned), -np.inf)

    def along(self, q: Array) -> Clearances:
        """The pairs of links that are near each other at every STEP-th sample of q (T, 7 + n)."""
        robot = self.robot
        data, found = robot.model.createData(), robot.geometry.createData()
        samples, pairs, apart, points, normals = [], [], [], [], []
        for k in range(0, len(q), STEP):
            now = distances(robot, data, found, q[k])
            near = np.flatnonzero((now < self.near) & np.isfinite(self.least))
            results = found.distanceResults
            for i in near:
                result = results[int(i)]
                ends = result.getNearestPoint1(), result.getNearestPoint2()
                points.append(np.array(ends))  # a copy: the next configuration overwrites them
                normals.append(np.array(result.normal))
            samples.append(np.full(len(near), k))
            pairs.append(near)
            apart.append(now[near])
        chosen = np.concatenate(pairs)
        return Clearances(
            robot, q, np.concatenate(samples), chosen, np.concatenate(apart), self.least[chosen],
            np.array(points).reshape(-1, 2, 3), np.array(normals).reshape(-1, 3),
        )  # fmt: skip
