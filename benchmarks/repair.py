"""What `mgs repair` makes of motions that are damaged in all ways at once.

python benchmarks/repair.py                       twenty motions, two minutes
python benchmarks/repair.py --file FILE ROBOT     a motion of somebody else, before and after
python benchmarks/repair.py --json                output as one JSON object

A file may be given several times; `--fps F` is the rate of those that state none. Prints a
Markdown table; each motion has two lines.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from damaged_motions import MOTIONS, damaged, undamaged
from tables import table

from mgs.judge.audit import GivenMotion
from mgs.judge.recorded import Choices, read_placed
from mgs.robot import load_robot
from mgs.search.repair import link_distance, repair

HEADER = [
    "motion", "penetration [mm]", "slip [mm/s]", "beyond range [mrad]", "speed [limits]",
    "ZMP outside [%]", "by [mm]", "jitter [mrad]", "from the undamaged [mm]", "CPU [s]",
]  # fmt: skip


def main() -> None:
    """Damage and repair motions, and print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--rate", type=float, default=50.0, metavar="F", help="samples a second")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of random numbers")
    parser.add_argument("--file", nargs=2, action="append", metavar=("FILE", "ROBOT"))
    parser.add_argument("--fps", type=float, metavar="F", help="rate of files that state none")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    if arguments.file:
        found = [of_file(Path(file), robot, arguments.fps) for file, robot in arguments.file]
    else:
        found = []
        for number, name in enumerate(MOTIONS):
            given = undamaged(name, arguments.rate)
            rng = np.random.default_rng([arguments.seed, number])
            found.append(measured(name, damaged(given, rng), given))
    print(json.dumps(found, indent=2) if arguments.json else report(found))


def of_file(file: Path, robot: str, fps: float | None) -> dict[str, Any]:
    """Figures of a motion that somebody else published."""
    _, placed = read_placed(file, load_robot(robot), None, Choices(fps=fps))
    return measured(file.stem, placed.given, None)


def measured(name: str, bad: GivenMotion, given: GivenMotion | None) -> dict[str, Any]:
    """Figures before and after; distances are from `given`, or from what was repaired."""
    started = time.process_time()
    result = repair(bad)
    seconds = time.process_time() - started
    return {
        "name": name,
        "before": result.before.to_dict(),
        "after": result.after.to_dict(),
        "left": list(result.left),
        "distance": [
            link_distance(motion, bad if given is None else given)
            for motion in (bad, result.motion)
        ],
        "seconds": seconds,
    }


def report(found: list[dict[str, Any]]) -> str:
    """Markdown table."""
    rows = []
    for one in found:
        for when, distance in zip(("before", "after"), one["distance"], strict=True):
            figures = one[when]
            rows.append(
                [
                    one["name"] if when == "before" else "repaired",
                    f"{1e3 * figures['penetration']:.2f}",
                    f"{1e3 * figures['slip']:.1f}",
                    f"{1e3 * figures['range_excess']:.1f}",
                    f"{figures['speed_ratio']:.2f}",
                    f"{100.0 * figures['zmp_outside']:.1f}",
                    f"{1e3 * figures['zmp_distance']:.1f}",
                    f"{1e3 * figures['jitter']:.1f}",
                    f"{1e3 * distance:.1f}",
                    f"{one['seconds']:.1f}" if when == "after" else "",
                ]
            )
    hold = sum(not one["left"] for one in found)
    left = "; ".join(f"{one['name']}: {', '.join(one['left'])}" for one in found if one["left"])
    told = f"{hold} of {len(found)} motions meet every goal" + (f" ({left})" if left else "") + "."
    return f"{told}\n\n{table(HEADER, rows)}"


if __name__ == "__main__":
    main()
