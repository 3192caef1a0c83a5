"""Tests of mgs export with formats of other programs: what it prints, options, errors."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import mgs
from mgs.motion_file import read_motion
from mgs.motion_file.formats import FORMATS
from mgs.robot.orders import robot_order
from tests.support.commands import files_below, run


def test_the_file_is_named_after_motion_and_format(walk_file: Path):
    for fmt, name in (("mjlab", "walk.mjlab.npz"), ("sonic", "walk.sonic")):
        told = json.loads(run("export", walk_file, "--format", fmt, "--json").stdout)
        assert told["file"] == str(walk_file.with_name(name))
        assert FORMATS[fmt].read(Path(told["file"])).n_frames == told["samples"]


@pytest.mark.parametrize(
    ("options", "order"),
    [
        (["--format", "mjlab"], "depth-first"),
        (["--format", "beyondmimic"], "breadth-first"),
        (["--format", "mjlab", "--order", "breadth-first"], "breadth-first"),
    ],
)
def test_orders_are_printed(walk_file: Path, options: list[str], order: str, tmp_path: Path):
    arguments = ("export", walk_file, *options, "-o", tmp_path / "a.npz")
    told = json.loads(run(*arguments, "--json").stdout)
    expected = robot_order(read_motion(walk_file).robot, order)
    assert tuple(told["joints"]) == expected.joints
    assert tuple(told["links"]) == expected.links
    words = run(*arguments, "--force").stdout
    assert f"joints    {', '.join(expected.joints)}" in words
    assert f"links     {', '.join(expected.links)}" in words


def test_joints_can_be_chosen_by_list_and_by_file(walk_file: Path, tmp_path: Path):
    names = ["right_knee_pitch", "waist_yaw"]
    (tmp_path / "names.txt").write_text("right_knee_pitch\nwaist_yaw\n")
    tables = []
    for given in (",".join(names), f"@{tmp_path / 'names.txt'}"):
        arguments = ("--format", "unitree-csv", "--joints", given, "--force")
        assert run("export", walk_file, *arguments, "-o", tmp_path / "a.csv").exit_code == 0
        tables.append(np.loadtxt(tmp_path / "a.csv", delimiter=","))
    assert np.array_equal(*tables)
    motion = read_motion(walk_file)
    index = [motion.robot.joint_names.index(name) for name in names]
    assert np.abs(tables[0][0, 7:] - motion.q[0, 7:][index]).max() < 1e-9
    assert tables[0].shape[1] == 9


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--joints", "right_kne_pitch"], "did you mean 'right_knee_pitch'?"),
        (["--joints", "waist_yaw,waist_yaw"], "name every joint once"),
        (["--joints", "@nowhere.txt"], "nowhere.txt"),
        (["--fps", "1e6"], "fps: 1e+06 Hz is out of range"),
        (["--fps", "nan"], "not a finite number"),
        (["--fps", "0"], "is not in the range"),
        (["--order", "none"], "is not one of"),
    ],
)
def test_a_wrong_choice_is_named_and_leaves_no_file(
    walk_file: Path, options: list[str], said: str, tmp_path: Path
):
    arguments = ("--format", "unitree-csv", "-o", tmp_path / "a.csv", *options)
    result = run("export", walk_file, *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr
    assert files_below(tmp_path) == {}


def test_another_rate_than_readers_expect_is_told(walk_file: Path, tmp_path: Path):
    said = run("export", walk_file, "--format", "mjlab", "--fps", 25, "-o", tmp_path / "a").stdout
    assert "samples of 0.04 s" in said
    assert "note      25 frames per second; readers of mjlab often take 50" in said


@pytest.mark.parametrize("fmt", FORMATS)
def test_the_layout_of_a_format_is_printed(fmt: str):
    result = run("export", "--layout", fmt)
    assert result.exit_code == 0
    assert result.stdout.startswith(f"{fmt}: ")


def test_every_format_is_in_the_help_and_on_a_page():
    said = run("export", "--help").stdout
    docs = Path(mgs.__file__).parents[1] / "docs"
    pages = (docs / "formats.md").read_text() + (docs / "formats-robots.md").read_text()
    for fmt, found in FORMATS.items():
        assert f"  {fmt} " in said
        assert found.summary in said
        assert f"`{fmt}`" in pages


def test_a_folder_is_replaced_only_if_asked(walk_file: Path, tmp_path: Path):
    arguments = ("export", walk_file, "--format", "sonic", "-o", tmp_path / "walk")
    assert run(*arguments).exit_code == 0
    before = files_below(tmp_path)
    again = run(*arguments)
    assert again.exit_code == 1
    assert "use --force" in again.stderr
    assert run(*arguments, "--fps", 25, "--force").exit_code == 0
    assert files_below(tmp_path).keys() == before.keys()
    assert files_below(tmp_path) != before


def test_the_front_door_exports_formats(walk_file: Path, tmp_path: Path):
    options = ("--format", "mjlab", "--fps", 25, "--order", "breadth-first")
    assert run("export", walk_file, *options, "-o", tmp_path / "a.npz").exit_code == 0
    mgs.export(walk_file, tmp_path / "b.npz", "mjlab", fps=25.0, order="breadth-first")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--approach", "3"], "--approach: format csv does not use it, only op3-action, bitbots"),
        (["--tolerance", "1"], "--tolerance: format csv does not use it, only op3-action;"),
    ],
)
def test_options_that_a_format_does_not_use_are_refused(
    walk_file: Path, options: list[str], message: str, tmp_path: Path
):
    result = run("export", walk_file, *options, "-o", tmp_path / "a.csv")
    assert (result.exit_code, message in result.stderr) == (2, True), result.stderr
    assert not (tmp_path / "a.csv").exists()
