"""Tests of mgs robot init, and of the generic walk with the robot that it writes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.support.bipeds import Biped
from tests.support.commands import run


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    path = tmp_path / "boxes.urdf"
    path.write_text(Biped().urdf())
    return path


def test_init_check_generate_without_editing(urdf: Path, tmp_path: Path):
    folder, motion = tmp_path / "mine", tmp_path / "walk.mcap"
    shown = run("robot", "init", str(urdf), "-o", str(folder))
    assert shown.exit_code == 0, shown.stderr
    assert "left_hip_yaw, left_hip_roll" in shown.stdout
    assert run("robot", "check", str(folder)).exit_code == 0
    done = run("generate", "walk", "--robot", str(folder), "-o", str(motion), "--json")
    assert done.exit_code == 0, done.stderr
    assert json.loads(done.stdout)["robot"] == "boxes"
    judged = run("validate", str(motion), "--physics", "none", "--json")
    assert json.loads(judged.stdout)["verdict"] == "pass"


def test_json_lists_the_findings(urdf: Path, tmp_path: Path):
    out = run("robot", "init", str(urdf), "-o", str(tmp_path / "a"), "--name", "Bo", "--json")
    found = json.loads(out.stdout)
    assert (found["robot"], found["locked"], found["notes"]) == ("Bo", [], [])
    assert found["soles"]["left"] == pytest.approx([0.2, 0.1])
    assert set(found["groups"]) == {"left_leg", "right_leg", "left_arm", "right_arm", "waist"}
    assert all(finding["ok"] for finding in found["findings"])


def test_an_existing_folder_is_not_overwritten(urdf: Path, tmp_path: Path):
    folder = tmp_path / "mine"
    assert run("robot", "init", str(urdf), "-o", str(folder)).exit_code == 0
    (folder / "robot.yaml").write_text("mine")
    refused = run("robot", "init", str(urdf), "-o", str(folder))
    assert refused.exit_code == 1
    assert "--force" in refused.stderr
    assert (folder / "robot.yaml").read_text() == "mine"
    assert run("robot", "init", str(urdf), "-o", str(folder), "--force").exit_code == 0


def test_bad_input_is_a_usage_error(tmp_path: Path):
    missing = run("robot", "init", str(tmp_path / "none.urdf"), "-o", str(tmp_path / "a"))
    assert missing.exit_code == 2
    assert "no such file" in missing.stderr
    (tmp_path / "bad.urdf").write_text("<robot")
    bad = run("robot", "init", str(tmp_path / "bad.urdf"), "-o", str(tmp_path / "a"))
    assert bad.exit_code == 2
    assert "Traceback" not in bad.stderr
    assert not (tmp_path / "a").exists()
