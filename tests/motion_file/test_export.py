"""Exported joint angles, read back by other libraries."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from mgs.core.errors import MgsError, OutputExistsError
from mgs.motion import Motion
from mgs.motion.cycle import find_cycle
from mgs.motion_file.export import export_motion
from mgs.motion_file.formats import FORMATS
from tests.support.bus_robots import motion_for
from tests.support.commands import files_below
from tests.support.formats import needs_library
from tests.support.shipped import generated


@pytest.fixture(scope="module")
def walk() -> Motion:
    return generated("melson/walk_practical").stages.motion


def read_csv(path: Path) -> tuple[list[str], np.ndarray]:
    with path.open(newline="") as stream:
        head, *rows = csv.reader(stream)
    return head, np.array(rows, dtype=float)


@pytest.mark.parametrize("whole", [True, False])
def test_a_csv_file_reads_back_exactly(walk: Motion, whole: bool, tmp_path: Path):
    cycle = None if whole else find_cycle(walk)
    export_motion(walk, tmp_path / "new/a.csv", "csv", cycle)
    head, table = read_csv(tmp_path / "new/a.csv")
    names = walk.robot.joint_names
    assert head == ["time", *(f"position.{n}" for n in names), *(f"velocity.{n}" for n in names)]
    position, velocity = (
        (walk.q[:, 7:], walk.v[:, 6:]) if cycle is None else (cycle.position, cycle.velocity)
    )
    assert np.array_equal(table[:, 1:], np.hstack([position, velocity]))
    assert np.allclose(table[:, 0], np.arange(len(position)) * walk.dt, rtol=0, atol=1e-9)
    assert np.array_equal(np.loadtxt(tmp_path / "new/a.csv", delimiter=",", skiprows=1), table)


@pytest.mark.parametrize("whole", [True, False])
def test_an_npz_file_reads_back_exactly(walk: Motion, whole: bool, tmp_path: Path):
    cycle = None if whole else find_cycle(walk)
    export_motion(walk, tmp_path / "a.npz", "npz", cycle)
    with np.load(tmp_path / "a.npz", allow_pickle=False) as found:
        assert found["joint_names"].tolist() == list(walk.robot.joint_names)
        assert float(found["dt"]) == walk.dt
        assert ("displacement" in found) == (cycle is not None)
        if cycle is None:
            assert np.array_equal(found["position"], walk.q[:, 7:])
            assert np.array_equal(found["velocity"], walk.v[:, 6:])
        else:
            assert np.array_equal(found["position"], cycle.position)
            assert np.array_equal(found["displacement"], cycle.displacement)
        assert len(found["time"]) == len(found["position"])


def content(path: Path) -> bytes | dict[str, bytes]:
    return files_below(path) if path.is_dir() else path.read_bytes()


@pytest.mark.parametrize("fmt", needs_library(FORMATS))
def test_an_export_is_reproducible_and_overwrites_nothing_unasked(
    walk: Motion, fmt: str, tmp_path: Path
):
    path, motion = tmp_path / "a", motion_for(fmt, walk)
    export_motion(motion, path, fmt)
    first = content(path)
    with pytest.raises(OutputExistsError):
        export_motion(motion, path, fmt)
    export_motion(motion, path, fmt, force=True)
    assert content(path) == first
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("fmt", needs_library(FORMATS))
def test_an_export_that_cannot_be_written_raises_an_error_and_leaves_no_file(
    walk: Motion, fmt: str, tmp_path: Path
):
    (tmp_path / "file").write_text("")
    with pytest.raises(MgsError, match="cannot be written"):
        export_motion(motion_for(fmt, walk), tmp_path / "file/a", fmt)
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize(
    "fmt", needs_library(name for name, found in FORMATS.items() if not found.suffix)
)
def test_a_folder_with_other_files_is_never_replaced(walk: Motion, fmt: str, tmp_path: Path):
    motion = motion_for(fmt, walk)
    export_motion(motion, tmp_path / "a", fmt)
    (tmp_path / "a/notes.txt").write_text("mine")
    before = files_below(tmp_path)
    with pytest.raises(MgsError, match=r"holds notes.txt, which is not replaced"):
        export_motion(motion, tmp_path / "a", fmt, force=True)
    assert files_below(tmp_path) == before


@pytest.mark.parametrize(
    "fmt", needs_library(name for name, found in FORMATS.items() if found.readable)
)
def test_an_export_reads_back_within_the_resolution_of_its_format(
    walk: Motion, fmt: str, tmp_path: Path
):
    motion = motion_for(fmt, walk)
    exported = export_motion(motion, tmp_path / "a", fmt)
    recorded = FORMATS[fmt].read(tmp_path / "a", motion.robot)
    sampled = exported.sampled
    names = recorded.joint_names or exported.written.joints
    assert sorted(names) == sorted(exported.written.joints)
    index = [motion.robot.joint_names.index(name) for name in names]
    assert np.abs(recorded.joints - sampled.joints[:, index]).max() <= FORMATS[fmt].resolution
    assert recorded.fps is None or recorded.fps == pytest.approx(sampled.fps, rel=1e-6)
    if recorded.base_position is not None:
        assert np.abs(recorded.base_position - sampled.base_position).max() < 1e-6
        along = np.abs(np.sum(recorded.base_quat_xyzw * sampled.base_quat_xyzw, axis=1))
        assert np.abs(along - 1.0).max() < 1e-6


@pytest.mark.parametrize("fmt", FORMATS)
def test_every_format_describes_its_layout(fmt: str):
    layout = FORMATS[fmt].layout
    assert layout.startswith(f"{fmt}: ")
    assert len(layout.splitlines()) > 3
    assert len(FORMATS[fmt].summary) < 80 - 22
