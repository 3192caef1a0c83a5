"""Times and memory of commands, each in a separate process."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from spread import Spread, spread

MGS = "from mgs.cli import main; main(prog_name='mgs')"
IMPORTS = (
    "import mgs.cli, mgs.gait, mgs.motion_file, mgs.pipeline, mgs.robot, mgs.judge.motion_checks"
)
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
import mgs.gait, mgs.motion_file, mgs.pipeline, mgs.robot, mgs.judge.motion_checks
before = peak()
output = io.StringIO()
with redirect_stdout(output):
    main(sys.argv[1:], standalone_mode=False)
print(json.dumps({"summary": json.loads(output.getvalue()), "before": before, "peak": peak()}))
"""


def generate_times(gait: str, repeats: int) -> dict[str, Spread]:
    """Wall times [s] of `mgs generate`, its imports, `mgs --help` and Python without imports."""
    times: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for i in range(repeats):
            path = str(Path(folder) / f"{i}.mcap")
            for name, command in {
                "mgs generate": ["-c", MGS, "generate", gait, "-o", path],
                "its imports": ["-c", IMPORTS],
                "mgs --help": ["-c", MGS, "--help"],
                "python alone": ["-c", "pass"],
            }.items():
                times.setdefault(name, []).append(_wall_time([sys.executable, *command]))
    return {name: spread(values) for name, values in times.items()}


def _wall_time(command: list[str]) -> float:
    start = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start


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
