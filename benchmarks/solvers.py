"""Comparison of all IK solvers on one gait: the table of docs/solvers.md.

python benchmarks/solvers.py               static checks only, about ten seconds
python benchmarks/solvers.py --physics     also a replay in every installed engine
python benchmarks/solvers.py --json        output as one JSON object

All solvers get the same references; each chooses the joint angles that no task determines.
"""

from __future__ import annotations

import argparse
import json
from typing import Any

import numpy as np
from tables import table

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.plugins import IK_SOLVERS
from mgs.gait import load_gait
from mgs.judge.motion_checks import check_motion
from mgs.judge.tracking import tracking_errors
from mgs.judge.verdict import replay_checks
from mgs.motion import Motion
from mgs.pipeline import run_stages
from mgs.robot import load_robot
from mgs.sim import available_engines, replay

WALK = "melson/walk_5cm"


def main() -> None:
    """Measure all solvers and print the results."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("gait", nargs="?", default=WALK, help=f"name of the gait; default {WALK}")
    parser.add_argument(
        "--physics", action="store_true", help="also replay the motion in every installed engine"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    found = {name: measure(arguments.gait, name, arguments.physics) for name in IK_SOLVERS.own}
    if arguments.json:
        print(json.dumps({"gait": arguments.gait, "solvers": found}, indent=2))
    else:
        print(report(found))


def measure(gait_name: str, solver: str, physics: bool) -> dict[str, Any]:
    """Results of one solver; the time is the minimum of three runs without the dynamic filter."""
    gait = load_gait(gait_name, (f"ik.solver={solver}",))
    assert gait.robot is not None
    robot = load_robot(gait.robot)
    motion = run_stages(robot, gait, gait_name).motion
    once = load_gait(gait_name, (f"ik.solver={solver}", "com.passes=0"))
    runs = [run_stages(robot, once, gait_name) for _ in range(3)]
    checks = check_motion(motion)
    if physics:
        checks += [
            c for engine in available_engines() for c in replay_checks(replay(motion, engine))
        ]
    failed = [check.name for check in checks if not check.ok]
    limit = next(check for check in checks if check.name == "joint_position")
    return {
        "tracking": tracking_errors(motion),
        "peak_torque": float(np.abs(motion.torque).max()),
        "rms_jerk": rms_jerk(motion),
        "limit_margin": limit.value,
        "seconds_per_sample": min(run.seconds["ik_solver"] for run in runs) / motion.n_samples,
        "verdict": "pass" if not failed else f"fail: {', '.join(failed)}",
    }


def rms_jerk(motion: Motion) -> float:
    """Root mean square over samples and joints of the third difference of the angles [rad/s^3]."""
    jerk = np.diff(motion.q[:, FLOATING_BASE_NQ:], 3, axis=0) / motion.dt**3
    return float(np.sqrt(np.mean(jerk**2)))


def report(found: dict[str, dict[str, Any]]) -> str:
    """Markdown table of the results."""
    header = [
        "solver", "soles [um]", "hands [um]", "CoM [um]", "peak torque [N m]",
        "RMS jerk [rad/s^3]", "limit margin [deg]", "time per sample [us]", "verdict",
    ]  # fmt: skip
    rows = []
    for name, figures in found.items():
        tracking = figures["tracking"]
        micrometres = [
            1e6 * getattr(tracking, key) for key in ("sole_position", "hand_position", "com")
        ]
        rows.append(
            [
                name,
                *(f"{value:.2f}" for value in micrometres),
                f"{figures['peak_torque']:.3f}",
                f"{figures['rms_jerk']:.1f}",
                f"{np.degrees(figures['limit_margin']):.1f}",
                f"{1e6 * figures['seconds_per_sample']:.0f}",
                figures["verdict"],
            ]
        )
    return table(header, rows)


if __name__ == "__main__":
    main()
