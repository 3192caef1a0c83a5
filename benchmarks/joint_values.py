"""Comparison of the joint values of two versions of mgs for every shipped gait.

    python benchmarks/joint_values.py record before.npz     # in the first working copy
    python benchmarks/joint_values.py compare before.npz    # in the second working copy

Compares configurations q [m, rad] and torques [N m]; exits 1 where q differs by more than 1e-12, or
a torque by more than 1e-8: it rests on second differences of q, which magnify by 1 / dt^2 = 1e4.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

from mgs.gait import list_gaits, load_gait
from mgs.pipeline import generate
from mgs.robot import load_robot

TOLERANCES = {"q": 1e-12, "torque": 1e-8}


def joint_values() -> dict[str, Any]:
    """Arrays q and torque of every shipped gait that names its robot."""
    values: dict[str, Any] = {}
    for name in list_gaits():
        gait = load_gait(name)
        if gait.robot is not None:
            motion = generate(load_robot(gait.robot), gait, name).motion
            values |= {f"{name}:q": motion.q, f"{name}:torque": motion.torque}
    return values


def compare(recorded: Path) -> int:
    """Print the gaits that differ, and return the exit code."""
    here, there = joint_values(), np.load(recorded)
    missing = sorted(here.keys() ^ set(there.files))
    worst = dict.fromkeys(TOLERANCES, 0.0)
    different = []
    for name in sorted(here.keys() & set(there.files)):
        quantity = name.rpartition(":")[2]
        difference = np.inf  # of arrays of different lengths
        if here[name].shape == there[name].shape:
            difference = float(np.abs(here[name] - there[name]).max())
        worst[quantity] = max(worst[quantity], difference)
        if not difference <= TOLERANCES[quantity]:
            different.append(f"{name}: differs by {difference:.3g}")
    for name in missing:
        print(f"{name}: exists in one version only")
    for line in different:
        print(line)
    figures = ", ".join(f"{value:.3g} in {quantity}" for quantity, value in worst.items())
    print(f"{len(here) // 2} gaits compared, largest difference {figures}")
    return 1 if missing or different else 0


def main() -> int:
    """Record or compare the joint values."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("action", choices=["record", "compare"])
    parser.add_argument("file", type=Path)
    arguments = parser.parse_args()
    if arguments.action == "compare":
        return compare(arguments.file)
    np.savez(arguments.file, **joint_values())
    return 0


if __name__ == "__main__":
    sys.exit(main())
