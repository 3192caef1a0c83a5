"""The command mgs envelope."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mgs.cli.common import (
    FiniteRange,
    ProgressBar,
    force_option,
    json_option,
    json_text,
    print_json,
    say,
    with_progress,
)
from mgs.cli.judge import engines_of
from mgs.cli.servo_options import servo_option_of
from mgs.core.errors import ConfigError

if TYPE_CHECKING:
    from mgs.gait import WalkGait
    from mgs.robot import Robot
    from mgs.search.envelope import Envelope
    from mgs.sim import ServoName

MOST_TIMES = 100


@click.command()
@click.argument("robot_name", metavar="ROBOT")
@click.option(
    "--gait", metavar="GAIT.yaml",
    help="Walking gait whose steps are varied: a file or the name of a shipped gait. Default: a "
    "walk of ten steps in proportion to the size of the robot.",
)  # fmt: skip
@click.option(
    "--set", "assignments", metavar="KEY=VALUE", multiple=True,
    help="Change of a value of this walking gait, e.g. walk.com_height=0.25. May be repeated.",
)  # fmt: skip
@click.option(
    "--times", metavar="T,T,...",
    help="Step times [s], separated by commas. Default: six times in proportion to sqrt(L / g), "
    "with leg length L and gravity g.",
)  # fmt: skip
@click.option(
    "--resolution",
    type=FiniteRange(1e-4, 0.5),
    help="Resolution of the step length [m]. Default: 2 % of the leg length.",
)
@click.option(
    "--physics", metavar="ENGINES",
    help="Physics engines for the replays: pybullet, mujoco or pybullet,mujoco. Default: all "
    "installed engines.",
)  # fmt: skip
@servo_option_of("model")
@click.option(
    "--workers", type=click.IntRange(1, 1024), default=1,
    help="Number of worker processes. Default: 1.",
)  # fmt: skip
@click.option(
    "-o", "--output", type=click.Path(file_okay=False, path_type=Path),
    help="Folder for the results. Default: outputs/ROBOT/envelope.",
)  # fmt: skip
@force_option
@json_option
@click.pass_context
def envelope(
    ctx: click.Context,
    robot_name: str,
    gait: str | None,
    assignments: tuple[str, ...],
    times: str | None,
    resolution: float | None,
    physics: str | None,
    servo: ServoName,
    workers: int,
    output: Path | None,
    force: bool,
    as_json: bool,
) -> None:
    """Find the longest forward step and the fastest walk of a robot.

    ROBOT is the name of a shipped robot or a robot folder. For each step time (duration of
    one single and one double support phase) the command searches for the longest step with which
    the walk passes all static checks and the robot stays up in every physics engine.

    Writes envelope.json (all walks that were tried; updated after each step time), envelope.png
    (map of step time, step length and speed) and fastest.yaml (the gait with the highest speed).
    Exit code 1 if no walk passes.

    \b
    Examples:
      mgs envelope melson --workers 2
      mgs envelope coman --gait coman/walk --times 0.6,0.8,1.0 --resolution 0.02
      mgs envelope melson --servo ideal --set walk.com_height=0.25
    """  # noqa: D301
    from mgs.core.atomic_files import refuse_taken, replace_file
    from mgs.report import plot_envelope, save_figures
    from mgs.robot import leg_length, load_robot
    from mgs.search.envelope import default_step_times, find_envelope

    robot = load_robot(robot_name)
    base = _base_gait(robot, robot_name, gait, assignments)
    engines = engines_of(physics)
    if not engines:
        raise ConfigError("--physics", "none is not possible, because the search needs replays; "
                          "name pybullet or mujoco")  # fmt: skip
    if servo == "model":
        from mgs.robot import servos_of

        servos_of(robot)  # before the first probe takes its time
    folder = output or Path("outputs") / Path(robot_name).name / "envelope"
    record, best = folder / "envelope.json", folder / "fastest.yaml"
    for path in (record, best, folder / "envelope.png"):
        refuse_taken(path, force)

    def keep(found: Envelope) -> None:
        replace_file(record, json_text(found.to_dict()).encode())

    def work(bar: ProgressBar) -> Envelope:
        return find_envelope(
            robot,
            base,
            _times(times) if times else default_step_times(robot, base.dt),
            resolution=resolution or round(0.02 * leg_length(robot), 4),
            engines=tuple(engines),
            servo=servo,
            workers=workers,
            progress=bar,
            keep=keep,
        )

    found = with_progress("step times", work)
    save_figures({"envelope": plot_envelope(found)}, folder, force=True)
    if (gait_found := found.fastest_gait()) is not None:
        replace_file(best, gait_found.to_yaml().encode())
    else:
        best.unlink(missing_ok=True)
    if as_json:
        print_json(found.to_dict())
    else:
        _print(found, folder)
    ctx.exit(0 if gait_found is not None else 1)


def _base_gait(
    robot: Robot, robot_name: str, gait: str | None, assignments: tuple[str, ...]
) -> WalkGait:
    from mgs.gait import WalkGait, load_gait, parse_gait
    from mgs.search.envelope import default_walk

    sets = (*assignments, f"robot={json.dumps(robot_name)}")
    if gait is None:
        text = default_walk(robot, robot_name).to_yaml()
        found = parse_gait(text, f"walk of {robot.spec.name}", sets)
    else:
        found = load_gait(gait, sets)
    if not isinstance(found, WalkGait):
        raise ConfigError(
            str(gait), f"motion: {found.motion} has no steps; use a gait with motion: walk"
        )
    return found


def _times(text: str) -> list[float]:
    try:
        times = sorted({round(float(part), 6) for part in text.split(",")})
    except ValueError:
        times = []
    if not times or not all(0.0 < time <= 60.0 for time in times) or len(times) > MOST_TIMES:
        raise ConfigError(
            "--times", f"{text!r} is not a list of step times; give 1 to {MOST_TIMES} numbers "
            "above 0 and up to 60 [s], separated by commas"
        )  # fmt: skip
    return times


def _print(found: Envelope, folder: Path) -> None:
    for time, probe in found.limits().items():
        if probe is None:
            reasons = [p for p in found.probes if p.step_time == time]
            shortest = min(reasons, key=lambda p: p.step_length)
            failed = ", ".join(shortest.failed)
            say(f"{time:6.2f} s  no step passes; the shortest one fails {failed}")
            continue
        longer = [p for p in found.probes if p.step_time == time and not p.passed]
        stop = min(longer, key=lambda p: p.step_length, default=None)
        failed = "" if stop is None else ", ".join(stop.failed)
        why = "" if stop is None else f"; {stop.step_length:.3f} m fails {failed}"
        say(
            f"{time:6.2f} s  {probe.step_length:.3f} m  {probe.speed:.3f} m/s  "
            f"ZMP margin {1e3 * (probe.zmp_margin or 0.0):.1f} mm{why}"
        )
    fastest = found.fastest
    if fastest is None:
        say(f"no walk passes; results are in {folder}")
        return
    say(
        f"fastest walk: steps of {fastest.step_length:.3f} m in {fastest.step_time:.2f} s, "
        f"{fastest.speed:.3f} m/s, Froude number {found.froude(fastest):.4f} "
        f"(leg length {found.leg_length:.3f} m); {folder / 'fastest.yaml'}"
    )
