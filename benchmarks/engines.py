"""Differences between PyBullet and MuJoCo on every shipped gait: a table for docs/simulation.md.

python benchmarks/engines.py [GAIT ...]

Load is the difference of the vertical forces on a sole, relative to the weight. Load and ZMP are
root mean squares over the motion of means over 50 ms; tilt is the largest difference; end is the
difference of the final pose of the midpoint of the soles, after the rest at the end.
"""

from __future__ import annotations

import argparse

from mgs.gait import list_gaits, load_gait
from mgs.judge.verdict import replay_checks
from mgs.pipeline import generate
from mgs.robot import load_robot
from mgs.sim import SERVOS, Replay, agreement, replay


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("gaits", nargs="*", help="names of gaits; default: all shipped gaits")
    names = parser.parse_args().gaits or list_gaits()
    print("| gait | servos | PyBullet | MuJoCo | load | ZMP | tilt | end |")
    print("| --- | --- | --- | --- | ---: | ---: | ---: | ---: |")
    for name in names:
        gait = load_gait(name)
        motion = generate(load_robot(gait.robot or "melson"), gait, name).motion
        for servo in SERVOS[:2]:  # ideal and modelled ones
            pybullet = replay(motion, "pybullet", servo=servo)
            mujoco = replay(motion, "mujoco", servo=servo)
            found = agreement(pybullet, mujoco)
            print(
                f"| {name} | {servo} | {fate(pybullet)} | {fate(mujoco)} | "
                f"{100.0 * found.load:.1f} % | {1e3 * found.zmp:.1f} mm | {found.tilt_deg:.2f} deg "
                f"| {1e3 * found.end_position:.1f} mm, {found.end_yaw_deg:.2f} deg |",
                flush=True,
            )


def fate(result: Replay) -> str:
    """Result of a replay: pass, the time of the fall, or the names of failed checks."""
    if result.fell:
        return f"fell at {result.fall_time:.1f} s"
    failed = [check.name.split("_", 1)[1] for check in replay_checks(result) if not check.ok]
    return ", ".join(failed) or "pass"


if __name__ == "__main__":
    main()
