"""Surface points of links, from primitives and mesh files.

A mesh has a plain path or a name that starts with file://, package:// or model://. The latter two
continue with the name of a package, which is searched in the given folders, in the folders of
ROS_PACKAGE_PATH and AMENT_PREFIX_PATH, and in every folder above the URDF. A path may lead to the
folder of the URDF, to the ROS package that holds it and to these folders, and nowhere else.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.errors import ConfigError
from mgs.core.input_files import is_file, is_inside
from mgs.core.limits import MAX_MESH
from mgs.robot.init.source import Source
from mgs.robot.urdf_text import Shape, numbers

MOST_POINTS = 20_000  # largest number of points of a mesh that are used
LEAST_SIDE = 2e-3  # [m] least side length of a bounding box
RING = 16  # number of points around a cylinder


@dataclass(frozen=True, eq=False)
class Surface:
    """One collision shape of a link, or one visual shape if the link has no collision shape."""

    placement: pin.SE3  # pose in the link frame
    points: Array  # (N, 3) in the frame of the shape [m]
    primitive: tuple[str, dict[str, str]] | None  # element and attributes; None: a mesh

    def in_link(self) -> Array:
        """Points (N, 3) in the frame of the link [m]."""
        return self.points @ self.placement.rotation.T + self.placement.translation

    def shape(self) -> Shape:
        """The shape itself if it is a primitive, else its bounding box."""
        if self.primitive is not None:
            return self.placement, *self.primitive
        box, size = bounding_box(self.points)
        return self.placement * box, "box", {"size": numbers(size)}


class Surfaces:
    """Reader of the shapes of links, which keeps a list of missing meshes."""

    def __init__(self, source: Source, package_paths: tuple[Path, ...]):
        self._urdf, self._packages = source.path.resolve(), package_paths
        self._links = {link.get("name", ""): link for link in source.root.findall("link")}
        self._given = source.meshes
        self._meshes: dict[tuple[Path, str], Array] = {}
        self.missing: list[str] = list(source.missing)

    def of_link(self, name: str) -> list[Surface]:
        """Collision shapes of a link, or its visual shapes if it has no collision shape."""
        for tag in ("collision", "visual"):
            found = [self._read(element) for element in self._links[name].findall(tag)]
            surfaces = [surface for surface in found if surface is not None]
            if surfaces:
                return surfaces
        return []

    def _read(self, element: ElementTree.Element) -> Surface | None:
        geometry = element.find("geometry")
        if geometry is None or not len(geometry):
            return None
        placement, shape = _origin(element), geometry[0]
        try:
            if shape.tag == "mesh":
                points = self._mesh(shape)
                return None if points is None else Surface(placement, points, None)
            return _primitive(placement, shape)
        except ValueError as error:
            raise ConfigError(self._urdf, f"<{shape.tag}> is malformed: {error}") from error

    def _mesh(self, shape: ElementTree.Element) -> Array | None:
        name, scale = shape.get("filename", ""), shape.get("scale", "1 1 1")
        if name in self._given:
            points = self._given[name]
            return points[:: 1 + len(points) // MOST_POINTS]
        path = find_mesh(name, self._urdf, self._packages)
        if path is None:
            self.missing.append(name)
            return None
        if path.stat().st_size > MAX_MESH:
            self.missing.append(f"{name} (larger than {MAX_MESH // 10**6} MB)")
            return None
        if (path, scale) not in self._meshes:
            try:
                model = coal.MeshLoader(coal.BV_OBBRSS).load(str(path), np.array(_three(scale)))
                points = np.array(model.vertices(), dtype=float).reshape(-1, 3)
            except (ValueError, RuntimeError):
                points = np.empty((0, 3))
            self._meshes[path, scale] = points[:: 1 + len(points) // MOST_POINTS]
        points = self._meshes[path, scale]
        if not len(points):
            self.missing.append(f"{name} (not readable)")
            return None
        return points


NEAR = 3  # folders above a URDF, its own included, that may be the package that they are named for


def find_mesh(name: str, urdf: Path, package_paths: tuple[Path, ...]) -> Path | None:
    """Path of a mesh file that is named in a URDF; None if the file is not found."""
    kind, _, rest = name.partition("://")
    if not rest:
        kind, rest = "file", name
    listed = os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    known = [
        *package_paths,
        *(Path(folder) for folder in listed if folder),
        *(Path(folder) / "share" for folder in prefixes if folder),
    ]
    if kind == "file":
        path = urdf.parent / rest
        own = next((p for p in urdf.parents if (p / "package.xml").is_file()), urdf.parent)
        # The usual layout NAME/urdf/x.urdf and NAME/meshes, without the package.xml of ROS.
        beside = urdf.resolve().parent.parent / "meshes"
        own_folders = (urdf.parent, own) if beside.is_symlink() else (urdf.parent, own, beside)
        return path if is_file(path) and is_inside(path, (*own_folders, *known)) else None
    package, _, inside = rest.lstrip("/").partition("/")
    if package in ("", ".", ".."):
        return None
    roots = [folder / package for folder in known]
    roots += [folder for folder in known if folder.name == package or folder in package_paths]
    # Any folder of this computer is above the URDF, or beside one that is: packages say that they
    # are, or are nearby.
    above = [root for folder in urdf.parents for root in (folder / package, folder)]
    near = (urdf.parent / package, *(up for up in urdf.parents[:NEAR] if len(up.parts) > 2))
    roots += [
        root
        for root in above
        if root.name == package and (root in near or is_file(root / "package.xml"))
    ]
    for root in roots:
        path = root / inside
        if is_file(path) and is_inside(path, (root, *known)):
            return path
    return None


def bounding_box(points: Array) -> tuple[pin.SE3, Array]:
    """Pose and size (3,) of a bounding box of points (N, 3), along the axes or principal axes."""
    covariance = np.cov(points.T) if len(points) > 3 else np.eye(3)
    principal = np.linalg.eigh(covariance)[1]
    principal[:, 2] *= np.sign(np.linalg.det(principal))
    best: tuple[float, pin.SE3, Array] | None = None
    for R in (np.eye(3), principal):
        low, high = (points @ R).min(axis=0), (points @ R).max(axis=0)
        size = np.maximum(high - low, LEAST_SIDE)
        if best is None or np.prod(size) < 0.9 * best[0]:
            best = float(np.prod(size)), pin.SE3(R, R @ (0.5 * (low + high))), size
    assert best is not None
    return best[1], best[2]


def _origin(element: ElementTree.Element) -> pin.SE3:
    origin = element.find("origin")
    if origin is None:
        return pin.SE3.Identity()
    xyz, rpy = _three(origin.get("xyz", "0 0 0")), _three(origin.get("rpy", "0 0 0"))
    return pin.SE3(pin.rpy.rpyToMatrix(*rpy), np.array(xyz))


def _three(text: str) -> list[float]:
    values = [float(word) for word in text.split()]
    if len(values) != 3:
        raise ValueError(f"three numbers expected, found {text!r}")
    return values


def _primitive(placement: pin.SE3, shape: ElementTree.Element) -> Surface | None:
    if shape.tag == "box":
        size = _three(shape.get("size", ""))
        corners = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T
        return Surface(placement, corners * size, ("box", {"size": numbers(size)}))
    if shape.tag == "sphere":
        radius = float(shape.get("radius", ""))
        R = placement.rotation  # points lie on the axes of the link, so that the lowest is exact
        points = radius * _directions() @ R
        return Surface(placement, points, ("sphere", {"radius": repr(radius)}))
    if shape.tag in ("cylinder", "capsule"):
        radius, length = float(shape.get("radius", "")), float(shape.get("length", ""))
        angles = np.arange(RING) * 2.0 * np.pi / RING
        ring = np.stack([radius * np.cos(angles), radius * np.sin(angles), 0.0 * angles], axis=1)
        if shape.tag == "capsule":
            ring = radius * _directions() @ placement.rotation  # as for a sphere
        end = np.array([0.0, 0.0, 0.5 * length])
        points = np.concatenate([ring - end, ring + end])
        round_size = {"radius": repr(radius), "length": repr(length)}
        return Surface(placement, points, ("cylinder", round_size))
    return None


def _directions() -> Array:
    """Unit vectors (N, 3) that cover the sphere and include the axes."""
    polar, around = np.linspace(0.0, np.pi, 9), np.arange(RING) * 2.0 * np.pi / RING
    t, p = (x.ravel() for x in np.meshgrid(polar, around))
    return np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=1)
