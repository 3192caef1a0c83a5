"""Pairs of links whose shapes always touch, for `ignore_collisions` of robot.yaml."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.robot.limbs import leg_length
from mgs.robot.robot import Robot

Watched = Callable[[str, str], bool]  # whether two links must be kept from touching
NEARBY, N_NEARBY = 0.25, 40  # [rad] range around the posture, number of random postures
STEPPING = 0.15  # [rad] range of the leg joints around the posture in the steps of a slow walk
SWAYING = 0.1  # [rad] range of arms and waist in such a walk
APART = 0.02  # distance of links that do not nearly touch, in leg lengths: hands sway a little


def touching_pairs(robot: Robot, watched: Watched) -> list[tuple[str, str]]:
    """Pairs of links that touch in the posture, or, unless they are `watched`, near the posture.

    Pairs with one link between them are included, because bounding boxes of meshes overlap there,
    for example at an ankle.
    """
    found = set(_across_a_link(robot))
    found |= set(_touching(robot, robot.standing_q))
    for q in _nearby(robot, range(robot.n), NEARBY):
        found |= {pair for pair in _touching(robot, q) if not watched(*pair)}
    return sorted(found)


def nearly_touching(
    robot: Robot, watched: Watched, configurations: Iterable[Array]
) -> list[tuple[str, str]]:
    """Pairs of `watched` links closer than `APART` in one of some configurations (nq,).

    Pairs with one link between them are left out.
    """
    found, near = set(), APART * leg_length(robot)
    for q in configurations:
        found |= {pair for pair in _touching(robot, q, near) if watched(*pair)}
    return sorted(found - set(_across_a_link(robot)))


def steps_on_the_spot(robot: Robot, legs: list[int], sways: bool) -> Iterator[Array]:
    """The posture, and configurations (nq,) of steps.

    Leg joints are at `legs` in the angles; the other joints move too if the robot `sways`.
    """
    yield robot.standing_q
    others = [i for i in range(robot.n) if i not in legs] if sways else []
    swaying = _nearby(robot, others, SWAYING)
    for stepping, q in zip(_nearby(robot, legs, STEPPING), swaying, strict=True):
        yield stepping + q - robot.standing_q


def _nearby(robot: Robot, moving: Iterable[int], reach: float) -> Iterator[Array]:
    """Configurations (nq,) with random angles of some joints, up to `reach` from the posture."""
    rng, at = np.random.default_rng(0), list(moving)
    q = robot.standing_q.copy()
    for _ in range(N_NEARBY):
        near = robot.posture[at] + rng.uniform(-reach, reach, len(at))
        q[FLOATING_BASE_NQ + np.array(at, dtype=int)] = np.clip(
            near, robot.lower[at], robot.upper[at]
        )
        yield q.copy()


def _touching(robot: Robot, q: Array, near: float = 0.0) -> Iterator[tuple[str, str]]:
    """Pairs of links whose shapes are at most `near` apart [m]."""
    geometry = robot.geometry
    data, geometry_data = robot.model.createData(), geometry.createData()
    for request in geometry_data.collisionRequests:
        request.security_margin = near
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
