"""The commands mgs import, mgs audit and mgs repair."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from clean_motions import shipped
from click.testing import CliRunner, Result

from mgs.cli import main
from mgs.judge.audit import Finding
from mgs.judge.audit.finding import annotation
from mgs.motion.sampled import sample
from mgs.motion_file import read_motion, write_motion
from mgs.motion_file.formats import FORMATS, Options


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A walk in the layout unitree-csv, 30 frames a second."""
    path = tmp_path_factory.mktemp("foreign") / "walk.csv"
    FORMATS["unitree-csv"].write(sample(shipped("melson/walk_practical"), 30.0), path, Options())
    return path


@pytest.fixture(scope="module")
def sunk(table: Path) -> Path:
    """The same walk 20 mm below the floor."""
    rows = np.loadtxt(table, delimiter=",")
    rows[:, 2] -= 0.02
    path = table.with_name("sunk.csv")
    np.savetxt(path, rows, delimiter=",")
    return path


def test_an_imported_motion_is_a_motion_file_that_other_commands_read(table: Path, tmp_path: Path):
    target = tmp_path / "walk.mcap"
    result = run("import", table, "--robot", "melson", "--fps", "30", "-o", target)
    assert result.exit_code == 0, result.output
    assert "layout unitree-csv" in result.output and "quaternions xyzw" in result.output
    verdict = run("validate", target, "--physics", "none")
    assert verdict.exit_code == 0, verdict.output
    assert "not made, since the motion was not planned: sole_position" in verdict.output
    assert run("info", target).exit_code == 0
    assert run("plot", target, "-o", tmp_path / "plots").exit_code == 0
    assert run("report", target, "-o", tmp_path / "walk.html").exit_code == 0
    replayed = run("replay", target, "--engine", "mujoco", "--json")
    assert replayed.exit_code == 0 and json.loads(replayed.output)["fell"] is False
    again = run("import", table, "--robot", "melson", "--fps", "30", "-o", target)
    assert again.exit_code == 1 and "--force" in again.output


def test_import_asks_for_what_the_file_does_not_say(table: Path, tmp_path: Path):
    target = tmp_path / "walk.mcap"
    for arguments, told in (
        (("--fps", "30"), "name a robot or its folder"),
        (("--robot", "melson"), "give it with --fps"),
        (("--robot", "coman", "--fps", "30"), "robot coman has 29"),
        (("--robot", "melson", "--layout", "mjlb"), "did you mean 'mjlab'?"),
        (("--robot", "melson", "--layout", "mjlab", "--fps", "30"), "walk.csv"),
    ):
        result = run("import", table, *arguments, "-o", target)
        assert result.exit_code == 2 and told in result.output, result.output
        assert "Traceback" not in result.output and not target.exists()


def test_a_motion_file_is_not_imported_again(tmp_path: Path):
    path = tmp_path / "walk.mcap"
    write_motion(shipped("melson/walk_practical"), path)
    result = run("import", path, "--robot", "melson", "-o", tmp_path / "again.mcap")
    assert result.exit_code == 2 and "read it as it is" in result.output


def test_a_recorded_motion_cannot_be_asked_for_by_a_gait_file(tmp_path: Path):
    path = tmp_path / "gait.yaml"
    path.write_text("{mgs: 1, motion: recorded, robot: melson}")
    result = run("generate", path, "-o", tmp_path / "out.mcap")
    assert result.exit_code == 2 and "motion: input should be" in result.output


def test_an_audit_is_clean_or_lists_what_it_found(table: Path, sunk: Path):
    clean = run("audit", table, "--robot", "melson", "--fps", "30")
    assert clean.exit_code == 0 and clean.output.splitlines()[-1] == "CLEAN"
    found = run("audit", sunk, "--robot", "melson", "--fps", "30")
    assert found.exit_code == 1 and "penetration: a part of the robot" in found.output
    told = json.loads(run("audit", sunk, "--robot", "melson", "--fps", "30", "--json").output)
    assert told["json_version"] == 1 and told["verdict"] == "findings"
    (finding,) = told["findings"]
    assert finding["kind"] == "penetration"
    assert finding["amount"] == pytest.approx(0.02, abs=1e-4)
    assert set(finding) == {"kind", "start", "end", "time", "amount", "limit", "unit", "where",
                            "text"}  # fmt: skip


def test_findings_are_annotations_of_github(sunk: Path):
    result = run("audit", sunk, "--robot", "melson", "--fps", "30", "--format", "github")
    (line,) = result.output.splitlines()
    assert line.startswith(f"::error file={sunk},title=mgs audit%3A penetration::a part of")


