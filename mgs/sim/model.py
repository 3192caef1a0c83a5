"""The robot as physics engines get it: a plain URDF written from Pinocchio's model.

Written anew rather than passed on, because importers stumble over what robots' URDFs contain:
frame-only links (PyBullet makes them 1 kg), fixed joints (PyBullet's own merging shifts the CoM),
mesh files and names: engines reserve some, such as `world`. Pinocchio has merged fixed links
already, so one link is left per moving joint; links and joints are numbered. Contact shapes: of the
feet the sole rectangle of robot.yaml as a flat box, of all other links their primitive shapes.
"""

from __future__ import annotations

from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin

from mgs.core.contact import Side
from mgs.robot import Robot
from mgs.robot.urdf_text import Shape, add_link, add_revolute, joint_axis, numbers

BASE_LINK = "base"
SOLE_THICKNESS = 0.1  # of the sole box, relative to the shorter side of the sole


def simulation_urdf(robot: Robot) -> str:
    """URDF text with one link per joint, in Pinocchio's link frames and order."""
    root = ElementTree.Element("robot", name=robot.spec.name)
    shapes = _contact_shapes(robot)
    for joint in range(1, robot.model.njoints):
        add_link(root, link_name(joint), robot.model.inertias[joint], shapes[joint])
    for i in range(robot.n):
        _add_joint(root, robot, i)
    ElementTree.indent(root)  # PyBullet reads by lines and spoils those beyond 8 kB
    return ElementTree.tostring(root, encoding="unicode")


def link_name(joint: int) -> str:
    """Name in the simulation URDF of the link that Pinocchio's joint `joint` moves."""
    return BASE_LINK if joint == 1 else f"link_{joint - 2}"


def joint_names(robot: Robot) -> list[str]:
    """Names in the simulation URDF of the joints, in the order of `Robot.joint_names`."""
    return [f"joint_{i}" for i in range(robot.n)]


def _add_joint(root: ElementTree.Element, robot: Robot, i: int) -> None:
    model, joint = robot.model, i + 2
    links = link_name(model.parents[joint]), link_name(joint)
    limits = (robot.lower[i], robot.upper[i], robot.torque_limit[i], robot.speed_limit[i])
    placement, axis = model.jointPlacements[joint], joint_axis(model, joint)
    add_revolute(root, joint_names(robot)[i], links, placement, axis, limits)


def _contact_shapes(robot: Robot) -> list[list[Shape]]:
    shapes: list[list[Shape]] = [[] for _ in robot.model.names]
    for geometry in robot.geometry.geometryObjects:
        primitive = _primitive(geometry.geometry)
        if primitive is not None:
            shapes[geometry.parentJoint].append((geometry.placement, *primitive))
    soles = [robot.model.frames[frame] for frame in robot.sole_frames]
    for sole in soles:
        shapes[sole.parentJoint] = []
    for side, sole in zip(Side, soles, strict=True):
        spec = robot.sole_spec(side)
        thickness = SOLE_THICKNESS * min(spec.length, spec.width)
        placement = sole.placement * pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.5 * thickness]))
        size = {"size": numbers([spec.length, spec.width, thickness])}
        shapes[sole.parentJoint].append((placement, "box", size))
    return shapes


def _primitive(shape: coal.CollisionGeometry) -> tuple[str, dict[str, str]] | None:
    if isinstance(shape, coal.Box):
        return "box", {"size": numbers(2.0 * shape.halfSide)}
    if isinstance(shape, coal.Sphere):
        return "sphere", {"radius": repr(float(shape.radius))}
    if isinstance(shape, coal.Cylinder | coal.Capsule):
        size = {"radius": float(shape.radius), "length": 2.0 * float(shape.halfLength)}
        kind = type(shape).__name__.lower()
        return kind, {key: repr(value) for key, value in size.items()}
    return None
