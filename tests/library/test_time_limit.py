"""A gait that hangs in compiled code, which no signal handler interrupts, is given up."""

from __future__ import annotations

import contextlib
import json
import os
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

ROOT = Path(__file__).parents[2]
PLUG_IN = '''
"""Inverse kinematics of mgs, which hangs in a library in C that holds the lock of Python."""

import ctypes

from mgs.core.plugins import IK_SOLVERS
from mgs.gait import IkParameters


class HangingIk:
    @classmethod
    def from_parameters(cls, parameters):
        return cls()

    def solve(self, robot, tasks, com, progress=None):
        if tasks.n_samples > LIMIT:
            ctypes.PyDLL(None).sleep(10**6)
        clik = IK_SOLVERS.load("clik").from_parameters(IkParameters())
        return clik.solve(robot, tasks, com, progress)
'''
LIMIT = 1000  # samples of a motion that does not hang
SECONDS = 10  # of the time limit; a loaded machine needs some for a gait that does not hang


def install(folder: Path) -> None:
    """A package with the solver `hanging`, as pip would leave it."""
    code = PLUG_IN.replace("LIMIT", str(LIMIT))
    info = folder / "hanging_ik-1.dist-info"
    info.mkdir(parents=True)
    (folder / "hanging_ik.py").write_text(code)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: hanging-ik\nVersion: 1\n")
    (info / "entry_points.txt").write_text("[mgs.ik_solvers]\nhanging = hanging_ik:HangingIk\n")


@pytest.mark.slow
def test_a_gait_that_hangs_is_lost_and_the_others_are_made(tmp_path: Path) -> None:
    """It is tried twice, since its worker might have died of something else."""
    install(tmp_path / "site")
    (tmp_path / "s.yaml").write_text(
        "mgs: 1\nbase: melson/walk_5cm\n"
        "axes: {walk.n_steps: [2, 40, 3], dt: [0.05], ik.solver: [hanging]}\n"
    )
    path = os.pathsep.join([str(ROOT), str(tmp_path / "site")])
    command = [
        "batch",
        "run",
        "s.yaml",
        "-o",
        "library",
        "--workers",
        "1",
        "--timeout",
        str(SECONDS),
    ]
    begun = time.monotonic()
    result = subprocess.run(
        [sys.executable, "-m", "mgs", *command, "--workers", "1", "--json"],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True,
        timeout=300, check=False,
    )  # fmt: skip
    assert time.monotonic() - begun > 2 * SECONDS
    assert result.returncode == 1, result.stderr
    assert json.loads(result.stdout)["verdicts"]["lost"] == 1
    with contextlib.closing(sqlite3.connect(tmp_path / "library" / "manifest.sqlite")) as found:
        rows = found.execute(
            "SELECT verdict, reason, message FROM gaits ORDER BY number"
        ).fetchall()
    (hung,) = (row for row in rows if row[0] == "lost")
    assert hung[1:] == ("Timeout", "took longer than the time limit of 10 s")
    assert rows.index(hung) == 1
    files = {file.name for file in (tmp_path / "library" / "gaits").iterdir()}
    assert files == {"000000.mcap", "000002.mcap"}
    assert not [p for p in psutil.process_iter(["cwd"]) if p.info["cwd"] == str(tmp_path)]
