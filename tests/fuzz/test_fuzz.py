"""A few random malformed inputs of every format, in a process of their own.

`python -m tests.fuzz` tries as many as one likes; docs/security.md has the counts of a long run.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def run_fuzz(n: int, folder: Path) -> None:
    """Try n inputs; the process that forks must have no threads, so it is a new one."""
    command = [sys.executable, "-m", "tests.fuzz", "--inputs", str(n), "--folder", str(folder)]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize("n", [40, pytest.param(600, marks=pytest.mark.slow)])
def test_random_inputs_get_messages(n: int, tmp_path: Path) -> None:
    """Always the same inputs, some of each format."""
    run_fuzz(n, tmp_path)
