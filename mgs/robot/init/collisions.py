"""Pairs of links whose shapes always touch, for `ignore_collisions` of robot.yaml."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pinocchio as pin

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.robot.robot import Robot

NEARBY, N_NEARBY = 0.25, 40  # [rad] range around the posture, number of random postures


def touching_pairs(robot: Robot, watched: set[str]) -> list[tuple[str, str]]:
    """Pairs of links that touch in the posture, or, unless both are `watched`, near the posture.

    Pairs with one link between them are included, because bounding boxes of meshes overlap there,
    for example at an ankle.
    """
    found = set(_across_a_link(robot))
    rng = np.random.default_rng(0)
    q = robot.standing_q.copy()
    found |= set(_touching(robot, q))
    for _ in range(N_NEARBY):
        shift = rng.uniform(-NEARBY, NEARBY, robot.n)
        q[FLOATING_BASE_NQ:] = np.clip(robot.posture + shift, robot.lower, robot.upper)
        found |= {pair for pair in _touching(robot, q) if not set(pair) <= watched}
    return sorted(found)


def _touching(robot: Robot, q: pin.Data) -> Iterator[tuple[str, str]]:
    geometry = robot.geometry
    data, geometry_data = robot.model.createData(), geometry.createData()
    pin.computeCollisions(robot.model, data, geometry, geometry_data, q, False)
    for pair, result in zip(geometry.collisionPairs, geometry_data.collisionResults, strict=True):
        if result.isCollision():
            yield _links(robot, pair)


def _across_a_link(robot: Robot) -> Iterator[tuple[str, str]]:
    parents = robot.model.parents
    for pair in robot.geometry.collisionPairs:
        objects = (robot.geometry.geometryObjects[i] for i in (pair.first, pair.second))
        a, b = (int(shape.parentJoint) for shape in objects)
        if int(parents[parents[a]]) == b or int(parents[parents[b]]) == a:
            yield _links(robot, pair)


def _links(robot: Robot, pair: pin.CollisionPair) -> tuple[str, str]:
    first, second = (
        str(robot.model.frames[robot.geometry.geometryObjects[i].parentFrame].name)
        for i in (pair.first, pair.second)
    )
    return first, second
