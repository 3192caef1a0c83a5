"""Tests of all commands that read a motion file, with a sequence."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mgs.gait import SequenceGait
from mgs.motion_file import read_motion
from mgs.sim import available_engines
from tests.support.commands import run

QUICK = "com.preview: 0.8, walk.lead_in: 0.8, walk.lead_out: 0.8, walk.n_steps: 2, com.passes: 0"
TEXT = f"""
mgs: 1
robot: melson
motion: sequence
sequence:
  parts:
    - {{gait: melson/walk_practical, set: {{{QUICK}}}}}
    - {{name: back, gait: walks/back.yaml}}
"""
BACK = """
mgs: 1
motion: walk
walk: {n_steps: 2, step_length: -0.05, lead_in: 0.8, lead_out: 0.8, double_support: 0.4}
com: {preview: 0.8, passes: 0}
"""
needs_mujoco = pytest.mark.skipif("mujoco" not in available_engines(), reason="no MuJoCo")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sequence and its motion; the gait file that the sequence names has been deleted."""
    folder = tmp_path_factory.mktemp("sequence")
    (folder / "walks").mkdir()
    (folder / "walks/back.yaml").write_text(BACK)
    (folder / "there_and_back.yaml").write_text(TEXT)
    result = run("generate", folder / "there_and_back.yaml", "-o", folder / "a.mcap", "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    told = json.loads(result.stdout)
    assert (told["solver"], told["gait"], told["zmp_error"]) == ("clik", "there_and_back", None)
    (folder / "walks/back.yaml").unlink()
    return folder


def test_the_motion_file_holds_the_whole_gait(folder: Path):
    motion = read_motion(folder / "a.mcap")
    assert isinstance(motion.gait, SequenceGait)
    assert [part.label for part in motion.gait.sequence.parts] == ["melson/walk_practical", "back"]
    assert motion.gait.sequence.parts[1].gait.walk.step_length == -0.05
    assert np.abs(motion.soles_ref[-1, :, 0]).max() < 1e-12
    assert len(motion.footsteps) == 6


def test_info_plot_and_the_static_verdict_work(folder: Path, tmp_path: Path):
    info = json.loads(run("info", folder / "a.mcap", "--json").stdout)
    assert len(info["metadata"]["solver"]["parts"]) == 2
    verdict = run("validate", folder / "a.mcap", "--physics", "none", "--json")
    assert json.loads(verdict.stdout)["verdict"] == "pass"
    assert run("plot", folder / "a.mcap", "-o", tmp_path).exit_code == 0
    assert any(tmp_path.iterdir())


@needs_mujoco
def test_a_replay_and_a_random_draw_work(folder: Path):
    ideal = ("--physics", "mujoco", "--servo", "ideal")
    options = (*ideal, "--monte-carlo", "1", "--ranges", "lab", "--json")
    told = json.loads(run("validate", folder / "a.mcap", *options).stdout)
    assert told["verdict"] == "pass"
    assert told["monte_carlo"]["n"] == 1


@needs_mujoco
def test_refine_refuses_sequences(folder: Path):
    result = run("refine", folder / "a.mcap", "--physics", "mujoco")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "a sequence cannot be refined as a whole" in result.stderr


def test_a_wrong_part_is_named_and_nothing_is_written(folder: Path, tmp_path: Path):
    (tmp_path / "a.yaml").write_text(TEXT.replace("walks/back.yaml", "melson/walk_20cm"))
    result = run("generate", tmp_path / "a.yaml", "-o", tmp_path / "a.mcap")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "a.yaml: sequence.parts.1: melson/walk_20cm: no such file" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["a.yaml"]


def test_an_infeasible_part_is_reported_with_its_name(tmp_path: Path):
    far = TEXT.replace(
        "gait: walks/back.yaml", "gait: melson/walk_5cm, set: {walk.step_width: 0.12}"
    )
    (tmp_path / "a.yaml").write_text(far)
    result = run("generate", tmp_path / "a.yaml", "-o", tmp_path / "a.mcap")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "sequence.parts.1 (back) does not begin as the part before it ends" in result.stderr
