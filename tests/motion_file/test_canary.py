"""Files that name other files have those stay closed, shown by the operating system (inotify)."""

from __future__ import annotations

import contextlib
import ctypes
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from mcap.records import Attachment

from mgs.core.shipped import shipped_folder
from mgs.motion_file import motion_bytes
from mgs.pipeline.request import generate
from tests.support.commands import run
from tests.support.rewriting import rewritten

CANARY = "canary.stl"
ROOT = Path(__file__).parents[2]
BOX = '<box size="0.0506 0.0356 0.0355"/>'


IN_OPEN, IN_NONBLOCK = 0x20, os.O_NONBLOCK  # of inotify


@contextlib.contextmanager
def kept_closed(path: Path) -> Iterator[None]:
    """Fail if any process or library opens a file within the context, in whatever language."""
    if not sys.platform.startswith("linux"):
        pytest.skip("only Linux tells when a file is opened")
    libc = ctypes.CDLL(None, use_errno=True)
    watch = libc.inotify_init1(IN_NONBLOCK)
    assert libc.inotify_add_watch(watch, bytes(path), IN_OPEN) >= 0
    try:
        yield
        with pytest.raises(BlockingIOError):  # there is no event to read
            os.read(watch, 4096)
    finally:
        os.close(watch)


def mgs_told_of(folder: Path, *arguments: object, code: int = 2) -> str:
    """Messages of a command that does not open the canary."""
    command = [sys.executable, "-m", "mgs", *map(str, arguments)]
    with kept_closed(folder / CANARY):
        result = subprocess.run(
            command, cwd=folder / "inside", env={**os.environ, "PYTHONPATH": str(ROOT)},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
    assert result.returncode == code, result.stderr
    assert "Traceback" not in result.stderr
    assert "precious" not in result.stdout + result.stderr
    return result.stderr


def test_the_canary_would_sing(outside: Path) -> None:
    with pytest.raises(pytest.fail.Exception), kept_closed(outside / CANARY):
        (outside / CANARY).read_bytes()
    with pytest.raises(pytest.fail.Exception), kept_closed(outside / CANARY):
        subprocess.run(["cat", outside / CANARY], check=True, capture_output=True)


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


def test_a_urdf_opens_no_mesh_outside(outside: Path) -> None:
    """All ways to name a file that mgs robot init knows, from a folder deep below the canary."""
    home = outside / "inside" / "far" / "deep"
    home.mkdir(parents=True)
    (home / "link.stl").symlink_to(outside / CANARY)
    place = outside.name
    names = [f"../../../{CANARY}", outside / CANARY, f"file://{outside / CANARY}", "link.stl"]
    names += [f"{kind}://{package}/{CANARY}" for kind in ("package", "model")
              for package in ("..", "../..", f"/{place}/..", "", outside)]  # fmt: skip
    names += [f"package://{outside.parent.name}/{place}/{CANARY}", f"package://deep/../../{CANARY}"]
    names += [f"package://{'/'.join(outside.parts[n:])}/{CANARY}" for n in range(1, 4)]
    text = (shipped_folder("robots") / "melson/robot.urdf").read_text()
    for number, name in enumerate(names):
        urdf = home / "a.urdf"
        urdf.write_text(text.replace(BOX, f'<mesh filename="{name}"/>'))
        with kept_closed(outside / CANARY):
            result = run("robot", "init", urdf, "-o", home / str(number))
        assert f"mesh files were not found, e.g. {name}" in result.stdout, name
