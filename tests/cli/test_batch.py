"""Tests of mgs batch and mgs library: output and errors."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from mgs.library.summary import Summary
from tests.support.commands import files_below, run, run_process
from tests.support.libraries import LENGTHS, write_sweep

Made = tuple[Path, Summary]
N = 2 * len(LENGTHS)


def test_a_plan_prints_the_number_of_gaits_and_the_first_few(sweep: Path):
    result = run("batch", "plan", sweep, "--show", 2)
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert lines[0].startswith(f"{N} gaits, variations of ")
    assert lines[1].split() == ["0", "walk.step_length=0.0", 'walk.first_support="left"']
    assert lines[3] == f"   and {N - 2} more"


def test_a_plan_shows_invalid_gaits(tmp_path: Path):
    path = write_sweep(tmp_path, axes={"walk.step_length": [7]}, filters=["walk.step_length > 0"])
    found = json.loads(run("batch", "plan", path, "--json").stdout)
    assert (found["gaits"], found["filtered"], found["keys"]) == (1, 0, ["walk.step_length"])
    assert "less than or equal to 1 [m], found 7" in found["first"][0]["problem"]


def test_a_run_prints_a_table_by_reason_or_one_json_object(
    sweep: Path, made: Made, address: str, tmp_path: Path
):
    folder = tmp_path / "lib"
    shutil.copytree(made[0], folder)
    for file in ("000000.mcap", "000003.mcap"):
        (folder / "gaits" / file).unlink()
    result = run("batch", "run", sweep, "-o", folder, "--resume", "--dask", address, "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    found = json.loads(result.stdout)
    assert (found["gaits"], found["kept"], found["made"]) == (N, N - 2, 2)
    assert sum(found["verdicts"].values()) == N
    assert found["verdicts"]["infeasible"] == 2
    again = run("batch", "run", sweep, "-o", folder, "--resume")
    assert again.exit_code == 0
    assert f"{N} gaits, {N} already present; 0 made" in again.stdout
    assert any(line.split() == ["2", "infeasible"] for line in again.stdout.splitlines())


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (["--workers", "2", "--dask", "tcp://127.0.0.1:1"], 2, "the cluster has its own workers"),
        (["--servo", "model"], 2, "--physics"),
        (["--physics", "bullet"], 2, "bullet"),
        (["--workers", "0"], 2, "--workers"),
    ],
)
def test_options_that_exclude_each_other_are_refused_before_anything_is_written(
    sweep: Path, tmp_path: Path, options: list[str], code: int, told: str
):
    result = run("batch", "run", sweep, "-o", tmp_path / "lib", *options)
    assert result.exit_code == code
    assert told in result.stderr
    assert files_below(tmp_path) == {}


def test_a_library_that_exists_is_refused_without_resume(made: Made, sweep: Path):
    before = files_below(made[0])
    result = run("batch", "run", sweep, "-o", made[0])
    assert result.exit_code == 1
    assert "--resume" in result.stderr
    assert files_below(made[0]) == before


def test_a_query_prints_rows_or_json(made: Made):
    options = ("--where", "walk.step_length == 0.03", "--columns", "number,speed,robot")
    lines = run("library", "query", made[0], *options).stdout.splitlines()
    assert lines[0].split() == ["number", "speed", "robot"]
    assert [line.split()[0] for line in lines[1:]] == ["6", "7", "2"]
    found = json.loads(run("library", "query", made[0], *options, "--json").stdout)
    assert [row["number"] for row in found["rows"]] == [6, 7]
    names = run("library", "query", made[0], "--names").stdout.split()
    assert {"speed", "survived", "walk.step_length", "sha256"} <= set(names)


def test_a_wrong_condition_names_column_and_columns(made: Made):
    result = run("library", "query", made[0], "--where", "sped > 0.1")
    assert result.exit_code == 2
    assert "no column 'sped'; did you mean 'speed'?" in result.stderr
    assert "walk.step_length" in result.stderr


def test_a_table_is_exported_but_not_over_a_file(made: Made, tmp_path: Path):
    path = tmp_path / "speeds.csv"
    arguments = ("library", "export", made[0], "--format", "csv", "-o", path)
    assert run(*arguments, "--where", "verdict == 'infeasible'").exit_code == 0
    assert len(path.read_text().splitlines()) == 3
    assert run(*arguments).exit_code == 1
    found = json.loads(run(*arguments, "--force", "--json").stdout)
    assert found["gaits"] == N == len(path.read_text().splitlines()) - 1


def test_motions_are_exported_to_a_new_folder(made: Made, tmp_path: Path):
    out = tmp_path / "motions"
    arguments = ("library", "export", made[0], "--motions", "csv", "--fps", "20", "-o", out)
    result = run(*arguments, "--where", "number < 3")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == f"{out}: 3 motions written\n"
    assert run(*arguments).exit_code == 1
    again = run(*arguments, "--where", "number < 3", "--resume", "--json")
    told = json.loads(again.stdout)
    assert (told["written"], told["kept"], told["failed"]) == (0, 3, {})
    other = run(*arguments, "--resume")
    assert other.exit_code == 2 and "(where differ)" in other.stderr


def test_a_grid_that_is_not_full_has_exit_code_one(made: Made, tmp_path: Path):
    result = run(
        *("library", "export", made[0], "--motions", "npz", "--grid", "-o", tmp_path / "out"),
        *("--where", "walk.first_support == 'left'"),
    )
    assert result.exit_code == 1 and result.stderr == ""
    assert "grid of 6 x 1 x 1 velocities: 1 are missing" in result.stdout
    assert "missing: vx" in result.stdout


def test_motions_that_cannot_be_written_are_named(made: Made, tmp_path: Path):
    out = tmp_path / "out"
    result = run("library", "export", made[0], "--motions", "dynamixel", "-o", out)
    assert result.exit_code == 1
    assert "0 motions written" in result.stdout and "no motor given" in result.stdout


@pytest.mark.parametrize("options", [(), ("--format", "csv", "--motions", "csv")])
def test_either_the_table_or_the_motions_are_exported(made: Made, options: tuple[str, ...]):
    result = run("library", "export", made[0], *options)
    assert result.exit_code == 2
    assert "Give --format for the table, or --motions" in result.stderr


def test_a_report_names_a_damaged_file_and_has_exit_code_one(made: Made, tmp_path: Path):
    assert run("library", "report", made[0]).stdout.endswith("all files are intact\n")
    folder = tmp_path / "lib"
    shutil.copytree(made[0], folder)
    (folder / "gaits" / "000002.mcap").write_bytes(b"")
    result = run("library", "report", folder)
    assert result.exit_code == 1
    assert "1 files are damaged or missing, e.g. gaits/000002.mcap" in result.stdout
    assert json.loads(run("library", "report", folder, "--json").stdout)["made"] == N


@pytest.mark.parametrize("command", ["query", "report"])
def test_a_folder_without_a_library_is_refused(command: str, tmp_path: Path):
    result = run("library", command, tmp_path)
    assert result.exit_code == 2
    assert "no gait library" in result.stderr


def test_a_running_cluster_makes_the_same_library(sweep: Path, made: Made, tmp_path: Path):
    """Run as a process; stderr stays empty, without log lines of Dask or of its workers."""
    done = run_process("batch", "run", sweep, "-o", tmp_path / "lib", "--workers", "2", "--json")
    assert (done.returncode, done.stderr) == (0, b"")
    assert json.loads(done.stdout)["made"] == N
    expected = files_below(made[0] / "gaits")
    assert files_below(tmp_path / "lib" / "gaits") == expected
