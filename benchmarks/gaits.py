"""Every shipped gait before the judge: the table in README.md and, with --settings, its robustness.

python benchmarks/gaits.py             one row a gait, each engine at its default settings
python benchmarks/gaits.py --settings  each engine also at half the step and at twice the iterations
"""

from __future__ import annotations

import argparse
import dataclasses

import numpy as np

from mgs.checks import Check, check_motion
from mgs.gait import WalkGait, list_gaits, load_gait
from mgs.motion import Motion
from mgs.robot import load_robot
from mgs.sequence import generate_motion
from mgs.sim import DEFAULTS, EngineName, Replay, Settings, available_engines, replay
from mgs.verdict import replay_checks


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("gaits", nargs="*", help="names; default: all that ship")
    parser.add_argument("--settings", action="store_true", help="vary step and iterations")
    arguments = parser.parse_args()
    names = arguments.gaits or list_gaits()
    engines = available_engines()
    if arguments.settings:
        print("| gait | engine | settings | verdict | off plan | tilt |")
        print("| --- | --- | --- | --- | --- | --- |")
    else:
        columns = " | ".join(f"{engine}: off plan, tilt" for engine in engines)
        print(f"| gait | speed | least ZMP margin | fastest joint | {columns} | verdict |")
        print("| --- " * (5 + len(engines)) + "|")
    for name in names:
        gait = load_gait(name)
        motion = generate_motion(load_robot(gait.robot or "melson"), gait, name).motion
        if arguments.settings:
            print_settings(name, motion, engines)
        else:
            print_row(name, motion, engines)


def print_row(name: str, motion: Motion, engines: tuple[EngineName, ...]) -> None:
    """One gait: static figures and one replay an engine."""
    checks = {check.name: check for check in check_motion(motion)}
    replays = [replay(motion, engine) for engine in engines]
    speed, margin = checks["joint_speed"], checks["zmp_margin"].value
    physical = " | ".join(figures(result) for result in replays)
    every = [*checks.values(), *(c for result in replays for c in replay_checks(result))]
    print(
        f"| {name} | {walking_speed(motion)} | {1e3 * margin:.1f} mm | "
        f"{speed.value:.2f} of {speed.limit:.2f} rad/s | {physical} | {verdict(every)} |",
        flush=True,
    )


def print_settings(name: str, motion: Motion, engines: tuple[EngineName, ...]) -> None:
    """One gait: each engine at three settings."""
    for engine in engines:
        for label, settings in variants(DEFAULTS[engine]).items():
            result = replay(motion, engine, settings)
            print(
                f"| {name} | {engine} | {label} | {verdict(replay_checks(result))} | "
                f"{1e3 * result.position_error:.1f} mm, {abs(result.yaw_error_deg):.2f} deg | "
                f"{result.max_tilt_deg:.2f} deg |",
                flush=True,
            )


def variants(settings: Settings) -> dict[str, Settings]:
    """The settings, half their step, twice their iterations."""
    return {
        "default": settings,
        "half step": dataclasses.replace(settings, dt=settings.dt / 2),
        "twice the iterations": dataclasses.replace(settings, iterations=2 * settings.iterations),
    }


def walking_speed(motion: Motion) -> str:
    """Mean speed of the sole centres between the first and the last step."""
    if not isinstance(motion.gait, WalkGait):
        return "on the spot"
    walk = motion.gait.walk
    per_step = walk.double_support + walk.single_support
    if walk.step_length:
        return f"{walk.step_length / per_step:.2f} m/s"
    if walk.lateral:
        return f"{abs(walk.lateral) / (2 * per_step):.3f} m/s sideways"
    return f"{np.degrees(walk.step_yaw) / per_step:.0f} deg/s"


def figures(result: Replay) -> str:
    """Distance from plan and tilt of one replay."""
    if result.fell:
        return f"fell at {result.fall_time:.1f} s"
    return f"{1e3 * result.position_error:.1f} mm, {result.max_tilt_deg:.1f} deg"


def verdict(checks: list[Check]) -> str:
    """Pass, or the names of what fails."""
    failed = [check.name for check in checks if not check.ok]
    return f"FAIL: {', '.join(failed)}" if failed else "pass"


if __name__ == "__main__":
    main()
