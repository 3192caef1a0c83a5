"""Tests of mgs envelope: one small envelope, and errors that are found before any work."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from mgs.gait import load_gait
from mgs.robot import find_robot
from mgs.sim import available_engines
from tests.support.commands import files_below, run

needs_mujoco = pytest.mark.skipif(
    "mujoco" not in available_engines(), reason="MuJoCo is not installed"
)
SMALL = ("--set", "walk.n_steps=2", "--times", "0.6", "--resolution", "0.05")
QUICK = (*SMALL, "--physics", "mujoco", "--servo", "ideal")


@needs_mujoco
def test_an_envelope_consists_of_three_files(tmp_path: Path):
    folder = tmp_path / "out"
    result = run("envelope", "melson", *QUICK, "-o", folder)
    assert result.exit_code == 0, result.output
    assert "fastest walk: steps of 0.100 m in 0.60 s, 0.167 m/s, Froude number 0.01" in (
        result.output
    )
    assert set(files_below(folder)) == {"envelope.json", "envelope.png", "fastest.yaml"}
    gait = load_gait(folder / "fastest.yaml")
    assert (gait.robot, gait.walk.step_length, gait.walk.n_steps) == ("melson", 0.1, 2)
    before = files_below(folder)
    again = run("envelope", "melson", *QUICK, "-o", folder)
    assert again.exit_code == 1
    assert "use --force to replace it" in again.output
    forced = run("envelope", "melson", *QUICK, "-o", folder, "--force", "--json")
    assert json.loads(forced.stdout) == {"json_version": 1, **json.loads(before["envelope.json"])}
    assert files_below(folder) == before


@needs_mujoco
def test_an_envelope_without_any_walk_says_so(tmp_path: Path):
    high = ("--set", "walk.step_height=0.2")
    result = run("envelope", "melson", *QUICK, *high, "-o", tmp_path / "out", "--json")
    assert result.exit_code == 1
    content = json.loads(result.stdout)
    assert content["fastest"] is None
    assert all(probe["failed"] for probe in content["probes"])
    assert set(files_below(tmp_path / "out")) == {"envelope.json", "envelope.png"}


@pytest.mark.parametrize(
    ("arguments", "exit_code", "words"),
    [
        (("--times", "0.5,x"), 2, "--times: '0.5,x' is not a list of step times"),
        (
            ("--times", "nan"),
            2,
            "--times: 'nan' is not a list of step times; give 1 to 100",
        ),
        (("--times", "0.05"), 2, "--times: 0.05 s is too short for a step; use at least 0.1 s"),
        (("--resolution", "nan"), 2, "not a finite number"),
        (
            ("--physics", "none"),
            2,
            "--physics: none is not possible, because the search",
        ),
        (("--gait", "melson/sway"), 2, "melson/sway: motion: balance has no steps"),
        (("--set", "walk.step_hight=1"), 2, "walk.step_hight: unknown key"),
        (("--set", "walk.n_steps=1"), 2, "n_steps = 1 is the closing step alone"),
        (("--set", "walk.n_steps=20000", "--times", "60"), 2, "use fewer walk.n_steps"),
    ],
)
def test_impossible_requests_are_refused_at_once(
    arguments: tuple[str, ...], exit_code: int, words: str, tmp_path: Path
):
    result = run("envelope", "melson", *arguments, "-o", tmp_path / "out")
    assert result.exit_code == exit_code
    assert words in result.output
    assert not (tmp_path / "out").exists()


def test_a_robot_without_servo_models_needs_ideal_servos(tmp_path: Path):
    robot = shutil.copytree(find_robot("melson"), tmp_path / "mine")
    text = (robot / "robot.yaml").read_text()
    (robot / "robot.yaml").write_text(text.replace("compliance_slope: 16, ", ""))
    result = run("envelope", robot, "-o", tmp_path / "out")
    assert result.exit_code == 2
    assert "give stiffness" in result.output
    assert not (tmp_path / "out").exists()
