"""Chains of 1,000 to 100,000 links overflow the stack of native parsers: none may see them.

Every command that reads a URDF runs in a process of its own, since a stack that overflows ends the
process with a signal.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from mcap.records import Attachment

from mgs.core.shipped import shipped_folder
from mgs.motion_file import motion_bytes
from mgs.pipeline.request import generate
from tests.support.rewriting import rewritten

ROOT = Path(__file__).parents[2]
FOLDER = (
    ("robot", "show", "r"),
    ("robot", "check", "r"),
    ("robot", "init", "r/robot.urdf", "-o", "out"),
    ("generate", "melson/bow", "--robot", "r", "-o", "out/a.mcap"),
    ("envelope", "r", "-o", "out"),
    ("tune", "melson/walk_5cm", "--robot", "r", "--objective", "speed", "-o", "out/a.yaml"),
    ("batch", "run", "s.yaml", "-o", "out"),
)
MOTION = (
    ("validate", "a.mcap"),
    ("replay", "a.mcap", "--engine", "mujoco"),
    ("replay", "a.mcap", "--engine", "pybullet"),
    ("export", "a.mcap", "-o", "out.csv"),
    ("plot", "a.mcap", "-o", "out"),
    ("report", "a.mcap", "-o", "out.html"),
    ("refine", "a.mcap", "-o", "out.mcap"),
)


def chain(n: int) -> str:
    """Melson's URDF with n links in a row below its pelvis, each fixed to the one before."""
    parents = ("pelvis", *(f"c{i}" for i in range(n - 1)))
    text = "".join(
        f'<link name="c{i}"/><joint name="j{i}" type="fixed"><parent link="{parent}"/>'
        f'<child link="c{i}"/></joint>'
        for i, parent in enumerate(parents)
    )
    shipped = (shipped_folder("robots") / "melson/robot.urdf").read_text()
    return shipped.replace("</robot>", f"{text}</robot>")


@pytest.fixture(scope="module", params=[1000, 10_000, 100_000])
def folder(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A robot folder, a sweep and a motion file that have a chain of so many links."""
    made, urdf = tmp_path_factory.mktemp("chain"), chain(request.param)
    (made / "r").mkdir()
    (made / "r" / "robot.urdf").write_text(urdf)
    spec = (shipped_folder("robots") / "melson/robot.yaml").read_bytes()
    (made / "r" / "robot.yaml").write_bytes(spec)
    (made / "s.yaml").write_text("mgs: 1\nbase: melson/bow\naxes: {robot: [r], dt: [0.1]}\n")

    def change(record: object) -> None:
        if isinstance(record, Attachment) and record.name == "robot.urdf":
            record.data = urdf.encode()

    motion = motion_bytes(generate("melson", "melson/bow", dt=0.1))
    (made / "a.mcap").write_bytes(rewritten(motion, change=change))
    return made


@pytest.mark.slow_if("1000", "10000")
@pytest.mark.parametrize("command", [*FOLDER, *MOTION], ids=lambda command: "-".join(command[:2]))
def test_a_long_chain_is_refused_by_every_command(command: tuple[str, ...], folder: Path) -> None:
    before = set(folder.rglob("*"))
    result = subprocess.run(
        [sys.executable, "-m", "mgs", *command],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert result.returncode == 2, result.stderr[-500:]
    assert "cannot read it as a URDF" in result.stderr
    assert "Traceback" not in result.stderr
    assert result.stdout == ""
    assert set(folder.rglob("*")) == before
