"""Links that touch each other although they must not."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mgs.core.progress import Progress
from mgs.judge.audit.finding import Finding, findings_where
from mgs.judge.audit.given import GivenMotion

LOOK_TIME = 0.01  # [s] between two looks
CONTACT_LIMIT = 0.001  # [m] that two links may overlap, since rounded angles move links by less


def collision_findings(given: GivenMotion, progress: Progress | None = None) -> list[Finding]:
    """Spans in which two links overlap; the depth is that of the deepest pair."""
    robot, geometry = given.robot, given.robot.geometry
    data, geometry_data = robot.model.createData(), geometry.createData()
    # A tree of bounding boxes leaves few pairs to look at and is ten times as fast as all pairs.
    tree = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
        robot.model, geometry, geometry_data
    )
    stride = max(1, round(LOOK_TIME / given.dt))
    depth, names = np.zeros(given.n_samples), [""] * given.n_samples
    for k in range(0, given.n_samples, stride):
        if progress is not None and k % 500 < stride:
            progress(k, given.n_samples)
        if pin.computeCollisions(robot.model, data, tree, given.q[k], True):
            depth[k : k + stride], name = _deepest(given, k)
            names[k : k + stride] = [name] * len(names[k : k + stride])
    return findings_where("self_collision", depth, CONTACT_LIMIT, given.dt, "m", lambda k: names[k])


def _deepest(given: GivenMotion, k: int) -> tuple[float, str]:
    """Depth [m] of the pair of links that overlap most at sample k, and their names."""
    robot, geometry = given.robot, given.robot.geometry
    data, found = robot.model.createData(), geometry.createData()
    pin.computeCollisions(robot.model, data, geometry, found, given.q[k], False)
    hits = [i for i, result in enumerate(found.collisionResults) if result.isCollision()]
    if not hits:
        return 0.0, ""
    depths = [-float(pin.computeDistance(geometry, found, i).min_distance) for i in hits]
    pair = geometry.collisionPairs[hits[int(np.argmax(depths))]]
    names = (
        robot.model.frames[geometry.geometryObjects[i].parentFrame].name
        for i in (pair.first, pair.second)
    )
    return max(depths), " and ".join(names)
