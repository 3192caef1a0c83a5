"""Tests of mgs gait list and mgs gait show."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mgs.core.shipped import shipped_folder
from mgs.gait import list_gaits, load_gait
from tests.support.commands import run


def test_every_shipped_gait_is_listed_with_its_purpose():
    rows = json.loads(run("gait", "list", "--json").stdout)["gaits"]
    assert [row["name"] for row in rows] == list_gaits()
    assert all(len(row["about"]) >= len("Bow; 5.5 s") for row in rows)
    (eight,) = [row["about"] for row in rows if row["name"] == "coman/hand_eight"]
    assert "M. Mistry" in eight
    assert all(row["motion"] == load_gait(row["name"]).motion for row in rows)


def test_the_list_can_be_narrowed_to_a_robot_and_a_kind():
    rows = json.loads(run("gait", "list", "--robot", "coman", "--motion", "walk", "--json").stdout)
    names = [row["name"] for row in rows["gaits"]]
    assert "coman/walk" in names and "generic/walk" in names
    assert not any(name.startswith("melson") or "kick" in name for name in names)


@pytest.mark.parametrize(("option", "value"), [("--robot", "nao"), ("--motion", "fly")])
def test_an_unknown_filter_is_told_what_is_known(option: str, value: str):
    result = run("gait", "list", option, value)
    assert result.exit_code == 2
    assert value in result.stderr and "known here" in result.stderr


def test_a_shown_gait_is_its_file(tmp_path: Path):
    result = run("gait", "show", "melson/walk_practical")
    file = shipped_folder("gaits") / "melson" / "walk_practical.yaml"
    assert result.stdout == file.read_text(encoding="utf-8")
    (tmp_path / "mine.yaml").write_text(result.stdout, encoding="utf-8")
    assert load_gait(tmp_path / "mine.yaml") == load_gait("melson/walk_practical")


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ("melson/walk_5c", "melson/walk_5cm"),
        ("melson/kik", "melson/kick"),
        ("coman/wlak", "coman/walk"),
    ],
)
def test_a_misspelt_gait_is_told_the_nearest_names(wrong: str, right: str):
    result = run("generate", wrong)
    assert result.exit_code == 2
    assert f"did you mean {right}" in result.stderr
