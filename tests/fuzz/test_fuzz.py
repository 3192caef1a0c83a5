"""A few random malformed inputs of every format, in a process of their own.

`python -m tests.fuzz` tries as many as one likes; docs/security.md has the counts of a long run.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def run_fuzz(n: int, folder: Path) -> None:
    """Try n inputs; the process that forks must have no threads, so it is a new one."""
    command = [sys.executable, "-m", "tests.fuzz", "--inputs", str(n), "--folder", str(folder)]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


def test_random_inputs_get_messages(tmp_path: Path) -> None:
    """About a minute; always the same inputs."""
    run_fuzz(600, tmp_path)
