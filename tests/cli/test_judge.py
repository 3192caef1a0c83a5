"""Tests of mgs validate and mgs replay: JSON, text and exit codes."""

from __future__ import annotations

import dataclasses
import functools
import importlib.util
import json
import math
from pathlib import Path
from typing import Any

import pytest

from mgs.judge.motion_checks import check_motion
from mgs.judge.servo_cases import Case
from mgs.judge.servo_sweep import sweep_servos
from mgs.motion_file import read_motion, write_motion
from mgs.robot import build_robot
from mgs.sim import available_engines
from tests.support.commands import files_below, run, run_process

CHECK_KEYS = {"name", "ok", "value", "limit", "unit", "time", "where"}
REPLAY_KEYS = {
    *("engine", "fell", "fall_time", "distance", "planned_distance", "yaw_error_deg"),
    *("servo", "feed_forward", "command_clipped_deg", "command_clipped_joint"),
    *("max_tilt_deg", "joint_error_rms_deg", "torque_saturation", "sole_slip_max", "wall_seconds"),
}
ENGINES = available_engines()
needs_mujoco = pytest.mark.skipif("mujoco" not in ENGINES, reason="MuJoCo is not installed")


def checked(verdict: dict[str, Any]) -> None:
    """Check the keys of a verdict, and that the verdict agrees with its checks."""
    assert set(verdict) >= {"file", "verdict", "checks", "replays", "monte_carlo"}
    for check in verdict["checks"]:
        assert set(check) >= CHECK_KEYS
        assert type(check["ok"]) is bool
        assert type(check["value"]) is float
    passed = all(check["ok"] for check in verdict["checks"])
    assert verdict["verdict"] == ("pass" if passed else "fail")
    assert verdict["monte_carlo"] is None
    for replay in verdict["replays"]:
        replayed(replay)


def replayed(replay: dict[str, Any]) -> None:
    assert set(replay) >= REPLAY_KEYS
    assert type(replay["fell"]) is bool
    assert (replay["fall_time"] is None) == (not replay["fell"])
    assert [len(replay[key]) for key in ("distance", "planned_distance")] == [2, 2]


# --- validate ---------------------------------------------------------------------------------


