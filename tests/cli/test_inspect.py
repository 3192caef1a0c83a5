"""Tests of mgs info and mgs plot."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

from mgs.motion_file import read_info
from tests.support.commands import files_below, run


def test_info_prints_the_metadata_of_the_file(walk_file: Path):
    result = run("info", walk_file, "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    told = json.loads(result.stdout)
    assert {*told.pop("engines"), *(e["engine"] for e in told.pop("engines_missing"))} == {
        "pybullet",
        "mujoco",
    }
    assert told.pop("json_version") == 1
    assert told == read_info(walk_file)


def test_info_names_the_engines_and_what_to_do_about_a_missing_one(walk_file: Path, monkeypatch):
    found = importlib.util.find_spec

    def without_pybullet(name: str, package: str | None = None):
        return None if name == "pybullet" else found(name, package)

    monkeypatch.setattr(importlib.util, "find_spec", without_pybullet)
    told = json.loads(run("info", walk_file, "--json").stdout)
    assert [engine["engine"] for engine in told["engines_missing"]] == ["pybullet"]
    text = run("info", walk_file).stdout
    assert "\nengines: " in text and "\npybullet is MISSING: " in text
    assert "pip install pybullet" in text


def test_info_in_words_names_topics_and_attachments(walk_file: Path):
    result = run("info", walk_file)
    assert (result.exit_code, result.stderr) == (0, "")
    content = read_info(walk_file)
    for topic in content["topics"]:
        assert f"  {topic['topic']}, {topic['type']}, {topic['messages']}\n" in result.stdout
    for text in ("robot: melson", "gait: walk_practical", "robot.urdf", "samples: 351", "steps: 2"):
        assert text in result.stdout


def test_a_pipe_that_is_closed_early_is_not_an_error(walk_file: Path):
    """This happens in `mgs info walk.mcap | head -1`."""
    script = "from mgs.cli import main; main(prog_name='mgs')"
    command = [sys.executable, "-c", script, "info", str(walk_file)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""


def test_plot_draws_and_does_not_overwrite(walk_file: Path, tmp_path: Path):
    plots = tmp_path / "new" / "plots"
    result = run("plot", walk_file, "-o", plots, "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    drawn = json.loads(result.stdout)
    assert drawn["file"] == str(walk_file)
    assert sorted(drawn["plots"]) == sorted(str(path) for path in plots.iterdir())
    assert all(path.endswith(".png") for path in drawn["plots"])
    before = files_below(tmp_path)
    again = run("plot", walk_file, "-o", plots)
    assert (again.exit_code, again.stdout) == (1, "")
    assert "--force" in again.stderr
    assert files_below(tmp_path) == before


def test_a_file_where_the_folder_should_be_is_a_usage_error(walk_file: Path, tmp_path: Path):
    (tmp_path / "plots").write_text("mine")
    result = run("plot", walk_file, "-o", tmp_path / "plots")
    assert (result.exit_code, result.stdout) == (2, "")
    assert files_below(tmp_path) == {"plots": b"mine"}


def test_info_judges_by_the_static_checks_as_validate_does(walk_file: Path, falling_file: Path):
    for file in (walk_file, falling_file):
        verdict = json.loads(run("validate", file, "--physics", "none", "--json").stdout)
        told = json.loads(run("info", file, "--check", "--json").stdout)
        assert told["static_checks"] == verdict["checks"]
        text = run("info", file, "--check").stdout
        passes = verdict["verdict"] == "pass"
        assert f"verdict: {'passes' if passes else 'FAILS'} the static checks" in text
        for check in verdict["checks"]:
            assert (f"  FAIL {check['name']} " in text) == (not check["ok"])
    assert not passes
    assert "verdict: not in the file" in run("info", walk_file).stdout
