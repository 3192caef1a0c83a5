"""Computing times and memory of mgs, as ratios within one run; results are in docs/benchmarks.md.

python benchmarks/run.py                                 all measurements, about two minutes
python benchmarks/run.py --placo-python VENV/bin/python  comparison with the IK step of placo
python benchmarks/run.py --json                          output as one JSON object

Prints Markdown tables. Times are minima and medians of several measurements.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import os
import platform
import tempfile
import time
from pathlib import Path
from typing import Any

from commands import generate_times, growth
from ik_step import measure
from placo_side import compare
from spread import spread
from tables import report

from mgs.gait import load_gait
from mgs.motion_file import read_motion, write_motion
from mgs.pipeline import run_stages
from mgs.robot import load_robot

WALK, LONG_WALK = "melson/walk_5cm", "melson/walk_backward"
VARIANTS: dict[str, tuple[str, ...]] = {
    "with the gravity task": (),
    "without": ("ik.gamma_grav=0",),
}


def main() -> None:
    """Measure times and memory, and print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument(
        "--placo-python", metavar="PYTHON", help="Python interpreter with the package placo"
    )
    parser.add_argument(
        "--repeats", type=int, default=5, metavar="N", help="number of measurements; default 5"
    )
    parser.add_argument("--n-steps", type=int, nargs="*", default=[2, 20, 200, 2000], metavar="N",
                        help="numbers of steps of the long walks")  # fmt: skip
    arguments = parser.parse_args()
    repeats, python = arguments.repeats, arguments.placo_python
    figures: dict[str, Any] = {
        "machine": machine(),
        "walk": WALK,
        "ik": {k: found.to_dict() for k, found in measure(WALK, 2 * repeats, VARIANTS).items()},
        "stages": stage_times(repeats),
        "command": {name: t.to_dict() for name, t in generate_times(WALK, repeats).items()},
        "long_walk": LONG_WALK,
        "growth": [growth(LONG_WALK, n_steps) for n_steps in arguments.n_steps],
        "placo": compare(python, WALK, repeats) if python else None,
    }
    print(json.dumps(figures, indent=2) if arguments.json else report(figures))


def machine() -> dict[str, Any]:
    """Hardware and software on which the measurements are made."""
    packages = ("numpy", "scipy", "pin")
    return {
        "cores": os.cpu_count(),
        "architecture": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        **{name: importlib.metadata.version(name) for name in packages},
    }


def stage_times(repeats: int) -> dict[str, Any]:
    """Wall times [s] of the stages, of writing and of reading, in this process."""
    robot, gait = load_robot("melson"), load_gait(WALK)
    times: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for i in range(repeats + 1):
            path = Path(folder) / f"{i}.mcap"
            stages = run_stages(robot, gait)
            start = time.perf_counter()
            write_motion(stages.motion, path)
            middle = time.perf_counter()
            read_motion(path)
            end = time.perf_counter()
            if i == 0:  # the first run starts with empty caches, as in a separate process
                continue
            seconds = stages.seconds | {"write": middle - start, "read": end - middle}
            for name, value in seconds.items():
                times.setdefault(name, []).append(value)
        size = path.stat().st_size
    return {
        "samples": stages.motion.n_samples,
        "bytes": size,
        "seconds": {name: spread(values).to_dict() for name, values in times.items()},
    }


if __name__ == "__main__":
    main()