def test_a_sound_motion_passes_its_static_checks(walk_file: Path):
    result = run("validate", walk_file, "--physics", "none", "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    verdict = json.loads(result.stdout)
    checked(verdict)
    assert (verdict["file"], verdict["verdict"], verdict["replays"]) == (str(walk_file), "pass", [])
    expected = [check.name for check in check_motion(read_motion(walk_file))]
    assert [check["name"] for check in verdict["checks"]] == expected


def test_the_verdict_in_words_states_that_falling_was_not_checked(walk_file: Path):
    result = run("validate", walk_file, "--physics", "none")
    assert (result.exit_code, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    assert lines[-1] == "PASS"
    assert lines[-2] == "no replay in physics: falling was not checked"
    assert lines[-3].startswith("energy: positive joint work ")
    assert all(line.startswith("ok   ") for line in lines[:-3])


def test_a_motion_that_leans_off_its_soles_fails(falling_file: Path):
    result = run("validate", falling_file, "--physics", "none", "--json")
    assert (result.exit_code, result.stderr) == (1, "")
    verdict = json.loads(result.stdout)
    checked(verdict)
    failed = {check["name"] for check in verdict["checks"] if not check["ok"]}
    assert verdict["verdict"] == "fail"
    assert "zmp_margin" in failed
    words = run("validate", falling_file, "--physics", "none")
    assert words.exit_code == 1
    assert words.stdout.splitlines()[-1].startswith("FAIL: ")
    for name in failed:
        assert f"FAIL {name}" in words.stdout


def test_every_engine_prints_json_and_nothing_else(walk_file: Path, tmp_path: Path):
    """The test uses real file descriptors, because engines print from C code."""
    done = run_process("validate", walk_file, "--json", cwd=tmp_path)
    verdict = json.loads(done.stdout)
    checked(verdict)
    assert done.returncode == {"pass": 0, "fail": 1}[verdict["verdict"]]
    assert [replay["engine"] for replay in verdict["replays"]] == 2 * list(ENGINES)
    names = {check["name"] for check in verdict["checks"]}
    for engine in (*ENGINES, *(f"{engine}_pd" for engine in ENGINES)):
        assert names >= {f"{engine}_{figure}" for figure in ("upright", "position", "yaw")}
    assert files_below(tmp_path) == {}  # no log of an engine either


@needs_mujoco
def test_a_fall_is_a_failed_verdict(falling_file: Path):
    result = run("validate", falling_file, "--physics", "mujoco", "--json")
    assert result.exit_code == 1
    verdict = json.loads(result.stdout)
    checked(verdict)
    assert verdict["replays"][0]["fell"]
    failed = {check["name"] for check in verdict["checks"] if not check["ok"]}
    assert "mujoco_upright" in failed


@pytest.mark.parametrize(
    "physics", ["", "gazebo", "mujoco,gazebo", "none,mujoco", "mujoco,mujoco", "MuJoCo", ","]
)
def test_unknown_physics_is_a_usage_error(walk_file: Path, physics: str):
    result = run("validate", walk_file, "--physics", physics)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "--physics" in result.stderr
    assert "use pybullet, mujoco (separated by commas) or none" in result.stderr


@pytest.mark.parametrize("command", [("validate", "--physics", "none"), ("replay",)])
@needs_mujoco
def test_a_missing_engine_is_named_with_cause_and_remedy(
    walk_file: Path, monkeypatch, command: tuple[str, ...]
):
    found = importlib.util.find_spec

    def without_pybullet(name: str, package: str | None = None):
        return None if name == "pybullet" else found(name, package)

    monkeypatch.setattr(importlib.util, "find_spec", without_pybullet)
    name, *options = command
    result = run(name, walk_file, *options)
    assert result.exit_code == 0
    assert "pybullet is MISSING: " in result.stdout and "pip install pybullet" in result.stdout
    told = json.loads(run(name, walk_file, *options, "--json").stdout)
    (missing,) = told["engines_missing"]
    assert missing["engine"] == "pybullet" and missing["cause"] and missing["remedy"]


def test_without_any_engine_validate_reports_that_none_is_installed(walk_file: Path, monkeypatch):
    monkeypatch.setattr("mgs.sim.choice.available_engines", lambda: ())
    result = run("validate", walk_file)
    assert (result.exit_code, result.stdout) == (1, "")
    assert "install mujoco or pybullet" in result.stderr
    assert run("validate", walk_file, "--physics", "none").exit_code == 0


@needs_mujoco
def test_a_servo_sweep_is_printed_and_drawn(walk_file: Path, tmp_path: Path, monkeypatch):
    cases = (Case(None, 1.0, 0.5), Case(None, 1.0, 60.0))
    monkeypatch.setattr(
        "mgs.judge.validate.sweep_servos", functools.partial(sweep_servos, cases=cases)
    )
    figure = tmp_path / "servos.png"
    ideal = ("--physics", "mujoco", "--servo", "ideal")
    options = (*ideal, "--servo-sweep", "--sweep-plot", figure)
    result = run("validate", walk_file, *options)
    assert result.exit_code == 0  # no check depends on the sweep
    words = "mujoco, PD servos, planned angles, friction 1: passes at sags of 0.5 deg"
    assert words in result.stdout.splitlines()
    drawn = figure.read_bytes()
    assert drawn.startswith(b"\x89PNG")
    again = run("validate", walk_file, *options)
    assert (again.exit_code, again.stdout) == (1, "")
    assert "--force" in again.stderr
    content = json.loads(run("validate", walk_file, *options, "--force", "--json").stdout)
    assert figure.read_bytes() == drawn
    (sweep,) = content["servo_sweep"]
    assert (sweep["engine"], sweep["passed"], sweep["n"]) == ("mujoco", 1, 2)
    assert [row["fell"] for row in sweep["replays"]] == [False, True]
    assert (
        json.loads(run("validate", walk_file, "--physics", "none", "--json").stdout)["servo_sweep"]
        is None
    )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--sweep-plot", "a.png"), "--servo-sweep"),
        (("--servo-sweep", "--physics", "none", "--sweep-plot", "a.png"), "no servo sweep"),
        (("--servo-sweep", "--sweep-plot", "a.jpg"), "should end in .png or .svg"),
    ],
)
def test_a_sweep_plot_needs_a_sweep_and_a_known_format(
    walk_file: Path, options: tuple[str, ...], words: str
):
    result = run("validate", walk_file, *options)
    assert (result.exit_code, result.stdout) == (2, "")
    assert words in result.stderr


