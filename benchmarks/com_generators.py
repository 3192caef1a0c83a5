"""Comparison of the CoM generators without and with dynamic filter: a table of docs/benchmarks.md.

python benchmarks/com_generators.py [--repeats N] [GAIT ...]

The ZMP error is the distance of the ZMP of the whole robot (inverse dynamics) from the reference of
stage 2; the distance from plan is that from the ZMP planned by stage 3, which the QP chooses inside
its margin. The least ZMP margin is the distance of the ZMP of the whole robot from the edge of the
support polygon. The time of stage 3 includes the corrections; the time of all stages includes every
pass of inverse kinematics and dynamics. Both are minima of the repeats.
"""

from __future__ import annotations

import argparse

import numpy as np

from mgs.gait import load_gait
from mgs.judge.motion_checks import zmp_margins
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot, load_robot

GAITS = ("melson/walk_practical", "coman/walk")
MARGINS = (0.0, 0.8)  # margin of the ZMP as part of the half width of a sole
WEIGHTS = (1e-8, 1e-4)  # weight R of the jerk
FILTER = {"off": 0, "on": 3}  # values of com.passes


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "gaits", nargs="*", default=GAITS, help=f"names of gaits; default: {' '.join(GAITS)}"
    )
    parser.add_argument("--repeats", type=int, default=5, help="number of runs; default 5")
    arguments = parser.parse_args()
    print(
        "| gait | generator | filter | mean ZMP error | largest ZMP error "
        "| mean distance from plan | least ZMP margin "
        "| RMS jerk of the CoM | time of stage 3 | time of all stages |"
    )
    print("| --- | --- | --- " + "| ---: " * 7 + "|")
    for name in arguments.gaits:
        gait = load_gait(name)
        assert gait.robot is not None
        robot = load_robot(gait.robot)
        for label, settings in generators(robot).items():
            for switch, passes in FILTER.items():
                wanted = load_gait(name, (*settings, f"com.passes={passes}"))
                runs = [run_stages(robot, wanted, name) for _ in range(arguments.repeats)]
                print(f"| {name} | {label} | {switch} | {figures(runs)} |", flush=True)


def generators(robot: Robot) -> dict[str, tuple[str, ...]]:
    """Settings of each generator by label: preview control, QP with each weight and margin."""
    half = 0.5 * min(robot.spec.soles.left.length, robot.spec.soles.left.width)
    found: dict[str, tuple[str, ...]] = {
        f"preview, R {WEIGHTS[0]:g}": (f"com.weight_jerk={WEIGHTS[0]}",)
    }
    for weight in WEIGHTS:
        for share in MARGINS if weight == WEIGHTS[-1] else MARGINS[-1:]:
            found[f"qp, R {weight:g}, margin {1e3 * share * half:.0f} mm"] = (
                "com.generator=qp",
                f"com.weight_jerk={weight}",
                f"com.margin={share * half}",
            )
    return found


def figures(runs: list[Stages]) -> str:
    """Cells of one row; the runs differ only in their times."""
    motion, com = runs[0].motion, runs[0].com
    report = motion.provenance.zmp_error
    assert report is not None
    error = np.linalg.norm(motion.zmp - motion.zmp_ref, axis=1)
    margin = zmp_margins(motion, motion.zmp).min()
    jerk = np.linalg.norm(np.diff(com.acceleration, axis=0), axis=1) / motion.dt
    stage = min(run.seconds["com_generator"] for run in runs)
    total = min(sum(run.seconds.values()) for run in runs)
    return (
        f"{1e3 * error.mean():.2f} mm | {1e3 * error.max():.2f} mm | "
        f"{1e3 * report.after.mean:.2f} mm | {1e3 * margin:.1f} mm | "
        f"{np.sqrt(np.mean(jerk**2)):.2f} m/s^3 | {1e3 * stage:.1f} ms | {1e3 * total:.0f} ms"
    )


if __name__ == "__main__":
    main()
