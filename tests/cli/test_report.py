"""Tests of mgs report."""

from __future__ import annotations

import json
from pathlib import Path

from tests.support.commands import run


def test_report_writes_a_page_and_tells_the_verdict(walk_file: Path, tmp_path: Path):
    page = tmp_path / "page.html"
    result = run("report", walk_file, "-o", page)
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.splitlines() == ["walk.mcap: PASS", f"{page}: open it in a web browser"]
    assert page.stat().st_size < 4_000_000
    again = run("report", walk_file, "-o", page)
    assert again.exit_code == 1 and "--force" in again.stderr


def test_a_failing_motion_gets_a_page_too(falling_file: Path, tmp_path: Path):
    page = tmp_path / "page.html"
    result = run("report", falling_file, "-o", page, "--json")
    assert result.exit_code == 0
    told = json.loads(result.stdout)
    assert told["bytes"] == page.stat().st_size
    (motion,) = told["motions"]
    assert not motion["passed"] and "zmp_margin" in motion["failed"]


def test_several_files_are_compared_on_request_only(walk_file: Path, tmp_path: Path):
    page = tmp_path / "page.html"
    assert run("report", walk_file, walk_file, "-o", page).exit_code == 2
    assert run("report", "--compare", walk_file, "-o", page).exit_code == 2
    assert not page.exists()
    assert run("report", "--compare", walk_file, walk_file, "-o", page).exit_code == 0


def test_an_unknown_engine_is_refused(walk_file: Path, tmp_path: Path):
    result = run("report", walk_file, "-o", tmp_path / "page.html", "--replay", "bullet")
    assert result.exit_code == 2
    assert "--replay" in result.stderr and "pybullet" in result.stderr
