"""What the links of a robot look like: the visual shapes of its URDF, for a page.

A mesh is read only from inside a folder that the caller names. A name in a URDF, which may come
from a motion file of somebody else, cannot lead out of that folder. A link whose meshes cannot be
shown is drawn by its collision shapes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from mgs.core.geometry import quat_xyzw_from_rpy
from mgs.report.page.meshes import MeshError, Meshes
from mgs.robot import Robot

GREY = (0.62, 0.64, 0.67, 1.0)
SIZES = {
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
}


@dataclass(eq=False)
class Shapes:
    """Shapes of all links as plain data, and remarks on what could not be shown."""

    items: list[dict[str, Any]] = field(default_factory=list)
    meshes: list[dict[str, Any]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def robot_shapes(robot: Robot, mesh_folder: Path | None) -> Shapes:
    """Shapes of a robot.

    Args:
        robot: the robot.
        mesh_folder: folder that contains all meshes; None: meshes are not read.
    """
    root = ElementTree.fromstring(robot.urdf)
    colours = dict(_named_colours(root))
    found, meshes, replaced = Shapes(), Meshes(mesh_folder), 0
    for link in root.findall("link"):
        visual, missing = _shapes_of(link, "visual", colours, meshes)
        if missing or not visual:
            instead, _ = _shapes_of(link, "collision", colours, None)
            replaced += missing
            visual = instead or visual
        found.items += [{"link": link.get("name", ""), **shape} for shape in visual]
    found.meshes = meshes.packed()
    if replaced:
        why = meshes.problem or "no folder of meshes was given (--meshes)"
        found.notes.append(f"{replaced} meshes are replaced by collision shapes: {why}")
    return found


def _shapes_of(
    link: ElementTree.Element, tag: str, colours: dict[str, list[float]], meshes: Meshes | None
) -> tuple[list[dict[str, Any]], int]:
    """Shapes of a link, and the number of those that cannot be shown."""
    shapes, missing = [], 0
    for element in link.findall(tag):
        geometry = element.find("geometry")
        for item in () if geometry is None else geometry:
            try:
                content = _content(item, meshes)
                pose = _pose(element.find("origin"))
            except (ValueError, MeshError):
                missing += 1
                continue
            colour = _colour(element.find("material"), colours)
            shapes.append({"pose": pose, "colour": colour, **content})
    return shapes, missing


def _content(item: ElementTree.Element, meshes: Meshes | None) -> dict[str, Any]:
    if item.tag in SIZES:
        sizes = [x for name in SIZES[item.tag] for x in _floats(item.get(name, ""))]
        if len(sizes) != (3 if item.tag == "box" else len(SIZES[item.tag])):
            raise ValueError(f"{item.tag} has a wrong number of sizes")
        return {"kind": item.tag, "size": [abs(x) for x in sizes]}
    if item.tag != "mesh" or meshes is None:
        raise ValueError(f"{item.tag} is not a shape that can be shown")
    scale = _floats(item.get("scale", "1 1 1"))
    if len(scale) != 3:
        raise ValueError("a scale has three numbers")
    return {"kind": "mesh", "mesh": meshes.add(item.get("filename", "")), "size": scale}


def _pose(origin: ElementTree.Element | None) -> list[float]:
    """Position [m] and quaternion xyzw (7,)."""
    given = {} if origin is None else origin.attrib
    xyz, rpy = (_floats(given.get(name, "0 0 0")) for name in ("xyz", "rpy"))
    if len(xyz) != 3 or len(rpy) != 3:
        raise ValueError("an origin has three coordinates and three angles")
    return [*xyz, *quat_xyzw_from_rpy(rpy).tolist()]


def _floats(text: str) -> list[float]:
    values = [float(part) for part in text.split()]
    if not all(math.isfinite(value) for value in values):
        raise ValueError(f"{text!r} is not finite")
    return values


def _named_colours(root: ElementTree.Element) -> Iterator[tuple[str, list[float]]]:
    for material in root.iter("material"):
        own = _own_colour(material)
        if own is not None:
            yield material.get("name", ""), own


def _own_colour(material: ElementTree.Element) -> list[float] | None:
    element = material.find("color")
    if element is None:
        return None
    try:
        rgba = [min(max(x, 0.0), 1.0) for x in _floats(element.get("rgba", ""))]
    except ValueError:
        return None
    return rgba if len(rgba) == 4 else None


def _colour(material: ElementTree.Element | None, colours: dict[str, list[float]]) -> list[float]:
    if material is None:
        return list(GREY)
    own = _own_colour(material)
    return own if own is not None else colours.get(material.get("name", ""), list(GREY))
