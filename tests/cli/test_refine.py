"""Tests of mgs refine: an improved motion is written; without improvement nothing is."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import mgs.search.refine
from mgs.motion_file import read_motion
from mgs.sim import available_engines
from tests.support.commands import run

pytestmark = pytest.mark.skipif(
    "mujoco" not in available_engines(), reason="MuJoCo is not installed"
)
QUICK = ("--physics", "mujoco", "--no-feed-forward", "--attempts", "2")


def test_an_improved_motion_is_written_and_reported(walk_file: Path, tmp_path: Path):
    path = tmp_path / "better.mcap"
    result = run("refine", walk_file, *QUICK, "-o", path, "--json")
    told = json.loads(result.stdout)
    assert set(told) == {"json_version", "file", "improved", "before", "after", "attempts"}
    assert result.exit_code == (0 if told["improved"] else 1)
    assert told["improved"], told  # a short walk on compliant servos deviates enough from its plan
    assert told["after"][0]["tilt_rms_deg"] < told["before"][0]["tilt_rms_deg"]
    assert read_motion(path).provenance.refined.engines == ("mujoco",)
    again = run("refine", walk_file, *QUICK, "-o", path)
    assert again.exit_code == 1
    assert "use --force to replace it" in again.output
    words = run("refine", walk_file, *QUICK, "-o", path, "--force").stdout
    for text in (
        "as planned",
        "correction 1, 0.4 of the deviation",
        "touchdown errors",
        "improved motion: ",
    ):
        assert text in words


def test_without_an_improvement_nothing_is_written(
    walk_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(mgs.search.refine, "_why_not", lambda old, new: "no better in mujoco")
    path = tmp_path / "no.mcap"
    result = run("refine", walk_file, *QUICK, "--attempts", "1", "-o", path)
    assert result.exit_code == 1
    assert "rejected: no better in mujoco" in result.output
    assert "no correction is an improvement; no file was written" in result.output
    assert not path.exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--physics", "none"), "--physics: none is not possible, because the corrections need"),
        (("--part", "nan"), "not a finite number"),
        (("--part", "2"), "is not in the range"),
        (
            ("--servo", "ideal", "--feed-forward"),
            "ideal servos have no position error",
        ),
    ],
)
def test_wrong_usage_is_refused(walk_file: Path, arguments: tuple[str, ...], words: str):
    result = run("refine", walk_file, *arguments)
    assert result.exit_code == 2
    assert words in result.output
