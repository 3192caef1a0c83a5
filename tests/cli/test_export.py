"""Tests of mgs export: files, output and errors."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from mgs.motion_file import read_motion
from tests.support.commands import files_below, run

LONG_WALK = ("melson/walk_practical", "--set", "com.passes=0", "--set", "walk.n_steps=8")


@pytest.fixture(scope="module")
def long_walk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("long") / "walk.mcap"
    assert run("generate", *LONG_WALK, "-o", path).exit_code == 0
    return path


def test_by_default_a_csv_file_is_written_beside_the_motion_file(walk_file: Path):
    result = run("export", walk_file, "--json")
    told = json.loads(result.stdout)
    assert (result.exit_code, result.stderr) == (0, "")
    assert told["file"] == str(walk_file.with_suffix(".csv"))
    with Path(told["file"]).open(newline="") as stream:
        head, *rows = csv.reader(stream)
    motion = read_motion(walk_file)
    assert len(rows) == told["samples"] == motion.n_samples
    assert [name.partition(".")[2] for name in head[1:]] == 2 * told["joints"]
    assert np.array_equal(np.array(rows, float)[:, 1 : 1 + motion.robot.n], motion.q[:, 7:])
    assert told["cycle"] is None
    again = run("export", walk_file)
    assert (again.exit_code, again.stdout) == (1, "")
    assert "use --force" in again.stderr
    assert run("export", walk_file, "--force").exit_code == 0


def test_a_cycle_is_reported_with_its_displacement(long_walk: Path, tmp_path: Path):
    path = tmp_path / "cycle.npz"
    result = run("export", long_walk, "--cycle", "--format", "npz", "-o", path, "--json")
    cycle = json.loads(result.stdout)["cycle"]
    assert cycle["period"] == pytest.approx(1.6)
    assert cycle["displacement"] == pytest.approx([0.1, 0.0, 0.0])
    with np.load(path) as arrays:
        assert len(arrays["position"]) == 160
        assert arrays["displacement"].tolist() == cycle["displacement"]
    words = run("export", long_walk, "--cycle", "--format", "npz", "-o", path, "--force").stdout
    assert "cycle of 1.6 s" in words
    assert "displacement +0.1000 m forward" in words
    assert f"rad ({cycle['joint']}); it was removed" in words


def test_a_motion_without_a_cycle_is_refused_without_a_file(walk_file: Path, tmp_path: Path):
    result = run("export", walk_file, "--cycle", "-o", tmp_path / "a.csv")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "walk_practical: no two steps in its middle that could be repeated" in result.stderr
    assert files_below(tmp_path) == {}


@pytest.mark.parametrize("wrong", [["--format", "xml"], ["--cycles"], ["nowhere.mcap"]])
def test_wrong_usage_has_exit_code_two(walk_file: Path, wrong: list[str]):
    arguments = wrong if wrong == ["nowhere.mcap"] else [str(walk_file), *wrong]
    assert run("export", *arguments).exit_code == 2


def test_a_file_that_is_not_a_motion_file_has_exit_code_two(tmp_path: Path):
    (tmp_path / "a.mcap").write_text("no")
    result = run("export", tmp_path / "a.mcap")
    assert result.exit_code == 2
    assert len(files_below(tmp_path)) == 1
