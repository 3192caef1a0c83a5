"""Writing of URDF elements from Pinocchio data: links, joints and placements."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array

Shape = tuple[pin.SE3, str, dict[str, str]]  # placement in the link, element, its attributes


def add_link(
    root: ElementTree.Element, name: str, inertia: pin.Inertia, shapes: Iterable[Shape]
) -> ElementTree.Element:
    """Append a link with its inertia (about its CoM, in the axes of the link) and its shapes."""
    link = ElementTree.SubElement(root, "link", name=name)
    add_inertial(link, inertia)
    for number, (placement, kind, size) in enumerate(shapes):
        collision = ElementTree.SubElement(link, "collision", name=f"{name}_{number}")
        add_origin(collision, placement)
        ElementTree.SubElement(ElementTree.SubElement(collision, "geometry"), kind, size)
    return link


def add_inertial(link: ElementTree.Element, inertia: pin.Inertia) -> None:
    """Append the inertia of a link, about its CoM and in the axes of the link."""
    inertial = ElementTree.SubElement(link, "inertial")
    add_origin(inertial, pin.SE3(np.eye(3), inertia.lever))
    ElementTree.SubElement(inertial, "mass", value=repr(float(inertia.mass)))
    entries = {
        f"i{'xyz'[i]}{'xyz'[j]}": repr(float(inertia.inertia[i, j]))
        for i in range(3)
        for j in range(i, 3)
    }
    ElementTree.SubElement(inertial, "inertia", entries)


def add_revolute(
    root: ElementTree.Element,
    name: str,
    links: tuple[str, str],
    placement: pin.SE3,
    axis: Array,
    limits: tuple[float, float, float, float],
) -> ElementTree.Element:
    """Append a revolute joint, which is returned.

    Args:
        root: robot element of the URDF.
        name: name of the joint.
        links: names of the parent link and the child link.
        placement: pose of the child link in the frame of the parent link at angle 0.
        axis: joint axis (3,) in the frame of the child link.
        limits: lower, upper [rad], effort [N m], velocity [rad/s].
    """
    element = ElementTree.SubElement(root, "joint", name=name, type="revolute")
    ElementTree.SubElement(element, "parent", link=links[0])
    ElementTree.SubElement(element, "child", link=links[1])
    add_origin(element, placement)
    ElementTree.SubElement(element, "axis", xyz=numbers(axis))
    keys = ("lower", "upper", "effort", "velocity")
    values = {key: repr(float(value)) for key, value in zip(keys, limits, strict=True)}
    ElementTree.SubElement(element, "limit", values)
    return element


def add_origin(parent: ElementTree.Element, placement: pin.SE3) -> None:
    """Append a placement as an origin element with xyz [m] and rpy [rad]."""
    rpy = pin.rpy.matrixToRpy(placement.rotation)
    ElementTree.SubElement(parent, "origin", xyz=numbers(placement.translation), rpy=numbers(rpy))


def joint_axis(model: pin.Model, joint: int) -> Array:
    """Axis (3,) of a revolute joint in the frame of the link that it moves."""
    kind = model.joints[joint]
    data = kind.createData()
    kind.calc(data, np.zeros(kind.nq), np.zeros(kind.nv))
    return np.asarray(data.S, dtype=float).reshape(6)[3:]


def numbers(values: Array | list[float]) -> str:
    """Numbers as the text of an attribute, in full precision."""
    return " ".join(repr(float(value)) for value in values)
