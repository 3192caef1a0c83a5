"""The command line as tests call it: in this process, or in one of its own."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from click.testing import CliRunner, Result

from mgs.cli import main

# a short walk: 351 samples
SHORT_WALK = (
    "melson/walk_practical",
    *("--set", "com.preview=0.8", "--set", "walk.lead_in=0.8", "--set", "walk.lead_out=0.8"),
    *("--set", "walk.n_steps=2"),
)


def run(*arguments: object) -> Result:
    """Run one command; whatever it does not turn into a message fails the test as it is."""
    result = CliRunner().invoke(main, [str(argument) for argument in arguments])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert "unforeseen error" not in result.stderr, result.stderr
    return result


def run_process(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[bytes]:
    """Run one command as a process, with its output on real file descriptors."""
    script = "from mgs.cli import main; main(prog_name='mgs')"
    command = [sys.executable, "-c", script, *(str(argument) for argument in arguments)]
    return subprocess.run(command, capture_output=True, cwd=cwd, check=False)


def files_below(folder: Path) -> dict[str, bytes]:
    """Every file below a folder, hidden ones too, with its content."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }
