"""Files that name other files have those stay closed, shown by an audit hook of the interpreter."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from mcap.records import Attachment

from mgs.core.shipped import shipped_folder
from mgs.motion_file import motion_bytes
from mgs.pipeline.request import generate
from tests.support.rewriting import rewritten

CHILD = """
import sys
canary, *arguments = sys.argv[1:]
def hook(event, args):
    if event == "open" and str(args[0]).endswith(canary):
        sys.stderr.write("OPENED"); sys.stderr.flush()
sys.addaudithook(hook)
from mgs.cli import main
main(arguments, prog_name="mgs")
"""
CANARY = "canary.stl"
BOX = '<box size="0.0506 0.0356 0.0355"/>'


def mgs_told_of(folder: Path, *arguments: object) -> str:
    """Messages of a command, which says OPENED if Python or a library in C opens the canary.

    The access time of the file tells what no audit hook sees, where the file system keeps it.
    """
    canary = folder / CANARY
    command = [sys.executable, "-c", CHILD, CANARY, *map(str, arguments)]
    before = canary.stat().st_atime_ns
    result = subprocess.run(command, cwd=folder / "inside", capture_output=True, text=True)
    assert result.returncode in (1, 2), result.stderr
    assert "Traceback" not in result.stderr
    assert "precious" not in result.stdout + result.stderr
    assert "OPENED" not in result.stderr
    assert canary.stat().st_atime_ns == before
    return result.stderr


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    (tmp_path / CANARY).write_text("precious")
    (tmp_path / "inside").mkdir()
    return tmp_path


def test_a_gait_opens_no_file_outside(outside: Path) -> None:
    for name in (f"../{CANARY}", outside / CANARY, "link.yaml"):
        path = outside / "inside" / "a.yaml"
        (outside / "inside" / "link.yaml").unlink(missing_ok=True)
        (outside / "inside" / "link.yaml").symlink_to(outside / CANARY)
        path.write_text(
            f"mgs: 1\nrobot: melson\nmotion: sequence\nsequence: {{parts: [{{gait: {name}}}]}}\n"
        )
        assert "leads out of the folder" in mgs_told_of(outside, "generate", path)


def test_a_sweep_opens_no_file_outside(outside: Path) -> None:
    path = outside / "inside" / "s.yaml"
    for text in (
        f"base: ../{CANARY}\n",
        f"base: melson/bow\nsampling: table\ntable: ../{CANARY}\n",
    ):
        path.write_text(f"mgs: 1\n{text}axes: {{dt: [0.02]}}\n")
        assert "leads out of the folder" in mgs_told_of(outside, "batch", "plan", path)


def test_a_robot_opens_no_file_outside(outside: Path) -> None:
    shipped = shipped_folder("robots") / "melson"
    folder = outside / "inside" / "r"
    folder.mkdir()
    spec = (shipped / "robot.yaml").read_text()
    assert "urdf: robot.urdf" in spec
    leads_out = spec.replace("urdf: robot.urdf", f"urdf: ../../{CANARY}")
    (folder / "robot.yaml").write_text(leads_out)
    assert "is not in the robot folder" in mgs_told_of(outside, "robot", "show", folder)
    (folder / "robot.yaml").write_text(spec)
    for name in (outside / CANARY, f"file://{outside / CANARY}", f"package://inside/{CANARY}"):
        urdf = (shipped / "robot.urdf").read_text()
        assert BOX in urdf
        (folder / "robot.urdf").write_text(urdf.replace(BOX, f'<mesh filename="{name}"/>'))
        told = mgs_told_of(outside, "generate", "melson/bow", "--robot", folder, "-o", "a.mcap")
        assert "only mgs robot init reads meshes" in told


def test_a_motion_file_opens_no_other_file(outside: Path) -> None:
    motion = motion_bytes(generate("melson", "melson/bow", dt=0.1))

    def change(record: object) -> None:
        if isinstance(record, Attachment) and record.name == "robot.urdf":
            mesh = f'<mesh filename="{outside / CANARY}"/>'.encode()
            record.data = record.data.replace(BOX.encode(), mesh)

    path = outside / "inside" / "a.mcap"
    path.write_bytes(rewritten(motion, change=change))
    for command in (("validate", path, "--physics", "none"), ("export", path, "-o", "a.csv")):
        assert "only mgs robot init reads meshes" in mgs_told_of(outside, *command)
