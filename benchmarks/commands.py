"""Times and memory of commands, each in a separate process."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spread import Spread, spread

MGS = "from mgs.cli import main; main(prog_name='mgs')"
SETTINGS = "from mgs.cli.process import prepare_process; prepare_process(); "
# modules are imported when they are needed, so that a run has to tell which ones a command loads
LOADED = """
import sys
from mgs.cli import main
main(sys.argv[1:], standalone_mode=False)
print(*(name for name in sys.modules if name.startswith("mgs.")), sep=", ")
"""
# `ru_maxrss` of a new process includes the memory of its parent process, VmHWM does not
GROWTH = """
import io, json, re, resource, sys
from contextlib import redirect_stdout
from pathlib import Path

def peak():
    try:
        text = Path("/proc/self/status").read_text()
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    return int(re.search(r"VmHWM:\\s*(\\d+) kB", text)[1]) * 1024

from mgs.cli import main
import mgs.ik_solver.clik, mgs.judge.motion_checks, mgs.motion_file, mgs.pipeline
before = peak()
output = io.StringIO()
with redirect_stdout(output):
    main(sys.argv[1:], standalone_mode=False)
print(json.dumps({"summary": json.loads(output.getvalue()), "before": before, "peak": peak()}))
"""


@dataclass(frozen=True)
class Times:
    """Wall time and CPU time (user and system, all threads) of a process [s]."""

    wall: Spread
    cpu: Spread

    def to_dict(self) -> dict[str, dict[str, float]]:
        """Convert to plain data."""
        return {"wall": self.wall.to_dict(), "cpu": self.cpu.to_dict()}


def generate_times(gait: str, repeats: int) -> dict[str, Times]:
    """Times of `mgs generate`, its imports, `mgs --help` and Python without imports.

    Modules are compiled before, as they are after an installation.
    """
    times: dict[str, list[tuple[float, float]]] = {}
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "PYTHONPYCACHEPREFIX": folder}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        generate = ["generate", gait, "--force", "-o", str(Path(folder) / "walk.mcap")]
        commands = {
            "mgs generate": [MGS, *generate],
            "its imports": [SETTINGS + f"import {_loaded_modules(generate, environment)}"],
            "mgs --help": [MGS, "--help"],
            "python alone": ["pass"],
        }
        for _ in range(repeats):
            for name, command in commands.items():
                times.setdefault(name, []).append(_run(["-c", *command], environment))
    return {
        name: Times(*(spread(column) for column in zip(*values, strict=True)))
        for name, values in times.items()
    }


def _loaded_modules(arguments: list[str], environment: dict[str, str]) -> str:
    """Names of all modules of mgs that a command loads; compiles them."""
    command = [sys.executable, "-c", LOADED, *arguments]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, env=environment)
    return done.stdout.splitlines()[-1]


def _run(arguments: list[str], environment: dict[str, str]) -> tuple[float, float]:
    """Wall time and CPU time of one run of Python [s]."""
    start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, *arguments]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def growth(gait: str, n_steps: int) -> dict[str, Any]:
    """Results of `mgs generate --json` for a walk with n_steps steps, and its memory [bytes]."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "walk.mcap"
        options = ["--set", f"walk.n_steps={n_steps}", "-o", str(path), "--json"]
        command = [sys.executable, "-c", GROWTH, "generate", gait, *options]
        done = subprocess.run(command, check=True, stdout=subprocess.PIPE)
        found = json.loads(done.stdout)
        return {
            "n_steps": n_steps,
            "samples": found["summary"]["samples"],
            "seconds": found["summary"]["seconds"],
            "bytes_before": found["before"],
            "bytes_peak": found["peak"],
            "bytes_file": path.stat().st_size,
        }
