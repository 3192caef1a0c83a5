"""Influence of modelled servos and of feed-forward commands on replays of walks.

Run as `python benchmarks/servo_study.py [stiffness|step|servo|command|gaits ...]`; prints the
tables of docs/simulation.md as Markdown. A cell is one replay: largest tilt [deg], root mean square
of the joint errors [deg] and distance from the plan at the end [mm].
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import yaml

from mgs.core.arrays import Array
from mgs.core.contact import Support
from mgs.gait import list_gaits, load_gait
from mgs.motion import Motion
from mgs.motion.dynamics import analyse
from mgs.pipeline import generate
from mgs.robot import build_robot, load_robot, servos_of
from mgs.sim import DEFAULTS, EngineName, available_engines, replay

WALKS = ("melson/walk_5cm", "melson/walk_practical")
STIFFNESS = (
    17.1,
    34.2,
    100.0,
    300.0,
)  # stiffness of the leg servos [N m/rad]; 17.1 is compliance slope 32
SERVOS: dict[str, dict[str, float]] = {
    "as in robot.yaml": {},
    "latency 0": {"latency": 0.0},
    "latency 20 ms": {"latency": 0.02},
    "no deadband": {"deadband": 0.0, "punch": 0.0},
    "neither deadband nor ticks": {"deadband": 0.0, "punch": 0.0, "resolution": 0.0},
    "no friction": {"friction": 0.0},
    "friction 0.2 N m": {"friction": 0.2},
    "twice the armature": {"armature": 0.01},
    "no damping": {"damping": 0.0},
}


def changed(motion: Motion, changes: Callable[[dict[str, Any]], Mapping[str, float]]) -> Motion:
    """Motion of a robot with changed servo parameters, as given by `changes`."""
    tree = yaml.safe_load(motion.robot.yaml)
    for servo in tree["servos"].values():
        slope = servo.pop("compliance_slope")
        servo["stiffness"] = servo["stall_torque"] / (slope * servo["resolution"])
        servo.update(changes(servo))
    robot = build_robot(yaml.safe_dump(tree), motion.robot.urdf, "study")
    return dataclasses.replace(motion, robot=robot)


def with_stiffness(motion: Motion, stiffness: float) -> Motion:
    """Motion of a robot with another stiffness of the leg servos [N m/rad], arms in proportion."""

    def change(servo: dict[str, Any]) -> dict[str, float]:
        scaled = stiffness * servo["stall_torque"] / 2.8
        return {"stiffness": scaled, "punch": scaled * servo["deadband"]}

    return changed(motion, change)


def cell(motion: Motion, engine: EngineName, feed_forward: bool, step: float = 1.0) -> str:
    """Results of one replay; `step` is a multiple of the default time step."""
    settings = DEFAULTS[engine]
    settings = dataclasses.replace(settings, dt=step * settings.dt)
    result = replay(motion, engine, settings, servo="model", feed_forward=feed_forward)
    if result.fell:
        return f"fell at {result.fall_time:.1f} s"
    figures = (result.max_tilt_deg, result.joint_error_rms_deg, 1e3 * result.position_error)
    return "{:.1f} / {:.2f} / {:.0f}".format(*figures)


def table(head: str, columns: list[str]) -> None:
    """Print the header of a table."""
    print(f"\n| {' | '.join([head, *columns])} |\n|{' --- |' * (1 + len(columns))}")


def with_and_without(label: str, motion: Motion, step: float = 1.0) -> None:
    """Print one row: every engine with and without feed-forward."""
    cells = [
        cell(motion, engine, feed_forward, step)
        for engine in available_engines()
        for feed_forward in (True, False)
    ]
    print(f"| {' | '.join([label, *cells])} |", flush=True)


def both() -> list[str]:
    """Column names of `with_and_without`."""
    kinds = ("with feed-forward", "without")
    return [f"{engine}, {kind}" for engine in available_engines() for kind in kinds]


def walk(name: str) -> Motion:
    """Motion of a shipped Melson walk."""
    return generate(load_robot("melson"), load_gait(name), name).motion


def study_stiffness() -> None:
    """Print the results of walks at several stiffnesses."""
    table("walk, stiffness of the legs [N m/rad]", both())
    for name in WALKS:
        motion = walk(name)
        for stiffness in STIFFNESS:
            label = f"{name.removeprefix('melson/')}, {stiffness:g}"
            with_and_without(label, with_stiffness(motion, stiffness))


def study_step() -> None:
    """Print the results of a walk at several time steps of the simulation."""
    motion = walk(WALKS[1])
    table("walk_practical, physics step", both())
    for label, step in (("default", 1.0), ("half", 0.5), ("a quarter", 0.25)):
        with_and_without(label, motion, step)


def study_gaits() -> None:
    """Print the results of every shipped Melson gait."""
    table("gait", both())
    for name in list_gaits():
        if name.startswith("melson/"):
            with_and_without(name.removeprefix("melson/"), walk(name))


def study_servo() -> None:
    """Print the results of a walk with one changed servo property at a time, with feed-forward."""
    motion = walk(WALKS[1])
    table("walk_practical, servos", list(available_engines()))
    for label, change in SERVOS.items():
        variant = changed(motion, lambda _, change=change: change)  # type: ignore[misc]
        cells = [cell(variant, engine, True) for engine in available_engines()]
        print(f"| {' | '.join([label, *cells])} |", flush=True)


def halved(motion: Motion) -> Array:
    """Joint torques (N, n) [N m] if each foot carried half of the weight in double support."""
    alone = [motion.support == Support.LEFT, motion.support == Support.RIGHT]
    load_left = np.select(alone, [1.0, 0.0], 0.5)
    return analyse(motion.robot, motion.q, motion.dt, load_left).torque


def study_command() -> None:
    """Print the results of commands without one of their terms, which is subtracted from torque."""
    motion = walk(WALKS[1])
    servos, v = servos_of(motion.robot), motion.v[:, 6:]
    rotors = motion.robot.armature * np.gradient(v, motion.dt, axis=0)
    terms = {
        "q + (torque + friction + damping v) / K": np.zeros_like(v),
        "without the damping term": servos.damping * v,
        "without the friction term": servos.friction(v),
        "without the rotors' inertia": rotors,
        "q + torque / K": servos.friction(v) + servos.damping * v,
        "double support shared by halves": motion.torque - halved(motion),
        "without the torque": motion.torque,
    }
    table("walk_practical, command", list(available_engines()))
    for label, term in terms.items():
        variant = dataclasses.replace(motion, torque=motion.torque - term)
        cells = [cell(variant, engine, True) for engine in available_engines()]
        print(f"| {' | '.join([label, *cells])} |", flush=True)


STUDIES = {
    "stiffness": study_stiffness,
    "step": study_step,
    "servo": study_servo,
    "command": study_command,
    "gaits": study_gaits,
}


def main() -> None:
    """Print the selected tables, or all of them."""
    for name in sys.argv[1:] or STUDIES:
        STUDIES[name]()


if __name__ == "__main__":
    main()
