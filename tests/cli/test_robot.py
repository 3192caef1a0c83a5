"""Tests of mgs robot: shipped robots pass, errors in a robot folder are found."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from mgs.core.shipped import shipped_folder
from tests.support.commands import SHORT_WALK, files_below, run

MELSON = shipped_folder("robots") / "melson"
YAML = (MELSON / "robot.yaml").read_text()
URDF = (MELSON / "robot.urdf").read_text()
FINDINGS = [
    "inertias",
    "legs",
    "symmetry",
    "limits",
    "soles_level",
    "balance",
    "strength",
    "collisions",
    "engines",
    "default_walk",
]


def write_robot(folder: Path, yaml_text: str | bytes = YAML, urdf: str | bytes = URDF) -> Path:
    folder.mkdir(exist_ok=True)
    for name, content in (("robot.yaml", yaml_text), ("robot.urdf", urdf)):
        data = content.encode() if isinstance(content, str) else content
        (folder / name).write_bytes(data)
    return folder


def replaced(text: str, pattern: str, new: str, count: int = 1) -> str:
    changed, n = re.subn(pattern, new, text, count=count, flags=re.DOTALL)
    assert n >= 1, pattern
    return changed


# --- what ships -------------------------------------------------------------------------------


def test_list_names_what_ships():
    names = sorted(path.parent.name for path in shipped_folder("robots").glob("*/robot.yaml"))
    assert run("robot", "list").stdout.split() == names
    assert json.loads(run("robot", "list", "--json").stdout)["robots"] == names
    assert "melson" in names


def test_show_lists_every_joint():
    shown = json.loads(run("robot", "show", "melson", "--json").stdout)
    assert (shown["robot"], len(shown["joints"])) == ("melson", 19)
    assert shown["mass"] == pytest.approx(2.6, rel=0.01)
    assert shown["soles"] == {"left": [0.106, 0.06], "right": [0.106, 0.06]}
    for joint in shown["joints"]:
        assert joint["lower"] <= joint["posture"] <= joint["upper"]
        assert joint["servo"] in ("RX-28", "AX-12")
    text = run("robot", "show", "melson").stdout
    assert all(joint["joint"] in text for joint in shown["joints"])
    assert text.splitlines()[1] == "soles, left and right: 106 x 60 mm and 106 x 60 mm"


@pytest.mark.parametrize(
    "name",
    [  # the default walk of COMAN takes several plans to fit
        pytest.param(
            path.parent.name, marks=[pytest.mark.slow] * (path.parent.name == "coman_legs")
        )
        for path in sorted(MELSON.parent.glob("*/robot.yaml"))
    ],
)
@pytest.mark.slow_if("coman")
def test_every_shipped_robot_is_sound(name: str):
    result = run("robot", "check", name, "--json")
    assert result.exit_code == 0
    findings = json.loads(result.stdout)["findings"]
    assert [finding["name"] for finding in findings] == FINDINGS
    assert all(finding["ok"] for finding in findings)
    assert "FAIL" not in run("robot", "check", name).stdout


def test_a_robot_is_checked_by_folder_too(tmp_path: Path):
    folder = write_robot(tmp_path / "copy")
    assert run("robot", "check", folder).exit_code == 0
    assert run("robot", "check", folder / "robot.yaml").exit_code == 0


# --- tampered ---------------------------------------------------------------------------------


def posture(joint: str, angle: float) -> Callable[[], tuple[str, str]]:
    return lambda: (replaced(YAML, rf"  {joint}: [-\d.]+", f"  {joint}: {angle}"), URDF)


def heavy_left_arm() -> tuple[str, str]:
    link = r'(<link name="left_forearm">.*?<mass value=")[^"]*'
    return YAML, replaced(URDF, link, r"\g<1>0.3")


def thin_torso() -> tuple[str, str]:
    """Physically impossible inertias: one exceeds the sum of the others."""
    return YAML, replaced(URDF, r'(<link name="torso">.*?ixx=")[^"]*', r"\g<1>9.0")


def far_forward_soles() -> tuple[str, str]:
    return replaced(YAML, r"position: \[0.002,", "position: [0.062,", count=2), URDF


def thick_arm() -> tuple[str, str]:
    box = r'(<link name="left_forearm">.*?<collision.*?<box size=")[^"]*'
    return YAML, replaced(URDF, box, r"\g<1>0.3 0.3 0.3")


TAMPERED = {
    "tilted sole": (posture("left_ankle_pitch", -0.40), {"soles_level"}),
    "bent knee": (posture("right_knee_pitch", 0.95), {"soles_level"}),
    "heavy left arm": (heavy_left_arm, {"symmetry"}),
    "impossible inertia": (thin_torso, {"inertias"}),
    "soles too far ahead": (far_forward_soles, {"balance"}),
    "arm in the body": (thick_arm, {"collisions"}),
}


@pytest.mark.parametrize("kind", TAMPERED)
def test_an_error_in_a_robot_folder_is_found(kind: str, tmp_path: Path):
    tamper, expected = TAMPERED[kind]
    folder = write_robot(tmp_path / "robot", *tamper())
    result = run("robot", "check", folder, "--json")
    assert result.exit_code == 1
    assert result.stderr == ""
    findings = {finding["name"]: finding for finding in json.loads(result.stdout)["findings"]}
    assert {name for name, finding in findings.items() if not finding["ok"]} == expected
    text = run("robot", "check", folder)
    assert text.exit_code == 1
    for name in expected:
        assert f"FAIL {name}" in text.stdout
        assert f"remedy: {findings[name]['remedy']}" in text.stdout


# --- malformed --------------------------------------------------------------------------------

MALFORMED: dict[str, tuple[str | bytes, str | bytes, str]] = {
    "empty robot.yaml": ("", URDF, "expected keys and values"),
    "robot.yaml is no YAML": ("mgs: [", URDF, "line 1"),
    "robot.yaml is binary": (b"\x89PNG\r\n\x1a\n\x00", URDF, "not a text file"),
    "robot.yaml is the URDF": (URDF, URDF, "robot.yaml"),
    "unknown key": (YAML + "colour: red\n", URDF, "colour: unknown key"),
    "unknown key of a servo": (
        YAML.replace("armature", "armour"),
        URDF,
        "servos.RX-28.armour: unknown key; did you mean 'armature'?",
    ),
    "unknown link": (YAML.replace("link: torso", "link: chest"), URDF, "no link 'chest'"),
    "unknown joint": (YAML.replace("waist_yaw:", "neck:"), URDF, "no joint 'neck'"),
    "unknown servo": (YAML.replace("waist_yaw: AX-12", "waist_yaw: AX-99"), URDF, "'AX-99'"),
    "version of another time": (YAML.replace("mgs: 1", "mgs: 2"), URDF, "mgs: input should be 1"),
    "a truth for a version": (YAML.replace("mgs: 1", "mgs: true"), URDF, "found True"),
    "robot.urdf elsewhere": (
        YAML.replace("urdf: robot.urdf", "urdf: other.urdf"),
        URDF,
        "other.urdf: no such file",
    ),
    "empty robot.urdf": (YAML, "", "cannot read it as a URDF"),
    "robot.urdf is no XML": (YAML, "a robot", "cannot read it as a URDF"),
    "robot.urdf is other XML": (YAML, "<html><body/></html>", "cannot read it as a URDF"),
    "robot.urdf is cut off": (YAML, URDF[: len(URDF) // 2], "cannot read it as a URDF"),
    "robot.urdf is binary": (YAML, b"\xff\xfe\x00\x01", "not a text file"),
    "robot.urdf is another robot": (
        YAML,
        '<robot name="x"><link name="pelvis"/></robot>',
        "robot.urdf has no link 'torso'",
    ),
    "a limit that is no number": (
        YAML,
        replaced(URDF, r'lower="[^"]*"', 'lower="nan"'),
        "limit lower = 'nan' is not a number",
    ),
}


@pytest.mark.parametrize("kind", MALFORMED)
def test_a_malformed_robot_is_refused(kind: str, tmp_path: Path):
    yaml_text, urdf, part = MALFORMED[kind]
    folder = write_robot(tmp_path / "robot", yaml_text, urdf)
    before = files_below(tmp_path)
    for command in (
        ("robot", "check", folder),
        ("robot", "check", folder, "--json"),
        ("robot", "show", folder),
        ("generate", *SHORT_WALK, "--robot", folder, "-o", tmp_path / "walk.mcap"),
    ):
        result = run(*command)
        assert (result.exit_code, result.stdout) == (2, "")
        assert part in result.stderr
        assert "robot.yaml" in result.stderr or "robot/" in result.stderr  # the file at fault
        assert len(result.stderr.splitlines()) <= 25
    assert files_below(tmp_path) == before


@pytest.mark.parametrize("command", ["check", "show"])
@pytest.mark.parametrize("name", ["nao", "", ".", "n" * 5000, "a\0b"])
def test_an_unknown_robot_is_refused_with_a_list_of_shipped_robots(
    command: str, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    result = run("robot", command, name)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "melson" in result.stderr
