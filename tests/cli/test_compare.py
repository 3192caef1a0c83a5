"""The command mgs compare."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mgs.motion.goals import goals_along
from mgs.motion_file import read_motion
from mgs.motion_file.joint_log import write_joint_log
from mgs.robot.unit import JointCorrection, UnitSpec, load_unit, write_unit
from tests.support.commands import run

OFFSET, DELAY = 0.03, 0.05  # [rad], [s]


@pytest.fixture(scope="module")
def squat(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("compare") / "squat.mcap"
    assert run("generate", "melson/squat", "-o", path).exit_code == 0
    return path


def log_of(squat: Path, folder: Path, degrees: bool = False) -> Path:
    """All joints follow their goals, late and with a zero that is off."""
    motion = read_motion(squat)
    times = np.arange(0.0, motion.duration, 0.0125)
    told = goals_along(motion).position
    late = [np.interp(times - DELAY, motion.times, column) + OFFSET for column in told.T]
    position = np.stack(late, axis=1)
    path = folder / "log.csv"
    names = motion.robot.joint_names
    write_joint_log(path, names, times, np.degrees(position) if degrees else position)
    return path


def test_figures_are_printed_and_written(tmp_path, squat):
    log, unit, plot = log_of(squat, tmp_path), tmp_path / "unit.yaml", tmp_path / "errors.png"
    common = ("compare", squat, log, "-o", unit, "--name", "no 7", "--plot", plot)
    result = run(*common)
    assert result.exit_code == 0, result.stderr
    assert "the motion begins at 0.000 s of the log" in result.stdout
    assert "left_knee_pitch" in result.stdout
    assert plot.read_bytes().startswith(b"\x89PNG")
    read = load_unit(unit, read_motion(squat).robot)
    assert read.name == "no 7"
    knee = read_motion(squat).robot.joint_names.index("left_knee_pitch")
    assert read.zero_offset[knee] == pytest.approx(OFFSET, abs=0.005)
    again = run(*common)
    assert (again.exit_code, "exists; use --force" in again.stderr) == (1, True)
    found = json.loads(run(*common, "--force", "--json").stdout)
    assert found["delays_are_relative"] is False
    joints = {joint["joint"]: joint for joint in found["joints"]}
    assert joints["left_knee_pitch"]["delay"] == pytest.approx(DELAY, abs=0.01)
    assert found["rms_after_deg"] < 0.3 * found["rms_before_deg"]


def test_degrees_are_found_out_and_converted(tmp_path, squat):
    log = log_of(squat, tmp_path, degrees=True)
    text = log.read_text().replace("motion_time", "time")
    log.write_text(text)
    refused = run("compare", squat, log)
    assert (refused.exit_code, "add --degrees" in refused.stderr) == (1, True)
    found = json.loads(run("compare", squat, log, "--degrees", "--json").stdout)
    assert found["start_found"]["agreement"] > 0.95


@pytest.mark.parametrize("start", ["-1000", "1000", "1.7e9"])
def test_a_start_outside_the_log_is_told(tmp_path, squat, start):
    result = run("compare", squat, log_of(squat, tmp_path), "--start", start)
    assert result.exit_code == 1
    assert f"did not begin at {float(start):.10g} s: the clock of the log goes" in result.stderr


def test_angles_that_no_joint_has_are_refused(tmp_path, squat):
    log = log_of(squat, tmp_path)
    head, first, *rest = log.read_text().splitlines()
    cells = first.split(",")
    cells[1] = "1e300"
    log.write_text("\n".join([head, ",".join(cells), *rest]))
    result = run("compare", squat, log)
    assert result.exit_code == 2 and "an angle is larger than 1e+09" in result.stderr


def test_a_replay_in_physics_is_a_log(tmp_path, squat):
    record = tmp_path / "replay.mcap"
    replayed = run("replay", squat, "--servo", "model", "--engine", "mujoco", "--record", record)
    assert replayed.exit_code == 0
    result = run("compare", squat, record, "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert found["start"] == pytest.approx(1.0, abs=0.1)  # stamps begin at 1 s
    assert found["start_found"]["agreement"] > 0.95


def test_bad_input_is_refused(tmp_path, squat):
    log = log_of(squat, tmp_path)
    poor = tmp_path / "poor.csv"
    poor.write_text("time,left_knee_pitch\n0,0.1\n1,x\n")
    for options, code, words in [
        ((poor,), 2, "line 3, column left_knee_pitch"),
        ((tmp_path,), 2, "holds no MCAP or SQLite file"),
        ((log, "--plot", tmp_path / "a.jpg"), 2, "should end in .png or .svg"),
        ((log, "--unit", poor), 2, "poor.csv"),
        ((log, "--name", "", "-o", tmp_path / "u.yaml"), 2, "--name"),
    ]:
        result = run("compare", squat, *options)
        assert (result.exit_code, words in result.stderr) == (code, True), result.stderr


def test_the_errors_of_a_simulated_robot_are_found_in_its_replay(tmp_path, squat):
    """Arms hang freely, so their errors are found; those of legs on the ground share the load."""
    true = {"left_elbow_pitch": -0.03, "right_elbow_pitch": 0.02, "left_shoulder_pitch": 0.03}
    joints = {name: JointCorrection(zero_offset=offset) for name, offset in true.items()}
    unit, record = tmp_path / "true.yaml", tmp_path / "replay.mcap"
    write_unit(UnitSpec(mgs=1, unit="true", robot="melson", joints=joints), unit)
    common = ("replay", squat, "--servo", "model", "--engine", "mujoco")
    replayed = run(*common, "--unit", unit, "--no-correct", "--record", record)
    assert replayed.exit_code == 0, replayed.stderr
    found = json.loads(run("compare", squat, record, "--json").stdout)
    offsets = {joint["joint"]: np.radians(joint["zero_offset_deg"]) for joint in found["joints"]}
    for name, offset in true.items():
        assert offsets[name] == pytest.approx(offset, abs=0.006)  # [rad], one tick is 0.005
    assert offsets["right_shoulder_pitch"] == pytest.approx(0.0, abs=0.006)


def test_a_start_that_puts_delays_beyond_those_looked_at_is_told(tmp_path, squat):
    log = log_of(squat, tmp_path)
    assert "warning" not in run("compare", squat, log).stdout
    late = run("compare", squat, log, "--start", "0.5")
    assert late.exit_code == 0 and "--start may be wrong" in late.stdout
    found = json.loads(run("compare", squat, log, "--start", "0.5", "--json").stdout)
    joints = {joint["joint"]: joint for joint in found["joints"]}
    assert joints["left_knee_pitch"]["delay_at_edge"] is True
