"""Recordings for Rerun, read back by its own API; skipped where rerun-sdk is not installed."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mgs.core.errors import OutputExistsError
from mgs.core.scene import Ball, Box, Scene
from mgs.motion import Motion
from mgs.motion_file import write_motion
from mgs.pipeline import Stages
from mgs.report.rerun_recording import write_recording

chunk = pytest.importorskip("rerun.chunk", reason="the Python package rerun-sdk is not installed")
pytestmark = pytest.mark.filterwarnings("default")  # those of the package itself
BOX, BALL = Box(1.0, 0.1, 0.5, 0.2, 0.4, 0.05), Ball(0.9, 0.0, 0.03, 0.05, 1.0, 0.0, 0.5)


def entities(chunks: Any) -> dict[str, dict[str, Any]]:
    """Last value of every component by the path of its entity."""
    found: dict[str, dict[str, Any]] = {}
    for part in chunks:
        batch = part.to_record_batch()
        columns = {name: batch.column(i)[-1].as_py() for i, name in enumerate(batch.schema.names)}
        found.setdefault(part.entity_path, {}).update(columns)
    return found


@pytest.fixture(scope="module")
def motion(walk_5cm: Stages) -> Motion:
    return dataclasses.replace(walk_5cm.motion, scene=Scene((BOX,), (BALL,)))


@pytest.fixture(scope="module")
def file(motion: Motion, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_motion(motion, tmp_path_factory.mktemp("walk") / "walk.mcap")


@pytest.fixture(scope="module")
def recording(file: Path) -> Path:
    return write_recording(file, file.with_suffix(".rrd"))


def test_reruns_own_loader_shows_robot_and_soles_of_a_motion_file(file: Path):
    """What one sees after `rerun walk.mcap`."""
    found = entities(chunk.McapReader(file).stream().to_chunks())
    shapes = [path for path, have in found.items() if "Boxes3D:half_sizes" in have]
    assert sum("visual_geometries" in path for path in shapes) > 40
    assert "Transform3D:translation" in found["/tf"]
    assert "InstancePoses3D:translations" in found["/sole/left"]


def test_a_recording_has_robot_paths_footsteps_boxes_and_balls(recording: Path, motion: Motion):
    found = entities(chunk.RrdReader(recording).stream().to_chunks())
    assert any("visual_geometries" in path for path in found)
    for name, points in (("com_path", motion.com), ("zmp_path", motion.zmp)):
        (strip,) = found[f"/mgs/{name}"]["LineStrips3D:strips"]
        np.testing.assert_allclose(np.array(strip)[:, : points.shape[1]], points, atol=1e-6)
    n_steps = sum(
        len(found[f"/mgs/footsteps/{side}"]["Boxes3D:centers"]) for side in ("left", "right")
    )
    assert n_steps == len(motion.footsteps)
    (half,) = found["/mgs/boxes"]["Boxes3D:half_sizes"]
    np.testing.assert_allclose(half, [0.1, 0.2, 0.025], rtol=1e-6)
    (centre,) = found["/mgs/balls"]["Ellipsoids3D:centers"]
    np.testing.assert_allclose(centre, [BALL.x, BALL.y, BALL.radius], rtol=1e-6)
    frames = {found[path]["CoordinateFrame:frame"][0] for path in found if path[:5] == "/mgs/"}
    assert frames == {"world"}


def test_a_recording_brings_its_blueprint(recording: Path):
    assert len(chunk.RrdReader(recording).blueprints()) == 1


def test_a_recording_overwrites_nothing_unasked(file: Path, recording: Path):
    before = recording.read_bytes()
    with pytest.raises(OutputExistsError):
        write_recording(file, recording)
    assert recording.read_bytes() == before
    assert not list(recording.parent.glob(".mgs-*"))
