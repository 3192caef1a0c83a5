"""Tests of mgs export: files, output and errors."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from mgs.motion_file import read_motion
from mgs.robot import load_robot
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


@pytest.mark.parametrize(
    "wrong",
    [["--format", "xml"], ["--cycles"], ["--lead-in-from", "zero"], ["nowhere.mcap"]],
)
def test_wrong_usage_has_exit_code_two(walk_file: Path, wrong: list[str]):
    arguments = wrong if wrong == ["nowhere.mcap"] else [str(walk_file), *wrong]
    assert run("export", *arguments).exit_code == 2


def test_a_file_that_is_not_a_motion_file_has_exit_code_two(tmp_path: Path):
    (tmp_path / "a.mcap").write_text("no")
    result = run("export", tmp_path / "a.mcap")
    assert result.exit_code == 2
    assert len(files_below(tmp_path)) == 1


MOTORS = "mgs: 1\nmotors:\n" + "".join(
    f"  {name}: {{id: {k}, model: MX-28}}\n"
    for k, name in enumerate(load_robot("melson").joint_names, start=1)
)


def test_motors_and_one_robot_are_taken_from_files(walk_file: Path, tmp_path: Path):
    motors, unit = tmp_path / "motors.yaml", tmp_path / "unit.yaml"
    motors.write_text(MOTORS)
    unit.write_text(
        "mgs: 1\nunit: number 7\nrobot: melson\njoints: {waist_yaw: {zero_offset: 0.1}}\n"
    )
    options = ("export", walk_file, "--format", "dynamixel", "--motors", motors)
    told = {}
    for name, more in (("plain", ()), ("unit", ("--unit", unit)), ("fed", ("--feed-forward",))):
        result = run(*options, *more, "-o", tmp_path / f"{name}.csv")
        assert (result.exit_code, result.stderr) == (0, "")
        assert ("corrected for the physical robot number 7" in result.stdout) == (name == "unit")
        assert ("feed-forward commands" in result.stdout) == (name == "fed")
        lines = (tmp_path / f"{name}.csv").read_text().splitlines()
        told[name] = np.array([line.split(",") for line in lines if line[0] in "0123456789"], float)
    motion = read_motion(walk_file)
    j = motion.robot.joint_names.index("waist_yaw")
    offset = told["unit"][:, 1:] - told["plain"][:, 1:]
    assert np.abs(offset[:, j] + 0.1 * 4096 / (2.0 * np.pi)).max() <= 1.0
    assert not np.delete(offset, j, axis=1).any()
    assert np.abs(told["fed"] - told["plain"]).max() > 5.0  # ticks, at the knees
    assert "number 7" in (tmp_path / "unit.csv").read_text()
    assert "feed-forward" in (tmp_path / "fed.csv").read_text()


def test_an_export_tells_what_a_player_makes_of_it(walk_file: Path, tmp_path: Path):
    motors = tmp_path / "motors.yaml"
    motors.write_text(MOTORS)
    options = ("export", walk_file, "--format", "op3-action", "--motors", motors)
    result = run(*options, "-o", tmp_path / "a.bin", "--tolerance", "1", "--approach", "1")
    assert (result.exit_code, result.stderr) == (0, "")
    assert "joint error of the robot's player" in result.stdout
    assert "the first keyframe is reached after 1.00 s" in result.stdout
    told = json.loads(run(*options, "-o", tmp_path / "b.bin", "--json").stdout)
    assert len(told["notes"]) == 3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--format", "dynamixel"), "motors: no motor given for left_hip_yaw"),
        (("--format", "jtc", "--cycle"), "--cycle: format jtc holds whole motions"),
        (("--format", "hulks"), "is no joint of NAO"),
        (("--format", "op3-action", "--fps", "50"), "50 Hz: the player has 125 Hz"),
    ],
)
def test_what_a_format_cannot_hold_is_refused(
    long_walk: Path, options: tuple[str, ...], message: str, tmp_path: Path
):
    result = run("export", long_walk, *options, "-o", tmp_path / "a")
    assert result.exit_code == 2 and result.stdout == ""
    assert message in result.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("fmt", ["csv", "jtc"])
def test_a_folder_in_the_place_of_a_file_is_told(walk_file: Path, tmp_path: Path, fmt: str):
    """Asked to replace it, the command does not say again that it should be asked."""
    folder = tmp_path / "folder"
    folder.mkdir()
    result = run("export", walk_file, "--format", fmt, "-o", folder, "--force")
    assert result.exit_code == 1, result.output
    assert f"{folder}: a folder, which is never replaced; use -o" in result.output
    assert list(tmp_path.iterdir()) == [folder]
