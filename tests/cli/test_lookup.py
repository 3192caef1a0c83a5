"""Tests of mgs library lookup: files, output and errors."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mgs.library.manifest import writing
from mgs.motion_file.formats.lookup import LOOKUPS
from mgs.motion_file.formats.pickle_file import read_pickle
from tests.support.commands import files_below, run

BASE = ("melson/walk_practical", "--set", "walk.n_steps=8", "--set", "com.passes=0")
LENGTHS = (0.02, 0.04)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two walks ahead, one that is faster in time, and a short one that failed."""
    folder = tmp_path_factory.mktemp("library") / "walks"
    gaits = [("walk.step_length", value) for value in LENGTHS]
    gaits += [("walk.single_support", 0.6), ("walk.n_steps", 2)]
    identity = {"number of gaits": "4", "keys": "[]", "physics": "none", "mgs version": "0"}
    folder.mkdir()
    with writing(folder, identity, ("name",)) as manifest:
        manifest.connection.execute("BEGIN")
        for number, (key, value) in enumerate(gaits):
            file = folder / f"gaits/{number}.mcap"
            assert run("generate", *BASE, "--set", f"{key}={value}", "-o", file).exit_code == 0
            row = {"number": number, "file": f"gaits/{number}.mcap", "robot": "melson"}
            row |= {"verdict": "pass" if number < 3 else "fail", "vx": 0.05, "vy": 0.0, "wz": 0.0}
            manifest.keep(row | {"name": key})
        manifest.connection.execute("COMMIT")
    return folder


STEPS = "verdict == 'pass' and name == 'walk.step_length'"


@pytest.mark.parametrize("name", LOOKUPS)
def test_a_table_is_written_beside_the_library(library: Path, name: str):
    arguments = ("library", "lookup", library, "--format", name, "--where", STEPS)
    result = run(*arguments, "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    told = json.loads(result.stdout)
    assert told["file"] == str(library.with_name(f"walks.{name}.pkl"))
    assert told["velocities"] == [[0.025, 0.0, 0.0], [0.05, 0.0, 0.0]]
    found = read_pickle(Path(told["file"]))
    assert len(found if name == "open-duck-poly" else found[0]) == told["walks"] == 2
    again = run(*arguments)
    assert again.exit_code == 1
    assert "use --force" in again.stderr
    words = run(*arguments, "--force").stdout
    assert "2 walks" in words
    assert "vx        0.025, 0.05 m/s" in words


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        (["--where", "verdict == 'pass'"], 2, "all walks need the same period"),
        (["--where", "verdict == 'fail'"], 1, "no two steps in its middle"),
        (["--where", "number == 77"], 1, "no gait of this library fulfils"),
        (["--where", "nonsense"], 2, "nonsense"),
        (["--where", STEPS, "--fps", "33"], 2, "0.mcap: a cycle of 1.6 s is 52.800 frames"),
        (["--where", STEPS, "--digits", "0"], 2, "two walks have the velocity (0.0, 0.0, 0.0)"),
        (["--where", STEPS, "--joints", "left_toe"], 2, "'left_toe' is no joint"),
        (["--format", "none"], 2, "is not one of"),
    ],
)
def test_what_does_not_fit_is_named_and_leaves_no_file(
    library: Path, options: list[str], code: int, said: str, tmp_path: Path
):
    arguments = ("--format", "open-duck-poly", "-o", tmp_path / "a.pkl", *options)
    result = run("library", "lookup", library, *arguments)
    assert (result.exit_code, result.stdout) == (code, "")
    assert said in result.stderr
    assert files_below(tmp_path) == {}


@pytest.mark.parametrize("name", LOOKUPS)
def test_the_layout_of_a_table_is_printed(name: str):
    result = run("library", "lookup", "--layout", name)
    assert result.exit_code == 0
    assert result.stdout.startswith(f"{name}: ")
