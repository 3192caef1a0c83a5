"""Distances of links that come near each other, and their derivatives.

Distances and witness points are those of Coal, through Pinocchio. With the unit vector u from the
nearest point of the first link to that of the second, the distance d changes by
u . (velocity of the second point - velocity of the first).
"""

from __future__ import annotations

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

    samples: NDArray[np.intp]  # (m,)
    distance: Array  # (m,) [m], negative if they overlap
    least: Array  # (m,) distances that they have to keep [m]
    rows: Array  # (m, 6 + n) derivatives of the distances; empty if they were not asked for


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

    def along(self, q: Array, with_rows: bool = True) -> Clearances:
        """The pairs of links that are near each other at every STEP-th sample of q (T, 7 + n)."""
        robot, geometry = self.robot, self.robot.geometry
        data, found = robot.model.createData(), geometry.createData()
        samples, pairs, apart, rows = [], [], [], []
        for k in range(0, len(q), STEP):
            now = distances(robot, data, found, q[k])
            near = np.flatnonzero((now < self.near) & np.isfinite(self.least))
            if len(near) and with_rows:
                pin.computeJointJacobians(robot.model, data, q[k])
                results, all_pairs = found.distanceResults, geometry.collisionPairs
                rows += [self._row(data, all_pairs[int(i)], results[int(i)]) for i in near]
            samples.append(np.full(len(near), k))
            pairs.append(near)
            apart.append(now[near])
        chosen = np.concatenate(pairs)
        return Clearances(
            np.concatenate(samples), np.concatenate(apart), self.least[chosen],
            np.array(rows).reshape(-1, robot.model.nv),
        )  # fmt: skip

    def _row(self, data: pin.Data, pair: pin.CollisionPair, result: object) -> Array:
        robot = self.robot
        points = (result.getNearestPoint1(), result.getNearestPoint2())  # type: ignore[attr-defined]
        u = result.normal  # type: ignore[attr-defined]
        row = np.zeros(robot.model.nv)
        for sign, number, point in ((-1.0, pair.first, points[0]), (1.0, pair.second, points[1])):
            joint = robot.geometry.geometryObjects[number].parentJoint
            J = pin.getJointJacobian(robot.model, data, joint, pin.LOCAL_WORLD_ALIGNED)
            arm = point - data.oMi[joint].translation
            row += sign * (u @ J[:3] + np.cross(arm, u) @ J[3:])
        return row
