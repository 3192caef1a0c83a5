"""Links of a robot that touch each other along a motion."""

from __future__ import annotations

import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.progress import Progress
from mgs.robot import Robot


def first_contact(
    robot: Robot, q: Array, step: int = 1, progress: Progress | None = None
) -> tuple[int, str] | None:
    """The first of every `step`-th configuration at which two links touch that may not.

    Args:
        robot: the robot.
        q: configurations (N, 7 + n).
        step: distance of the configurations that are looked at.
        progress: called with configurations done and all of them.

    Returns:
        Its number, and the names of two links that touch; None: there is none.
    """
    data, geometry = robot.model.createData(), robot.geometry
    geometry_data = geometry.createData()
    # A tree of bounding boxes leaves few pairs to look at and is ten times as fast as all pairs.
    tree = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
        robot.model, geometry, geometry_data
    )
    for k in range(0, len(q), step):
        if progress is not None and k % 500 < step:
            progress(k, len(q))
        if pin.computeCollisions(robot.model, data, tree, q[k], True):
            return k, _touching(robot, q[k])
    return None


def _touching(robot: Robot, q: Array) -> str:
    """Names of the first two links that touch in a configuration (7 + n,)."""
    geometry = robot.geometry
    found = geometry.createData()
    pin.computeCollisions(robot.model, robot.model.createData(), geometry, found, q, True)
    hit = next(i for i, result in enumerate(found.collisionResults) if result.isCollision())
    pair = geometry.collisionPairs[hit]
    return " and ".join(
        robot.model.frames[geometry.geometryObjects[i].parentFrame].name
        for i in (pair.first, pair.second)
    )
