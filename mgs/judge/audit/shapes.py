"""Lowest points of the collision shapes of a robot along a trajectory."""

from __future__ import annotations

import coal
import numpy as np

from mgs.core.arrays import Array
from mgs.judge.audit.tree import JointPoses
from mgs.robot import Robot, shape_corners


def lowest_points(robot: Robot, poses: JointPoses) -> Array:
    """Height (T, G) of the lowest point of every collision shape [m].

    Exact for boxes, spheres, capsules, cylinders and meshes; other shapes count as the boxes
    around them.
    """
    objects = robot.geometry.geometryObjects
    heights = np.empty((poses.p.shape[1], len(objects)))
    boxes = shape_corners(robot.geometry)
    for g, item in enumerate(objects):
        row = poses.R[item.parentJoint][:, 2]  # z of the axes of the joint, (T, 3)
        centre = poses.p[item.parentJoint][:, 2] + row @ item.placement.translation
        heights[:, g] = centre + _reach(item, row @ item.placement.rotation, boxes[g])
    return heights


def _reach(item: object, row: Array, box: Array) -> Array:
    """Height (T,) of the lowest point of a shape above its origin, row (T, 3) being z of its axes.

    Args:
        item: the geometry object of Pinocchio.
        row: z components of the axes of the shape.
        box: (8, 3) corners of the box around it, in its frame [m].
    """
    shape = item.geometry  # type: ignore[attr-defined]
    side = np.hypot(row[:, 0], row[:, 1])
    if isinstance(shape, coal.Sphere):
        return np.full(len(row), -float(shape.radius))
    if isinstance(shape, coal.Capsule):
        return np.asarray(-np.abs(row[:, 2]) * shape.halfLength - shape.radius)
    if isinstance(shape, coal.Cylinder):
        return np.asarray(-np.abs(row[:, 2]) * shape.halfLength - side * shape.radius)
    points = box
    if isinstance(shape, coal.ConvexBase):
        points = np.asarray(shape.points())
    elif isinstance(shape, coal.BVHModelBase):
        points = np.asarray(shape.vertices())
    return np.asarray((row @ points.T).min(axis=1))
