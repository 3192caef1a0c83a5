"""Which gaits of gaits/generic pass on which robots: the table of docs/robots.md.

    python benchmarks/generic_gaits.py [-o DIR [--resume]] [--path SITE_PACKAGES]
                                       [--gaits NAME ...] [--physics ENGINES] [ROBOT ...]

ROBOT is a shipped robot or one of benchmarks/third_party_robots.py, whose folder `mgs robot init`
writes; nothing is edited. Each cell is the verdict of `mgs validate`: the static checks, and ideal
and PD servos in both engines. With --resume, cells that an earlier run has left in DIR are printed
as they are.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path

from third_party_robots import ROBOTS, find, run

from mgs.gait import list_gaits
from mgs.robot import list_robots

SHOWN = ("melson", "ROBOTIS OP3", "Unitree G1", "iCub 2.7", "TALOS")


def main() -> None:
    """Run all gaits on all robots and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("robots", nargs="*", default=SHOWN)
    parser.add_argument("--gaits", nargs="*", help="names without generic/; default: all")
    parser.add_argument("--path", type=Path, action="append", default=[], help="folder of packages")
    parser.add_argument("--physics", default="pybullet,mujoco", help="as of mgs validate")
    parser.add_argument("-o", "--output", type=Path, help="default: a temporary folder")
    parser.add_argument("--resume", action="store_true", help="keep the cells of an earlier run")
    arguments = parser.parse_args()
    shipped = [name.partition("/")[2] for name in list_gaits() if name.startswith("generic/")]
    folders = [*arguments.path, *(Path(entry) for entry in sys.path if entry)]
    gaits = arguments.gaits or shipped
    print(f"| robot | {' | '.join(gaits)} |\n|{' --- |' * (len(gaits) + 1)}")
    with tempfile.TemporaryDirectory() as scratch:
        output = arguments.output or Path(scratch)
        output.mkdir(parents=True, exist_ok=True)
        for name in arguments.robots:
            robot = folder_of(name, folders, output)
            cells = ["not installed"] * len(gaits)
            if robot is not None:
                cells = [cell(robot, gait, output, arguments) for gait in gaits]
            print(f"| {name} | {' | '.join(cells)} |", flush=True)


def cell(robot: str, gait: str, output: Path, arguments: argparse.Namespace) -> str:
    """Cell of the table, from an earlier run or a new one."""
    kept = output / f"{Path(robot).name}_{gait}.json"
    if arguments.resume and kept.is_file():
        return str(json.loads(kept.read_text()))
    found = verdict(robot, gait, output, arguments.physics)
    kept.write_text(json.dumps(found))
    return found


def folder_of(name: str, folders: list[Path], scratch: Path) -> str | None:
    """Name or folder of a robot; None where its package is not installed."""
    if name in list_robots():
        return name
    urdf = find(ROBOTS[name], folders)
    if urdf is None:
        return None
    folder = scratch / name.replace(" ", "_")
    code, text = run("robot", "init", str(urdf), "-o", str(folder), "--force")
    if code:
        raise SystemExit(text)
    return str(folder)


def verdict(robot: str, gait: str, scratch: Path, physics: str) -> str:
    """What a motion fails, or that it passes."""
    motion = scratch / f"{Path(robot).name}_{gait}.mcap"
    code, text = run("generate", f"generic/{gait}", "--robot", robot, "-o", str(motion), "--force")
    if code:
        return f"not generated: {text.strip().splitlines()[-1].removeprefix('Error: ')}"
    _, text = run("validate", str(motion), "--json", "--physics", physics)
    failed = [check for check in json.loads(text)["checks"] if not check["ok"]]
    return ", ".join(f"{c['name']} {c['value']:.3g} of {c['limit']:.3g}" for c in failed) or "pass"


if __name__ == "__main__":
    main()
