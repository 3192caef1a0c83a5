"""Collision shapes of a robot: the pairs of links that must not touch, and bounding boxes."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.robot.pinocchio_urdf import bounded, call_parser

UNIT_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])  # of a box


def shape_corners(geometry: pin.GeometryModel) -> Array:
    """Corners (b, 8, 3) of the box around every collision shape, in the shape's frame [m]."""
    corners = []
    for item in geometry.geometryObjects:
        item.geometry.computeLocalAABB()
        box = item.geometry.aabb_local
        low, high = np.ravel(box.min_), np.ravel(box.max_)
        corners.append(low + UNIT_CORNERS * (high - low))
    return np.array(corners)


def collision_geometry(
    model: pin.Model, urdf: str, ignored: Iterable[Iterable[str]], source: str
) -> pin.GeometryModel:
    """Collision shapes of a URDF text, with every pair of links that must not touch.

    Pairs on the same joint or on neighbouring joints are left out, and the `ignored` pairs.

    Raises:
        ConfigError: Pinocchio cannot read the shapes; `source` names the URDF.
    """
    with tempfile.TemporaryDirectory() as folder:  # Pinocchio reads geometry from files only
        path = Path(folder) / "robot.urdf"
        path.write_text(bounded(urdf, source), encoding="utf-8")
        geometry = call_parser(
            lambda: pin.buildGeomFromUrdf(model, str(path), pin.GeometryType.COLLISION), source
        )
    bodies = [model.frames[g.parentFrame] for g in geometry.geometryObjects]
    may_touch = {frozenset(pair) for pair in ignored}
    for i, a in enumerate(bodies):
        for j, b in enumerate(bodies[:i]):
            if not _are_adjacent(model, a, b) and frozenset((a.name, b.name)) not in may_touch:
                geometry.addCollisionPair(pin.CollisionPair(j, i))
    return geometry


def _are_adjacent(model: pin.Model, a: pin.Frame, b: pin.Frame) -> bool:
    joint_a, joint_b = a.parentJoint, b.parentJoint
    return bool(
        joint_a == joint_b or joint_a == model.parents[joint_b] or joint_b == model.parents[joint_a]
    )
