"""Exported joint angles, read back by other libraries."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from mgs.core.errors import MgsError, OutputExistsError
from mgs.motion import Motion
from mgs.motion.cycle import find_cycle
from mgs.motion_file.export import FORMATS, export_motion
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


@pytest.mark.parametrize("fmt", FORMATS)
def test_an_export_is_reproducible_and_overwrites_nothing_unasked(
    walk: Motion, fmt: str, tmp_path: Path
):
    path = tmp_path / "a"
    export_motion(walk, path, fmt)
    first = path.read_bytes()
    with pytest.raises(OutputExistsError):
        export_motion(walk, path, fmt)
    export_motion(walk, path, fmt, force=True)
    assert path.read_bytes() == first
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("fmt", FORMATS)
def test_an_export_that_cannot_be_written_raises_an_error_and_leaves_no_file(
    walk: Motion, fmt: str, tmp_path: Path
):
    (tmp_path / "file").write_text("")
    with pytest.raises(MgsError, match="cannot be written"):
        export_motion(walk, tmp_path / "file/a", fmt)
    assert [p.name for p in tmp_path.iterdir()] == ["file"]