# --- replay -----------------------------------------------------------------------------------


@pytest.mark.parametrize("engine", ENGINES)
def test_a_replay_prints_json_and_nothing_else(walk_file: Path, tmp_path: Path, engine: str):
    done = run_process("replay", walk_file, "--engine", engine, "--json", cwd=tmp_path)
    replay = json.loads(done.stdout)
    replayed(replay)
    assert (replay["engine"], done.returncode) == (engine, 1 if replay["fell"] else 0)
    assert replay["planned_distance"] == pytest.approx([0.05, 0.0], abs=1e-6)
    assert files_below(tmp_path) == {}


@needs_mujoco
def test_a_fall_is_exit_code_one(falling_file: Path):
    result = run("replay", falling_file, "--engine", "mujoco", "--json")
    assert result.exit_code == 1
    replay = json.loads(result.stdout)
    replayed(replay)
    assert replay["fell"]
    assert 0.0 < replay["fall_time"] < 4.6  # the motion and one second
    words = run("replay", falling_file, "--engine", "mujoco")
    assert words.exit_code == 1
    assert f"FELL at {replay['fall_time']:.2f} s" in words.stdout


@needs_mujoco
def test_a_replay_uses_the_settings_of_its_options(walk_file: Path):
    options = ("--step", "0.002", "--iterations", "20", "--friction", "0.7")
    result = run("replay", walk_file, "--engine", "mujoco", *options, "--json")
    assert result.exit_code == 0
    settings = json.loads(result.stdout)["settings"]
    assert {key: settings[key] for key in ("dt", "iterations", "friction")} == {
        "dt": 0.002,
        "iterations": 20,
        "friction": 0.7,
    }


@pytest.mark.parametrize(
    "options",
    [
        ("--engine", "gazebo"),
        *(("--step", value) for value in ("nan", "inf", "0", "-0.001", "1", "fast")),
        *(("--friction", value) for value in ("nan", "inf", "-1", "rough")),
        *(("--iterations", value) for value in ("0", "1.5", "many", "1000000")),
    ],
    ids=" ".join,
)
def test_bad_settings_of_a_replay_are_usage_errors(walk_file: Path, options: tuple[str, str]):
    result = run("replay", walk_file, *options)
    assert (result.exit_code, result.stdout) == (2, "")
    assert options[0] in result.stderr


# --- servos -------------------------------------------------------------------------------------


@needs_mujoco
@pytest.mark.parametrize(
    ("options", "servo", "feed_forward", "words"),
    [
        ((), "ideal", False, "ideal servos:"),
        (("--servo", "ideal", "--no-feed-forward"), "ideal", False, "ideal servos:"),
        (("--servo", "model"), "model", True, "modelled servos, feed-forward:"),
        (("--servo", "model", "--feed-forward"), "model", True, "modelled servos, feed-forward:"),
        (("--servo", "model", "--no-feed-forward"), "model", False, "modelled servos:"),
        (("--servo", "pd"), "pd", False, "PD servos (sag 1 deg, damping time 10 ms):"),
        (
            ("--servo", "pd", "--sag", "0.5", "--damping-time", "0.02", "--feed-forward"),
            "pd",
            True,
            "PD servos (sag 0.5 deg, damping time 20 ms), feed-forward:",
        ),
    ],
)
def test_a_replay_uses_and_names_the_servos_of_its_options(
    walk_file: Path, options: tuple[str, ...], servo: str, feed_forward: bool, words: str
):
    result = run("replay", walk_file, "--engine", "mujoco", *options, "--json")
    content = json.loads(result.stdout)
    replayed(content)
    assert (content["servo"], content["feed_forward"]) == (servo, feed_forward)
    assert words in run("replay", walk_file, "--engine", "mujoco", *options).stdout


