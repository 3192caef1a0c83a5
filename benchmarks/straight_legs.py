"""Walks on straight legs against the same walks on bent knees.

    python benchmarks/straight_legs.py                        COMAN and Melson
    python benchmarks/straight_legs.py FOLDER BENT STRAIGHT   a robot folder, CoM heights [m]

Prints the table of docs/papers.md, from lift-off of the first step to the last weight shift. Losses
are (w / T) tau^2 with the no-load speed w and the stall torque T of robot.yaml, which is R / k^2 of
a direct-current motor; power that flows back is not recovered.
"""

from __future__ import annotations

import sys

import numpy as np

from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV, GRAVITY
from mgs.core.contact import Side
from mgs.gait import WalkGait, load_gait
from mgs.judge.motion_checks import check_motion
from mgs.motion import Motion
from mgs.motion.energy import positive_power
from mgs.pipeline import run_stages
from mgs.robot import load_robot
from mgs.robot.limbs import leg_joints

RESTS = ("walk.lead_in=5", "walk.lead_out=5")  # [s] on one leg the hips take more than they bear
Walk = tuple[str, str, tuple[str, ...], tuple[float, float]]
WALKS: tuple[Walk, ...] = (  # robot, gait, settings, CoM heights [m]
    ("coman", "coman/walk", RESTS, (0.50, 0.54)),
    ("melson", "melson/walk_practical", (), (0.262, 0.275)),
)


def row(robot_name: str, gait_name: str, settings: tuple[str, ...]) -> list[float | str]:
    """Knee angle [deg], knee torque [N m], two costs of transport, knee speed, failed checks."""
    robot, gait = load_robot(robot_name), load_gait(gait_name, settings)
    motion = run_stages(robot, gait, gait_name).motion
    walk = motion.gait
    assert isinstance(walk, WalkGait)
    span = slice(round(walk.walk.lead_in / motion.dt), -round(walk.walk.lead_out / motion.dt))
    knees = knee_joints(motion)
    torque, v = motion.torque[span], motion.v[span, FLOATING_BASE_NV:]
    losses = robot.no_load_speed / robot.torque_limit * torque**2
    travel = np.diff(motion.soles[[0, -1], :, :2].mean(axis=1), axis=0)
    weight_way = GRAVITY * robot.mass * float(np.linalg.norm(travel))
    electric = np.maximum(torque * v + losses, 0.0).sum() * motion.dt
    angles = motion.q[span, FLOATING_BASE_NQ:][:, knees]
    return [
        float(np.degrees(angles.mean())),
        float(np.sqrt(np.mean(torque[:, knees] ** 2))),
        float(positive_power(motion)[span].sum() * motion.dt / weight_way),
        float(electric / weight_way),
        float(np.abs(v[:, knees] / robot.speed_limit[knees]).max()),
        ", ".join(check.name for check in check_motion(motion) if not check.ok) or "pass",
    ]


def knee_joints(motion: Motion) -> list[int]:
    """Joints of the legs that bend most in the half-sitting posture, one for each leg."""
    robot = motion.robot
    found = []
    for side in Side:
        joints = [joint - 2 for joint in leg_joints(robot, side)]  # the base is joint 1
        found.append(max(joints, key=lambda joint: abs(robot.posture[joint])))
    return found


def main() -> None:
    """Print two rows and their changes for each robot."""
    walks = WALKS
    if len(sys.argv) == 4:
        folder, bent, straight = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
        walks = ((folder, "generic/walk", (), (bent, straight)),)
    for robot, gait, settings, heights in walks:
        rows = [row(robot, gait, (*settings, f"walk.com_height={h}")) for h in heights]
        for height, (angle, *figures, checks) in zip(heights, rows, strict=True):
            told = " | ".join(f"{figure:.3g}" for figure in figures)
            print(f"| {gait} | {height:g} | {angle:.0f} | {told} | {checks} |", flush=True)
        changes = [100.0 * (b / a - 1.0) for a, b in zip(*(r[1:4] for r in rows), strict=True)]
        print(f"| | | | {' | '.join(f'{change:+.0f} %' for change in changes)} | | |")


if __name__ == "__main__":
    main()