def test_an_annotation_escapes_what_would_end_it():
    finding = Finding("slip", 0.0, 1.0, 0.5, 0.02, 0.01, "m/s", "left\nsole 100 %")
    line = annotation(finding, "a,b:c.csv")
    assert line.startswith("::error file=a%2Cb%3Ac.csv,title=")
    assert "left%0Asole 100 %25" in line and "\n" not in line


def test_an_audit_with_physics_replays_the_motion(table: Path):
    result = run("audit", table, "--robot", "melson", "--fps", "30", "--physics", "mujoco")
    assert "mujoco_upright" in result.output and "sole_still" not in result.output
    assert result.exit_code == 0, result.output


def test_a_repaired_motion_is_written_and_passes_the_audit(sunk: Path, tmp_path: Path):
    target = tmp_path / "repaired.mcap"
    result = run("repair", sunk, "--robot", "melson", "--fps", "30", "-o", target)
    assert result.exit_code == 0, result.output
    assert "soles below the floor" in result.output and "20.00 ->" in result.output
    assert run("audit", target).exit_code == 0
    assert "changed by mgs repair" in read_motion(target).gait.recorded.notes  # type: ignore[union-attr]


def test_what_cannot_be_repaired_is_told(tmp_path: Path):
    path = tmp_path / "stairs.mcap"
    write_motion(shipped("coman/stairs"), path)
    result = run("repair", path, "-o", tmp_path / "out.mcap")
    assert result.exit_code == 1 and "level floor" in result.output
    assert not (tmp_path / "out.mcap").exists()


@pytest.mark.parametrize("n", [1, 5])
def test_a_motion_too_short_for_an_audit_is_told(n: int, sunk: Path, tmp_path: Path):
    """And no warning about means of nothing is printed."""
    path = tmp_path / "short.csv"
    path.write_text("\n".join(sunk.read_text().splitlines()[:n]))
    result = run("audit", path, "--robot", "melson", "--layout", "unitree-csv", "--fps", "30")
    assert result.exit_code == 2 and "Traceback" not in result.output, result.output
    assert f"has {n} " in result.output


def test_a_motion_of_the_least_length_is_audited(table: Path, tmp_path: Path):
    path = tmp_path / "short.csv"
    path.write_text("\n".join(table.read_text().splitlines()[:6]))
    result = run("audit", path, "--robot", "melson", "--layout", "unitree-csv", "--fps", "30")
    assert result.exit_code == 0 and "CLEAN" in result.output, result.output


def test_a_motion_of_one_frame_is_not_imported(table: Path, tmp_path: Path):
    path, target = tmp_path / "one.csv", tmp_path / "one.mcap"
    path.write_text(table.read_text().splitlines()[0])
    for layout in ([], ["--layout", "unitree-csv"]):
        result = run("import", path, "--robot", "melson", "--fps", "30", *layout, "-o", target)
        assert (result.exit_code, target.exists()) == (2, False), result.output
        assert "has 1 frame; a motion has at least 2" in result.output


@pytest.mark.parametrize("command", ["audit", "repair"])
@pytest.mark.parametrize(
    ("said", "told"),
    [
        (["--robot", "coman"], "a motion of robot melson, not of coman"),
        (["--fps", "30"], "--fps: "),
        (["--quaternion", "wxyz"], "--quaternion: "),
        (["--order", "depth-first"], "--order: "),
    ],
)
def test_what_a_motion_file_states_is_not_asked_of_the_user(
    walk_file: Path, tmp_path: Path, command: str, said: list[str], told: str
):
    target = tmp_path / "out.mcap"
    output = ["-o", target] if command == "repair" else []
    result = run(command, walk_file, *said, *output)
    assert result.exit_code == 2 and told in result.output, result.output
    assert "leave the option out" in result.output and not target.exists()


def test_a_table_of_degrees_is_the_same_motion(table: Path, tmp_path: Path):
    rows = np.loadtxt(table, delimiter=",")
    rows[:, 7:] = np.degrees(rows[:, 7:])
    path = tmp_path / "degrees.csv"
    np.savetxt(path, rows, delimiter=",", fmt="%.9f")
    options = ("--robot", "melson", "--fps", "30")
    assert run("import", path, *options, "--degrees").exit_code == 0
    assert run("import", table, *options, "-o", tmp_path / "radians.mcap").exit_code == 0
    q = [read_motion(tmp_path / f"{name}.mcap").q for name in ("degrees", "radians")]
    np.testing.assert_allclose(q[0], q[1], atol=1e-6)
    refused = run("audit", tmp_path / "degrees.mcap", "--degrees")
    assert refused.exit_code == 2 and "--degrees" in refused.output