@needs_mujoco
def test_a_verdict_names_its_servos(walk_file: Path):
    result = run("validate", walk_file, "--physics", "mujoco", "--servo", "model", "--json")
    verdict = json.loads(result.stdout)
    checked(verdict)
    assert (result.exit_code, verdict["servo"], verdict["verdict"]) == (0, "model", "pass")
    source = "figures of robot.yaml"
    assert verdict["replays"][0]["servo_sources"] == {"AX-12": source, "RX-28": source}
    words = run("validate", walk_file, "--physics", "mujoco", "--servo", "model").stdout
    told = "modelled servos that were not identified by measurements: "
    assert f"{told}AX-12: {source}; RX-28: {source}" in words.splitlines()
    nothing = json.loads(run("validate", walk_file, "--physics", "none", "--json").stdout)
    assert nothing["servo"] is None


@pytest.mark.parametrize("command", ["validate", "replay"])
@pytest.mark.parametrize("options", [("--servo", "ideal", "--feed-forward")])
def test_feed_forward_is_refused_for_ideal_servos(
    walk_file: Path, command: str, options: tuple[str, ...]
):
    result = run(command, walk_file, *options)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "--feed-forward" in result.stderr
    assert "--servo model" in result.stderr


@needs_mujoco
def test_a_verdict_may_be_of_several_kinds_of_servos(walk_file: Path):
    options = ("--physics", "mujoco", "--servo", "ideal,pd", "--sag", "30")
    result = run("validate", walk_file, *options, "--json")
    verdict = json.loads(result.stdout)
    checked(verdict)
    assert (result.exit_code, verdict["servo"], verdict["physics"]) == (1, "ideal", ["mujoco"])
    assert [replay["servo"] for replay in verdict["replays"]] == ["ideal", "pd"]
    assert verdict["replays"][1]["settings"]["sag"] == pytest.approx(math.radians(30.0))
    names = [check["name"] for check in verdict["checks"]]
    assert len(names) == len(set(names))
    assert {"mujoco_upright", "mujoco_position", "mujoco_pd_upright"} <= set(names)
    failed = {check["name"] for check in verdict["checks"] if not check["ok"]}
    assert failed == {"mujoco_pd_upright"}  # 30 deg are far too many


@pytest.mark.parametrize(
    "options",
    [
        ("--sag", "1", "--servo", "ideal"),
        ("--damping-time", "0.01", "--servo", "ideal"),
        ("--sag", "1", "--servo", "model"),
        *(("--servo", "pd", "--sag", value) for value in ("nan", "0", "-1", "91", "soft")),
        *(("--servo", "pd", "--damping-time", value) for value in ("nan", "-1", "2", "long")),
    ],
    ids=" ".join,
)
@pytest.mark.parametrize("command", ["validate", "replay"])
def test_sag_and_damping_are_those_of_pd_servos(
    walk_file: Path, command: str, options: tuple[str, ...]
):
    result = run(command, walk_file, *options)
    assert (result.exit_code, result.stdout) == (2, "")
    name = next(option for option in ("--sag", "--damping-time") if option in options)
    assert name in result.stderr
    if "pd" not in options:
        assert "--servo pd" in result.stderr


@pytest.mark.parametrize("servo", ["", "perfect", "ideal,perfect", "pd,pd", "Ideal", "ideal,"])
def test_unknown_servos_are_a_usage_error(walk_file: Path, servo: str):
    result = run("validate", walk_file, "--servo", servo)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "ideal, model, pd" in result.stderr


@pytest.mark.parametrize("command", ["validate", "replay"])
def test_a_servo_without_stiffness_is_an_error_with_a_remedy(
    walk_file: Path, tmp_path: Path, command: str
):
    motion = read_motion(walk_file)
    text = motion.robot.yaml.replace("compliance_slope: 16, ", "")
    bare = dataclasses.replace(motion, robot=build_robot(text, motion.robot.urdf, "bare"))
    write_motion(bare, tmp_path / "bare.mcap")
    result = run(command, tmp_path / "bare.mcap", "--servo", "model")
    assert (result.exit_code, result.stdout) == (2, "")
    for words in ("bare.mcap: robot.yaml: servos.RX-28: ", "give stiffness", "compliance_slope"):
        assert words in result.stderr


