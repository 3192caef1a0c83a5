"""Tests of link surfaces: meshes are found, and points lie on the shapes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.robot.init import init_robot
from mgs.robot.init.points import bounding_box, find_mesh
from tests.support.bipeds import Biped

LENGTH, WIDTH = 0.18, 0.08  # [m] of the foot in the mesh, which is in millimetres


def write_box(path: Path) -> None:
    """Write a foot as an STL file: a box around the origin, in millimetres."""
    path.parent.mkdir(parents=True)
    corners = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T * [180.0, 80.0, 20.0]
    lines = ["solid foot"]
    for a in range(0, 8):
        for b, c in ((a ^ 1, a ^ 2), (a ^ 2, a ^ 4), (a ^ 4, a ^ 1)):
            lines += ["facet normal 0 0 1", "outer loop"]
            lines += [f"vertex {x} {y} {z}" for x, y, z in corners[[a, b, c]]]
            lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid foot"]))


def biped(name: str) -> Biped:
    return Biped(foot_geometry=f'<mesh filename="{name}" scale="0.001 0.001 0.001"/>')


def assert_foot(urdf: Path, *package_paths: Path) -> None:
    robot = init_robot(urdf, package_paths=package_paths).robot
    for side in Side:
        sole = robot.sole_spec(side)
        assert (sole.length, sole.width) == pytest.approx((LENGTH, WIDTH), abs=1e-6)


@pytest.mark.parametrize("scheme", ["package", "model"])
def test_a_package_is_found_above_the_urdf(scheme: str, tmp_path: Path):
    write_box(tmp_path / "feet" / "meshes" / "foot.stl")
    urdf = tmp_path / "feet" / "urdf" / "robot.urdf"
    urdf.parent.mkdir()
    urdf.write_text(biped(f"{scheme}://feet/meshes/foot.stl").urdf())
    assert_foot(urdf)


@pytest.mark.parametrize("inside", ["", "feet"])
def test_a_package_is_found_in_the_folders_given(inside: str, tmp_path: Path):
    write_box(tmp_path / "elsewhere" / "feet" / "meshes" / "foot.stl")
    urdf = tmp_path / "alone" / "robot.urdf"
    urdf.parent.mkdir()
    urdf.write_text(biped("package://feet/meshes/foot.stl").urdf())
    with pytest.raises(ConfigError, match="--package-path"):
        init_robot(urdf)
    assert_foot(urdf, tmp_path / "elsewhere" / inside)


def test_packages_are_found_in_the_paths_of_ros_and_ament(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    mesh = tmp_path / "ws" / "share" / "feet" / "foot.stl"
    write_box(mesh)
    urdf = tmp_path / "alone" / "robot.urdf"
    assert find_mesh("package://feet/foot.stl", urdf, ()) is None
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'none'}:{tmp_path / 'ws'}")
    assert find_mesh("package://feet/foot.stl", urdf, ()) == mesh
    monkeypatch.delenv("AMENT_PREFIX_PATH")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ws" / "share"))
    assert find_mesh("package://feet/foot.stl", urdf, ()) == mesh


def test_meshes_beside_the_folder_of_the_urdf_are_found(tmp_path: Path):
    """The usual layout of packages, here without package.xml; not through a link elsewhere."""
    mesh = tmp_path / "robot" / "meshes" / "foot.stl"
    write_box(mesh)
    write_box(tmp_path / "other" / "foot.stl")
    urdf = tmp_path / "robot" / "urdf" / "robot.urdf"
    urdf.parent.mkdir()
    assert find_mesh("../meshes/foot.stl", urdf, ()) == urdf.parent / "../meshes/foot.stl"
    assert find_mesh("../../other/foot.stl", urdf, ()) is None
    mesh.unlink()
    mesh.parent.rmdir()
    mesh.parent.symlink_to(tmp_path / "other")
    assert find_mesh("../meshes/foot.stl", urdf, ()) is None


def test_plain_paths_are_relative_to_the_urdf(tmp_path: Path):
    write_box(tmp_path / "meshes" / "foot.stl")
    urdf = tmp_path / "robot.urdf"
    for name in ("meshes/foot.stl", f"file://{tmp_path}/meshes/foot.stl"):
        urdf.write_text(biped(name).urdf())
        assert_foot(urdf)


def test_an_unreadable_mesh_is_reported(tmp_path: Path):
    (tmp_path / "foot.stl").write_text("nothing")
    urdf = tmp_path / "robot.urdf"
    urdf.write_text(biped("foot.stl").urdf())
    with pytest.raises(ConfigError, match=r"foot\.stl \(not readable\)"):
        init_robot(urdf)


@given(
    st.lists(st.tuples(*[st.floats(-1.0, 1.0)] * 3), min_size=1, max_size=30).map(np.array),
)
def test_a_bounding_box_holds_every_point(points: np.ndarray):
    placement, size = bounding_box(points)
    local = np.array([placement.actInv(point) for point in points])
    assert (np.abs(local) <= 0.5 * size + 1e-9).all()
    R = placement.rotation
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(R) == pytest.approx(1.0)
