"""Influence of time step, iterations and servo gains on replays: tables of docs/simulation.md.

Run as `python benchmarks/simulation_study.py [pybullet|mujoco ...]`; prints Markdown. One figure is
changed at a time, all others keep their defaults. Columns: tilt after settling, rocking (the
largest turn of the base while the robot stands still for 3 s), then for each walk its largest tilt,
its largest slip, its position error and the longest saturation; wall time of the first walk.
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np

from mgs.core.geometry import rotation_angles
from mgs.gait import load_gait
from mgs.motion import Motion
from mgs.pipeline import run_stages
from mgs.robot import Robot, load_robot
from mgs.sim import DEFAULTS, EngineName, Replay, Settings, available_engines, replay

WALKS = ("melson/walk_practical", "melson/walk_fastest", "melson/walk_arc")
VARIATIONS: dict[EngineName, dict[str, tuple[float, ...]]] = {
    "pybullet": {
        "dt": (0.004, 0.002, 0.0005),
        "iterations": (10, 25, 100, 200),
        "stiffness": (100.0, 300.0, 3000.0),
        "damping": (0.02, 0.1, 1.0),
    },
    "mujoco": {
        "dt": (0.002, 0.001, 0.00025),
        "iterations": (5, 20, 100),
        "stiffness": (30.0, 100.0, 1000.0),
        "damping": (0.005, 0.01, 0.04),
    },
}


def cases(engine: EngineName, robot: Robot) -> Iterator[tuple[str, Robot, Settings]]:
    """Default settings and every single change of them, with labels."""
    default = DEFAULTS[engine]
    yield "default", robot, default
    for key, values in VARIATIONS[engine].items():
        for value in values:
            change: dict[str, Any] = {key: value}
            yield f"{key} = {value:g}", robot, dataclasses.replace(default, **change)
    if engine == "mujoco":
        for armature in (1e-3, 0.01):
            other = dataclasses.replace(robot, armature=np.full(robot.n, armature))
            yield f"armature = {armature:g}", other, default


def standing(motion: Motion, seconds: float = 3.0) -> Motion:
    """Motion that holds the first sample of a motion."""
    samples = np.zeros(round(seconds / motion.dt) + 1, dtype=int)
    names = ("q", "v", "support", "soles")
    return dataclasses.replace(motion, **{name: getattr(motion, name)[samples] for name in names})


def row(
    label: str, robot: Robot, settings: Settings, engine: EngineName, walks: list[Motion]
) -> str:
    """Row of the table."""
    motions = [dataclasses.replace(walk, robot=robot) for walk in (standing(walks[0]), *walks)]
    still, *replays = (replay(motion, engine, settings) for motion in motions)
    turn = rotation_angles(still.trace.q[:1, 3:7], still.trace.q[:, 3:7]).max()
    cells = [label, f"{still.settled_tilt_deg:.3f}", f"{np.degrees(turn):.3f}"]
    cells += [walk_cell(walk) for walk in replays]
    return f"| {' | '.join([*cells, f'{replays[0].wall_seconds:.1f}'])} |"


def walk_cell(walk: Replay) -> str:
    """Verdict and results of one walk."""
    if walk.fell:
        return f"fell at {walk.fall_time:.1f} s"
    figures = (walk.max_tilt_deg, 1e3 * walk.sole_slip_max, 1e3 * walk.position_error)
    cells = [f"{figure:.2f}" for figure in figures]
    return " / ".join([*cells, f"{1e3 * walk.torque_saturation:.0f}"])


def main() -> None:
    """Print one table per engine."""
    robot = load_robot("melson")
    walks = [run_stages(robot, load_gait(name)).motion for name in WALKS]
    for engine in available_engines():
        if sys.argv[1:] and engine not in sys.argv[1:]:
            continue
        default = DEFAULTS[engine]
        heads = [
            f"{name.removeprefix('melson/')}: tilt / slip / error / sat. [deg / mm / mm / ms]"
            for name in WALKS
        ]
        columns = [f"{engine}: {default}", "settled [deg]", "rocking [deg]", *heads, "wall [s]"]
        print(f"\n| {' | '.join(columns)} |\n|{' --- |' * len(columns)}")
        for label, variant, settings in cases(engine, robot):
            print(row(label, variant, settings, engine, walks), flush=True)


if __name__ == "__main__":
    main()
