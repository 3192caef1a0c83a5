"""Pinocchio model of a third-party URDF, with the surface points of every body."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.robot.coupling import Follower
from mgs.robot.init.points import Surface, Surfaces
from mgs.robot.init.source import Source
from mgs.robot.limbs import joints_to
from mgs.robot.pinocchio_urdf import call_parser

BASE = 1  # Pinocchio id of the floating-base joint and of its body


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Bodies of a robot, with the ids of the Pinocchio joints that move them.

    A body consists of all links that are fixed to each other. `at_rest` is the configuration with
    every joint at 0, or at the limit nearest to 0; `placements` are the poses of the bodies in the
    base frame in this configuration.
    """

    model: pin.Model
    links: list[list[str]]  # names of the links of each body
    surfaces: list[list[tuple[str, pin.SE3, Surface]]]  # of each body: link, pose in the body
    missing: list[str]  # names of mesh files that were not found
    at_rest: Array  # (nq,)
    placements: list[pin.SE3]
    followers: dict[int, tuple[int, Follower]]  # leader of each coupled joint, and how it follows

    def complete(self, q: Array) -> None:
        """Set the angles of coupled joints in q (nq,) by those of their leaders, in place."""
        for joint, (leader, follower) in self.followers.items():
            q[self.model.idx_qs[joint]] = follower.angle(float(q[self.model.idx_qs[leader]]))

    def points(self, body: int) -> Array:
        """Surface points (N, 3) of a body in its frame [m]; the origin if it has no shape."""
        found = [
            surface.in_link() @ pose.rotation.T + pose.translation
            for _, pose, surface in self.surfaces[body]
        ]
        return np.concatenate(found) if found else np.zeros((1, 3))

    def points_at_rest(self, body: int) -> Array:
        """Surface points (N, 3) of a body in the base frame, in the configuration at rest [m]."""
        pose = self.placements[body]
        return self.points(body) @ pose.rotation.T + pose.translation

    def path(self, body: int) -> list[int]:
        """Bodies between the base (excluded) and this body (included)."""
        return joints_to(self.model, body)

    def children(self, body: int) -> list[int]:
        """Child bodies of this body."""
        return [int(child) for child in self.model.children[body]]

    def below(self, body: int) -> list[int]:
        """This body and all bodies below it in the tree."""
        return [int(joint) for joint in self.model.subtrees[body]]

    def name(self, body: int) -> str:
        """Name of the joint that moves a body."""
        return str(self.model.names[body])


def build_skeleton(source: Source, package_paths: tuple[Path, ...]) -> Skeleton:
    """Model and surfaces of a URDF.

    Raises:
        ConfigError: Pinocchio cannot read the URDF.
    """
    text = ElementTree.tostring(_without_shapes(source.root), encoding="unicode")
    model = call_parser(
        lambda: pin.buildModelFromXML(text, pin.JointModelFreeFlyer()), str(source.path)
    )
    reader = Surfaces(source, package_paths)
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
    joints = slice(FLOATING_BASE_NQ, None)
    lower, upper = model.lowerPositionLimit[joints], model.upperPositionLimit[joints]
    at_rest[joints] = np.clip(at_rest[joints], lower, upper)
    followers = {
        model.getJointId(name): (model.getJointId(follower.leader), follower)
        for name, follower in source.coupled.items()
    }
    for joint, (leader, follower) in followers.items():
        at_rest[model.idx_qs[joint]] = follower.angle(float(at_rest[model.idx_qs[leader]]))
    data = model.createData()
    pin.forwardKinematics(model, data, at_rest)
    placements = [data.oMi[joint].copy() for joint in range(model.njoints)]
    return Skeleton(model, links, surfaces, reader.missing, at_rest, placements, followers)


def _without_shapes(root: ElementTree.Element) -> ElementTree.Element:
    """A copy of a URDF without shapes, some of which Pinocchio's parser does not know."""
    bare = copy.deepcopy(root)
    for link in bare.findall("link"):
        for shape in [*link.findall("collision"), *link.findall("visual")]:
            link.remove(shape)
    return bare
