"""What `mgs repair` makes of motions that are damaged in all ways at once.

python benchmarks/repair.py                       twenty motions, two minutes
python benchmarks/repair.py --held-out            other seeds, rates, gaits and robots: a line each
python benchmarks/repair.py --file FILE ROBOT     a motion of somebody else, before and after
python benchmarks/repair.py --json                output as one JSON object

A file may be given several times; `--fps F` is the rate of those that state none. `--path` names a
folder of packages with robots of others, `--log FILE` continues a run that was stopped. Prints a
Markdown table; in that of motions each one has two lines. Set OPENBLAS_NUM_THREADS=1: the matrices
are too small for several threads.
"""

from __future__ import annotations

import argparse
import functools
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from damaged_motions import GENERIC, MOTIONS, OTHERS, damaged, undamaged
from generic_gaits import folder_of
from tables import table
from trials import Log

from mgs.core.errors import MgsError
from mgs.judge.audit import GivenMotion
from mgs.judge.recorded import Choices, read_placed
from mgs.robot import load_robot
from mgs.search.repair import link_distance, repair

NEAR = 30.0  # [mm] root mean square distance of links from the undamaged motion
SUMMARY = [
    "motions", "hold", "penetration [mm]", "slip [mm/s]", "beyond range [mrad]", "speed [limits]",
    "ZMP outside [%]", "from the undamaged [mm], median", "largest", "CPU [s]",
]  # fmt: skip
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
    parser.add_argument("--held-out", action="store_true", help="motions that nothing was tuned on")
    parser.add_argument("--path", type=Path, action="append", default=[], help="folder of packages")
    parser.add_argument(
        "--log", type=Path, metavar="FILE", help="of motions that are repaired already"
    )
    arguments = parser.parse_args()
    if arguments.held_out:
        groups = held_out(Log(arguments.log, {}), arguments.path)
        print(json.dumps(groups, indent=2, allow_nan=False) if arguments.json else summary(groups))
        return
    if arguments.file:
        found = [of_file(Path(file), robot, arguments.fps) for file, robot in arguments.file]
    else:
        found = []
        for number, name in enumerate(MOTIONS):
            given = undamaged(name, arguments.rate)
            rng = np.random.default_rng([arguments.seed, number])
            found.append(measured(name, damaged(given, rng), given))
    print(json.dumps(found, indent=2, allow_nan=False) if arguments.json else report(found))


def held_out(log: Log, path: list[Path]) -> dict[str, list[dict[str, Any]]]:
    """Figures of motions of other seeds, rates, gaits and robots than those of the table."""
    folders = [*path, *(Path(entry) for entry in sys.path if entry)]
    found = {
        "the twenty gaits at 30 Hz, other damage": series(log, MOTIONS, 30.0, 2),
        "eleven other gaits at 50 Hz": series(log, OTHERS, 50.0, 4),
    }
    with tempfile.TemporaryDirectory() as scratch:
        for seed, name in enumerate(("TALOS", "Unitree G1 (mjlab)"), start=5):
            robot = folder_of(name, folders, Path(scratch))
            if robot is not None:
                title = f"generic gaits on {name}, a folder of `mgs robot init`, at 50 Hz"
                found[title] = series(log, GENERIC, 50.0, seed, robot)
    found["the twenty gaits at 100 Hz, other damage"] = series(log, MOTIONS, 100.0, 3)
    return found


def series(
    log: Log, names: tuple[str, ...], rate: float, seed: int, robot: str | None = None
) -> list[dict[str, Any]]:
    """Figures of damaged motions at one rate [Hz]; a gait that a robot cannot execute is named."""

    def one(name: str, rng: np.random.Generator) -> dict[str, Any]:
        try:
            given = undamaged(name, rate, robot)
        except MgsError as error:
            return {"name": name, "not_generated": str(error)}
        return measured(name, damaged(given, rng), given)

    return [
        log.trial(f"{rate:g} Hz, {seed}", number, [seed, number], functools.partial(one, name))
        for number, name in enumerate(names)
    ]


def summary(groups: dict[str, list[dict[str, Any]]]) -> str:
    """Markdown table of the worst figures after the repair, one line for each group."""
    rows, missed = [], []
    for title, results in groups.items():
        found = [one for one in results if "not_generated" not in one]
        after = [one["after"] for one in found]
        near = [1e3 * one["distance"][1] for one in found]
        good = sum(not one["left"] and far <= NEAR for one, far in zip(found, near, strict=True))
        rows.append(
            [
                title, f"{good} of {len(found)}",
                f"{1e3 * max(one['penetration'] for one in after):.2f}",
                f"{1e3 * max(one['slip'] for one in after):.1f}",
                f"{1e3 * max(one['range_excess'] for one in after):.1f}",
                f"{max(one['speed_ratio'] for one in after):.2f}",
                f"{100.0 * max(one['zmp_outside'] for one in after):.1f}",
                f"{np.median(near):.1f}", f"{max(near):.1f}",
                f"{np.median([one['seconds'] for one in found]):.1f}",
            ]
        )  # fmt: skip
        missed += [
            f"- {title}, `{one['name']}`: {', '.join(one['left']) or 'nothing'} left, "
            f"{far:.1f} mm from the undamaged."
            for one, far in zip(found, near, strict=True)
            if one["left"] or far > NEAR
        ]
        missed += [
            f"- {title}, `{one['name']}`, is not generated: {one['not_generated']}"
            for one in results
            if "not_generated" in one
        ]
    return "\n".join([table(SUMMARY, rows), "", *missed])


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
