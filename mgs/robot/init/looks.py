"""What bodies look like: the visual meshes of a URDF, kept by name for pages and viewers.

No command needs these files. `mgs report --meshes DIR` shows them, and without them the collision
shapes.
"""

from __future__ import annotations

from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from mgs.robot.init.skeleton import Skeleton
from mgs.robot.urdf_text import add_origin


@dataclass(frozen=True, eq=False)
class Look:
    """A mesh by its name, at a place in the frame of its body."""

    placement: pin.SE3
    mesh: dict[str, str]  # attributes of the element `mesh`
    colour: str | None  # red, green, blue, opacity; None: the file names none

    def add_to(self, link: ElementTree.Element) -> None:
        """Append the visual element to a link of a URDF."""
        visual = ElementTree.SubElement(link, "visual")
        add_origin(visual, self.placement)
        ElementTree.SubElement(ElementTree.SubElement(visual, "geometry"), "mesh", self.mesh)
        if self.colour is not None:
            material = ElementTree.SubElement(visual, "material", name=f"rgba {self.colour}")
            ElementTree.SubElement(material, "color", rgba=self.colour)


def find_looks(skeleton: Skeleton, root: ElementTree.Element) -> list[list[Look]]:
    """Visual meshes of each body; those of links that are fixed to it are its own.

    Names that are absolute paths are left out, since they mean nothing on another machine.
    """
    model = skeleton.model
    colours = {
        material.get("name"): element.get("rgba")
        for material in root.iter("material")
        for element in material.findall("color")
    }
    looks: list[list[Look]] = [[] for _ in range(model.njoints)]
    for link in root.findall("link"):
        name = link.get("name", "")
        if not model.existBodyName(name):
            continue
        frame = model.frames[model.getBodyId(name)]
        for visual in link.findall("visual"):
            mesh = visual.find("geometry/mesh")
            file = "" if mesh is None else mesh.get("filename", "")
            if mesh is None or not file or file.startswith(("/", "file:")):
                continue
            material = visual.find("material")
            colour = None if material is None else colours.get(material.get("name"))
            placement = frame.placement * _origin(visual.find("origin"))
            looks[frame.parentJoint].append(Look(placement, dict(mesh.attrib), colour))
    return looks


def _origin(element: ElementTree.Element | None) -> pin.SE3:
    given = {} if element is None else element.attrib
    xyz, rpy = (np.array(given.get(key, "0 0 0").split(), dtype=float) for key in ("xyz", "rpy"))
    return pin.SE3(pin.rpy.rpyToMatrix(rpy), xyz)
