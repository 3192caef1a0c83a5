"""The robot as physics engines get it: a plain URDF written from Pinocchio's model.

Written anew rather than passed on, because importers stumble over what robots' URDFs contain:
frame-only links (PyBullet makes them 1 kg), fixed joints (PyBullet's own merging shifts the CoM)
and mesh files. Pinocchio has merged fixed links already, so one link is left per moving joint,
named after the joint that moves it. Contact shapes: of the feet the sole rectangle of robot.yaml as
a flat box, of all other links their primitive shapes; meshes are left out and fall through the
ground.
"""

from __future__ import annotations

from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.contact import Side
from mgs.robot import Robot

Array = NDArray[np.float64]
BASE_LINK = "base"
SOLE_THICKNESS = 0.1  # of the sole box, relative to the shorter side of the sole


def simulation_urdf(robot: Robot) -> str:
    """URDF text with one link per joint, in Pinocchio's link frames and order."""
    root = ElementTree.Element("robot", name=robot.spec.name)
    shapes = _contact_shapes(robot)
    for joint in range(1, robot.model.njoints):
        _add_link(root, link_name(robot, joint), robot.model.inertias[joint], shapes[joint])
    for i in range(robot.n):
        _add_joint(root, robot, i)
    ElementTree.indent(root)  # PyBullet reads by lines and spoils those beyond 8 kB
    return ElementTree.tostring(root, encoding="unicode")


def link_name(robot: Robot, joint: int) -> str:
    """Name in the simulation URDF of the link that Pinocchio's joint `joint` moves."""
    return BASE_LINK if joint == 1 else str(robot.model.names[joint])


def _add_link(
    root: ElementTree.Element,
    name: str,
    inertia: pin.Inertia,
    shapes: list[tuple[pin.SE3, str, dict[str, str]]],
) -> None:
    link = ElementTree.SubElement(root, "link", name=name)
    inertial = ElementTree.SubElement(link, "inertial")
    _add_origin(inertial, pin.SE3(np.eye(3), inertia.lever))
    ElementTree.SubElement(inertial, "mass", value=repr(float(inertia.mass)))
    entries = {
        f"i{'xyz'[i]}{'xyz'[j]}": repr(float(inertia.inertia[i, j]))
        for i in range(3)
        for j in range(i, 3)
    }
    ElementTree.SubElement(inertial, "inertia", entries)
    for number, (placement, kind, size) in enumerate(shapes):
        collision = ElementTree.SubElement(link, "collision", name=f"{name}_{number}")
        _add_origin(collision, placement)
        ElementTree.SubElement(ElementTree.SubElement(collision, "geometry"), kind, size)


def _add_joint(root: ElementTree.Element, robot: Robot, i: int) -> None:
    model, joint = robot.model, i + 2
    element = ElementTree.SubElement(root, "joint", name=robot.joint_names[i], type="revolute")
    ElementTree.SubElement(element, "parent", link=link_name(robot, model.parents[joint]))
    ElementTree.SubElement(element, "child", link=link_name(robot, joint))
    _add_origin(element, model.jointPlacements[joint])
    ElementTree.SubElement(element, "axis", xyz=_numbers(joint_axis(model, joint)))
    limits = (robot.lower[i], robot.upper[i], robot.torque_limit[i], robot.speed_limit[i])
    keys = ("lower", "upper", "effort", "velocity")
    values = {key: repr(float(value)) for key, value in zip(keys, limits, strict=True)}
    ElementTree.SubElement(element, "limit", values)


def joint_axis(model: pin.Model, joint: int) -> Array:
    """Axis (3,) of a revolute joint in the frame of the link that it moves."""
    kind = model.joints[joint]
    data = kind.createData()
    kind.calc(data, np.zeros(1), np.zeros(1))
    return np.asarray(data.S, dtype=float).reshape(6)[3:]


def _contact_shapes(robot: Robot) -> list[list[tuple[pin.SE3, str, dict[str, str]]]]:
    shapes: list[list[tuple[pin.SE3, str, dict[str, str]]]] = [[] for _ in robot.model.names]
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
        size = {"size": _numbers([spec.length, spec.width, thickness])}
        shapes[sole.parentJoint].append((placement, "box", size))
    return shapes


def _primitive(shape: coal.CollisionGeometry) -> tuple[str, dict[str, str]] | None:
    if isinstance(shape, coal.Box):
        return "box", {"size": _numbers(2.0 * shape.halfSide)}
    if isinstance(shape, coal.Sphere):
        return "sphere", {"radius": repr(float(shape.radius))}
    if isinstance(shape, coal.Cylinder | coal.Capsule):
        size = {"radius": float(shape.radius), "length": 2.0 * float(shape.halfLength)}
        kind = type(shape).__name__.lower()
        return kind, {key: repr(value) for key, value in size.items()}
    return None


def _add_origin(parent: ElementTree.Element, placement: pin.SE3) -> None:
    rpy = pin.rpy.matrixToRpy(placement.rotation)
    ElementTree.SubElement(parent, "origin", xyz=_numbers(placement.translation), rpy=_numbers(rpy))


def _numbers(values: Array | list[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
