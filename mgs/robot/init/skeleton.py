"""A source URDF as Pinocchio's model, with the surface points of every body."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.errors import ConfigError
from mgs.robot.init.points import Surface, Surfaces
from mgs.robot.init.source import Source

BASE = 1  # Pinocchio's joint of the floating base, and the body that it carries


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Bodies, named by the Pinocchio joint that moves them; a body is all links fixed together.

    `at_rest` is the posture with every joint at 0, or at the end of its range that is nearest to
    it; `placements` are poses of the bodies in the base frame then.
    """

    model: pin.Model
    links: list[list[str]]  # of every body
    surfaces: list[list[tuple[str, pin.SE3, Surface]]]  # of every body: link, its pose in the body
    missing: list[str]  # mesh files that were not found
    at_rest: Array  # (nq,)
    placements: list[pin.SE3]

    def points(self, body: int) -> Array:
        """Surface of a body (N, 3) in its own frame; its origin where it has no shape."""
        found = [
            surface.in_link() @ pose.rotation.T + pose.translation
            for _, pose, surface in self.surfaces[body]
        ]
        return np.concatenate(found) if found else np.zeros((1, 3))

    def points_at_rest(self, body: int) -> Array:
        """Surface of a body (N, 3) in the base frame, at rest."""
        pose = self.placements[body]
        return self.points(body) @ pose.rotation.T + pose.translation

    def path(self, body: int) -> list[int]:
        """Bodies from the base, left out, to this one."""
        return [int(joint) for joint in self.model.supports[body]][2:]

    def children(self, body: int) -> list[int]:
        """Bodies that hang on this one."""
        return [int(child) for child in self.model.children[body]]

    def below(self, body: int) -> list[int]:
        """This body and all that hang on it."""
        return [int(joint) for joint in self.model.subtrees[body]]

    def name(self, body: int) -> str:
        """Name of the joint that moves a body."""
        return str(self.model.names[body])


def build_skeleton(source: Source, package_paths: tuple[Path, ...]) -> Skeleton:
    """Model and surfaces of a source.

    Raises:
        ConfigError: Pinocchio cannot read it.
    """
    text = ElementTree.tostring(source.root, encoding="unicode")
    try:
        model = pin.buildModelFromXML(text, pin.JointModelFreeFlyer())
    except (RuntimeError, ValueError, ArithmeticError) as error:
        reason = " ".join(str(error).split())
        raise ConfigError(source.path, f"Pinocchio cannot read it as a URDF: {reason}") from error
    reader = Surfaces(source.path, source.root, package_paths)
    links: list[list[str]] = [[] for _ in range(model.njoints)]
    surfaces: list[list[tuple[str, pin.SE3, Surface]]] = [[] for _ in range(model.njoints)]
    for link in source.root.findall("link"):
        name = link.get("name", "")
        if model.existBodyName(name):
            frame = model.frames[model.getBodyId(name)]
            links[frame.parentJoint].append(name)
            surfaces[frame.parentJoint] += [
                (name, frame.placement, surface) for surface in reader.of_link(name)
            ]
    at_rest = pin.neutral(model)
    at_rest[7:] = np.clip(at_rest[7:], model.lowerPositionLimit[7:], model.upperPositionLimit[7:])
    data = model.createData()
    pin.forwardKinematics(model, data, at_rest)
    placements = [data.oMi[joint].copy() for joint in range(model.njoints)]
    return Skeleton(model, links, surfaces, reader.missing, at_rest, placements)