# --- motion files that are none ----------------------------------------------------------------

COMMANDS = {
    "info": ("info",),
    "validate": ("validate", "--physics", "none"),
    "replay": ("replay",),
    "plot": ("plot", "-o", "plots"),
}


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("kind", ["empty", "text", "zeros", "head", "tail cut", "byte changed"])
def test_a_malformed_motion_file_is_refused(
    command: str, kind: str, walk_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    good = walk_file.read_bytes()
    middle = len(good) // 2
    content = {
        "empty": b"",
        "text": b"mgs: 1\n",
        "zeros": bytes(4096),
        "head": good[:8],
        "tail cut": good[:-100],
        "byte changed": good[:middle] + bytes([good[middle] ^ 0xFF]) + good[middle + 1 :],
    }[kind]
    (tmp_path / "bad.mcap").write_bytes(content)
    name, *options = COMMANDS[command]
    for extra in ((), ("--json",)):
        result = run(name, "bad.mcap", *options, *extra)
        assert (result.exit_code, result.stdout) == (2, "")
        assert result.stderr.startswith("Error: bad.mcap: ")
        assert len(result.stderr.splitlines()) <= 3
    assert files_below(tmp_path) == {"bad.mcap": content}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_missing_motion_file_is_a_usage_error(command: str, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name, *options = COMMANDS[command]
    for file in ("nowhere.mcap", "."):
        result = run(name, file, *options)
        assert (result.exit_code, result.stdout) == (2, "")
        assert file in result.stderr


# --- one physical robot -------------------------------------------------------------------------


def unit_file(folder: Path, joints: str, robot: str = "melson") -> Path:
    path = folder / "unit.yaml"
    path.write_text(f"mgs: 1\nunit: number 7\nrobot: {robot}\njoints: {joints}\n")
    return path


@needs_mujoco
def test_a_replay_has_the_errors_of_one_robot_and_commands_for_it(walk_file: Path, tmp_path: Path):
    unit = unit_file(tmp_path, "{left_knee_pitch: {sign: -1}, waist_yaw: {zero_offset: 0.05}}")
    options = ("replay", walk_file, "--engine", "mujoco", "--unit", unit)
    corrected, told = (
        json.loads(run(*options, *more, "--json").stdout) for more in ((), ("--no-correct",))
    )
    assert (corrected["unit"], corrected["corrected"], corrected["fell"]) == (
        "number 7",
        True,
        False,
    )
    assert (told["unit"], told["corrected"], told["fell"]) == ("number 7", False, True)
    text = run(*options).stdout
    assert "robot number 7 with commands corrected for it" in text


@needs_mujoco
def test_a_verdict_is_of_one_robot(walk_file: Path, tmp_path: Path):
    unit = unit_file(tmp_path, "{left_knee_pitch: {sign: -1}}")
    options = ("validate", walk_file, "--physics", "mujoco", "--servo", "ideal", "--unit", unit)
    assert run(*options).exit_code == 0
    result = run(*options, "--no-correct", "--json")
    assert result.exit_code == 1
    (replay,) = json.loads(result.stdout)["replays"]
    assert replay["fell"] and replay["unit"] == "number 7"


@pytest.mark.parametrize("command", [("validate", "--physics", "none"), ("replay",)])
def test_a_wrong_file_of_one_robot_is_refused(
    walk_file: Path, command: tuple[str, ...], tmp_path: Path
):
    name, *more = command
    for joints, robot, message in (
        ("{neck: {sign: -1}}", "melson", "joints.neck: melson has no such joint"),
        ("{}", "coman", "corrections of 'coman', but the motion is of 'melson'"),
        ("{waist_yaw: {stiffness: 0}}", "melson", "joints.waist_yaw.stiffness"),
    ):
        unit = unit_file(tmp_path, joints, robot)
        result = run(name, walk_file, *more, "--unit", unit)
        assert result.exit_code == 2 and result.stdout == ""
        assert message in result.stderr and str(unit) in result.stderr
