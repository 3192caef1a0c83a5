"""Shapes of robots on a page, and the folder that meshes must not leave."""

from __future__ import annotations

import dataclasses
import struct
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from mgs.report.page.meshes import MeshError, find_inside, read_mesh, reduced
from mgs.report.page.shapes import robot_shapes
from mgs.robot import Robot, load_robot


def sphere(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a unit sphere with about 2 n^2 triangles."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, n + 1), np.linspace(0, 2 * np.pi, n + 1))
    points = [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]
    vertices = np.stack(points, axis=-1).reshape(-1, 3)
    i, j = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(n)))
    a, b = i * (n + 1) + j, (i + 1) * (n + 1) + j
    return vertices, np.concatenate([np.stack([a, b, b + 1], 1), np.stack([a, b + 1, a + 1], 1)])


def write_stl(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    data = bytearray(80) + struct.pack("<I", len(triangles))
    for triangle in triangles:
        data += struct.pack("<12fH", 0, 0, 0, *vertices[triangle].ravel(), 0)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


def with_mesh(robot: Robot, name: str) -> Robot:
    """The robot with a mesh as the only visual shape of its torso."""
    root = ElementTree.fromstring(robot.urdf)
    torso = next(link for link in root.findall("link") if link.get("name") == "torso")
    for visual in torso.findall("visual"):
        torso.remove(visual)
    geometry = ElementTree.SubElement(ElementTree.SubElement(torso, "visual"), "geometry")
    ElementTree.SubElement(geometry, "mesh", filename=name, scale="0.5 0.5 0.5")
    return dataclasses.replace(robot, urdf=ElementTree.tostring(root, encoding="unicode"))


@pytest.mark.parametrize("name", ["melson", "coman", "coman_legs"])
def test_a_shipped_robot_shows_every_visual_shape(name: str):
    robot = load_robot(name)
    found = robot_shapes(robot, None)
    links = ElementTree.fromstring(robot.urdf).findall("link")
    assert len(found.items) == sum(len(link.findall("visual")) for link in links) > 10
    assert found.notes == []
    for shape in found.items:
        assert np.isclose(np.linalg.norm(shape["pose"][3:]), 1.0)


def test_a_mesh_inside_the_folder_is_shown(melson: Robot, tmp_path: Path):
    write_stl(tmp_path / "meshes" / "torso.stl", *sphere(12))
    for name in ("package://some_robot/meshes/torso.stl", "meshes/torso.stl"):
        found = robot_shapes(with_mesh(melson, name), tmp_path)
        assert len(found.meshes) == 1 and found.notes == []
        shape = next(s for s in found.items if s["kind"] == "mesh")
        assert (shape["link"], shape["size"]) == ("torso", [0.5, 0.5, 0.5])


@pytest.mark.parametrize(
    "name",
    ["/etc/hostname", "file:///etc/hostname", "../secret.stl", "package://x/../../secret.stl",
     "meshes/link.stl", "http://example.org/a.stl", "nul\0.stl", ""],
)  # fmt: skip
def test_no_name_leads_out_of_the_folder(melson: Robot, tmp_path: Path, name: str):
    secret, folder = tmp_path / "secret.stl", tmp_path / "robot"
    write_stl(secret, *sphere(4))
    (folder / "meshes").mkdir(parents=True)
    (folder / "meshes" / "link.stl").symlink_to(secret)
    with pytest.raises(MeshError):
        find_inside(folder, name)
    if "\0" in name:
        return  # no XML can contain it
    found = robot_shapes(with_mesh(melson, name), folder)
    assert found.meshes == []
    assert "1 meshes are replaced by collision shapes" in found.notes[0]
    assert sum(shape["link"] == "torso" for shape in found.items) == 3  # its collision boxes


def test_without_a_folder_no_mesh_is_read(melson: Robot, tmp_path: Path):
    write_stl(tmp_path / "torso.stl", *sphere(4))
    found = robot_shapes(with_mesh(melson, str(tmp_path / "torso.stl")), None)
    assert found.meshes == [] and "--meshes" in found.notes[0]


def test_a_damaged_mesh_is_no_reason_to_fail(melson: Robot, tmp_path: Path):
    (tmp_path / "torso.stl").write_bytes(b"solid nothing")
    found = robot_shapes(with_mesh(melson, "torso.stl"), tmp_path)
    assert found.meshes == [] and len(found.notes) == 1


def test_a_reduced_mesh_stays_near_the_surface(tmp_path: Path):
    write_stl(tmp_path / "ball.stl", *sphere(80))
    vertices, triangles = read_mesh(tmp_path, "ball.stl")
    fewer, kept = reduced(vertices, triangles, 2000)
    assert 200 < len(kept) <= 2000 < len(triangles)
    radius = np.linalg.norm(fewer[np.unique(kept)], axis=1)
    assert radius.min() > 0.95 and radius.max() < 1.0 + 1e-6  # of STL's 32-bit numbers
