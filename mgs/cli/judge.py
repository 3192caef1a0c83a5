"""The commands mgs validate and mgs replay."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mgs.cli import verdict_text
from mgs.cli.colour import bad, good
from mgs.cli.common import (
    FiniteRange,
    force_option,
    json_option,
    motion_argument,
    print_json,
    progress_bars,
    say,
    with_progress,
)
from mgs.cli.servo_options import (
    check_servos,
    correct_option,
    damping_time_option,
    feed_forward_option,
    sag_option,
    servo_option,
    servos_option_of,
    unit_option,
)

if TYPE_CHECKING:
    from mgs.judge.verdict import Verdict
    from mgs.sim import EngineName, ServoName


@click.command()
@motion_argument
@click.option(
    "--physics", metavar="ENGINES",
    help="Physics engines for the replays: pybullet, mujoco, pybullet,mujoco or none. Default: all "
    "installed engines.",
)  # fmt: skip
@servos_option_of("ideal,pd")
@sag_option
@damping_time_option
@feed_forward_option
@click.option(
    "--monte-carlo", "n_draws", metavar="N", type=click.IntRange(1, 100_000),
    help="Number of additional replays under randomly varied conditions.",
)  # fmt: skip
@click.option(
    "--ranges", type=click.Choice(["wide", "lab"]), default="wide",
    help="Ranges of the random conditions for --monte-carlo and --sample: wide, or half as wide "
    "(lab). Default: wide.",
)  # fmt: skip
@click.option(
    "--seed", type=click.IntRange(0), default=0, help="Seed of the random conditions. Default: 0."
)
@click.option(
    "--workers", type=click.IntRange(1, 1024), default=1,
    help="Number of worker processes. Default: 1.",
)  # fmt: skip
@click.option(
    "--sample", metavar="K", type=click.IntRange(0),
    help="Repeat draw number K (from 0) of --monte-carlo with the same --seed and --ranges, "
    "instead of a replay under the planned conditions.",
)  # fmt: skip
@click.option(
    "--servo-sweep", is_flag=True,
    help="Also replay the motion with PD servos of several stiffnesses, with and without "
    "feed-forward, at several friction coefficients. PASS or FAIL does not depend on it.",
)  # fmt: skip
@click.option(
    "--sweep-plot", metavar="FILE", type=click.Path(dir_okay=False, path_type=Path),
    help="PNG or SVG file for a figure of the servo sweep.",
)  # fmt: skip
@unit_option
@correct_option
@force_option
@json_option
@click.pass_context
def validate(
    ctx: click.Context,
    file: Path,
    physics: str | None,
    servos: tuple[ServoName, ...],
    sag_deg: float | None,
    damping_time: float | None,
    feed_forward: bool | None,
    n_draws: int | None,
    ranges: str,
    seed: int,
    workers: int,
    sample: int | None,
    servo_sweep: bool,
    sweep_plot: Path | None,
    unit: Path | None,
    corrected: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Judge a motion by static checks and by open-loop replays in physics engines.

    Reads FILE.mcap and prints each check with its value and its limit, a summary of each replay,
    and PASS or FAIL. Writes no file unless --sweep-plot names one. A physics engine that is not
    installed is named, with the cause and what to do about it.

    With --monte-carlo N the motion is also replayed N times under random conditions: floor
    friction, slope and bumps, masses, centre of mass, servo gains, supply voltage, latency, joint
    zero positions and the sag of PD servos (position error at stall torque) vary. The robot has to
    stay up in at least 95 % of these replays. They use the first kind of servos that --servo names.

    Exit code 0 if all checks pass, 1 if a check fails.

    \b
    Examples:
      mgs validate walk.mcap
      mgs validate walk.mcap --physics none --json
      mgs validate walk.mcap --servo model
      mgs validate walk.mcap --servo ideal,pd --sag 2
      mgs validate walk.mcap --monte-carlo 200 --ranges wide --workers 4
      mgs validate walk.mcap --sample 17
      mgs validate walk.mcap --servo-sweep --sweep-plot servos.png --workers 2
    """  # noqa: D301
    from mgs.judge.validate import validate as run

    engines = engines_of(physics)
    pd_too = ("pd",) if servo_sweep else ()
    check_servos((*servos, *pd_too), feed_forward, sag_deg, damping_time)
    plot = _sweep_figure_path(sweep_plot, servo_sweep and bool(engines), force)
    with progress_bars() as tell:
        verdict = run(
            file,
            physics=engines,
            servo=servos,
            sag_deg=sag_deg,
            damping_time=damping_time,
            feed_forward=feed_forward,
            monte_carlo=n_draws,
            ranges=ranges,
            seed=seed,
            workers=workers,
            sample=sample,
            servo_sweep=servo_sweep,
            unit=unit,
            corrected=corrected,
            progress=tell,
        )
    if plot is not None:
        _draw_sweep(verdict, plot)
    if as_json:
        print_json(verdict.to_dict())
    else:
        _print_verdict(verdict)
    ctx.exit(0 if verdict.passed else 1)


@click.command()
@motion_argument
@click.option(
    "--engine", type=click.Choice(["pybullet", "mujoco"]),
    help="Physics engine. Default: pybullet if installed, else mujoco.",
)  # fmt: skip
@click.option(
    "--step",
    type=FiniteRange(1e-5, 0.01),
    help="Time step of the simulation [s]. Default: 0.001 in PyBullet, 0.0005 in MuJoCo.",
)
@click.option(
    "--iterations", type=click.IntRange(1, 10_000),
    help="Largest number of iterations of the contact solver per time step. Default: 50.",
)  # fmt: skip
@click.option(
    "--friction", type=FiniteRange(0.0, 10.0),
    help="Friction coefficient between soles and ground. Default: 1.",
)  # fmt: skip
@servo_option
@sag_option
@damping_time_option
@feed_forward_option
@unit_option
@correct_option
@click.option(
    "--record", metavar="FILE", type=click.Path(dir_okay=False, path_type=Path),
    help="File for what happens: .mcap (the motion file with the simulated joints, base, links, "
    "contact forces and ZMP as topics /sim/*), .gif or .mp4 (moving picture), or .png (the robot "
    "at several instants). Default: none.",
)  # fmt: skip
@force_option
@json_option
@click.pass_context
def replay(
    ctx: click.Context,
    file: Path,
    engine: EngineName | None,
    step: float | None,
    iterations: int | None,
    friction: float | None,
    servo: ServoName,
    sag_deg: float | None,
    damping_time: float | None,
    feed_forward: bool | None,
    unit: Path | None,
    corrected: bool,
    record: Path | None,
    force: bool,
    as_json: bool,
) -> None:
    """Execute a motion open loop in one physics engine and measure the result.

    Reads FILE.mcap, writes a file only if --record names one, and prints whether the robot stays
    up, the distance covered, tilt, sole slip, joint errors and the time at torque limits. Exit code
    1 if the robot falls.

    \b
    Examples:
      mgs replay walk.mcap
      mgs replay walk.mcap --engine mujoco --friction 0.5 --json
      mgs replay walk.mcap --servo pd --sag 2
      mgs replay walk.mcap --servo model --no-feed-forward
      mgs replay walk.mcap --servo model --unit number_7.yaml --no-correct
      mgs replay walk.mcap --engine mujoco --record replay.gif
    """  # noqa: D301
    from mgs.motion_file import read_motion
    from mgs.robot.unit import load_unit
    from mgs.sim import OneRobot, engine_settings, missing_engines
    from mgs.sim import replay as run

    check_servos((servo,), feed_forward, sag_deg, damping_time)
    if record is not None:
        from mgs.report.recording import check_record, write_record

        check_record(record, force)
    name = engine or engines_of(None)[0]
    changes = {"dt": step, "iterations": iterations, "friction": friction}
    settings = engine_settings(name, sag_deg, damping_time, **changes)
    motion = read_motion(file)
    one_robot = None if unit is None else OneRobot(load_unit(unit, motion.robot), corrected)
    go = partial(run, servo=servo, feed_forward=feed_forward, one_robot=one_robot)
    result = with_progress(name, lambda bar: go(motion, name, settings, bar))
    if record is not None:
        path = record
        with_progress(
            path.name,
            lambda bar: write_record(motion, result, path, force=force, progress=bar),
        )
    if as_json:
        missing = [engine.to_dict() for engine in missing_engines()]
        print_json({**result.to_json(), "engines_missing": missing})
    else:
        told = (verdict_text.sentence(result), *verdict_text.sources([result]), *missing_engines())
        for text in told:
            say(text)
    ctx.exit(1 if result.fell else 0)


def engines_of(physics: str | None) -> list[EngineName]:
    """Physics engines named in an option; without an option, all installed engines."""
    from mgs.sim import choose_engines

    return list(choose_engines(physics, "--physics"))


def _sweep_figure_path(path: Path | None, is_swept: bool, force: bool) -> Path | None:
    """Path of the figure, checked before the work."""
    if path is None:
        return None
    from mgs.core.atomic_files import refuse_taken
    from mgs.core.errors import ConfigError

    if not is_swept:
        raise ConfigError("--sweep-plot", "there is no servo sweep to draw; add --servo-sweep")
    if path.suffix not in (".png", ".svg"):
        raise ConfigError("--sweep-plot", f"{path}: the name should end in .png or .svg")
    refuse_taken(path, force)
    return path


def _draw_sweep(verdict: Verdict, path: Path) -> None:
    from mgs.report import plot_servo_sweep, save_figures

    figure = plot_servo_sweep(verdict.servo_sweep or (), Path(verdict.file).stem)
    fmt: Any = path.suffix[1:]
    save_figures({path.stem: figure}, path.parent, fmt, force=True)


def _print_verdict(verdict: Verdict) -> None:
    for check in verdict.checks:
        text = verdict_text.line(check)
        say((good if check.ok else bad)(text[:4]) + text[4:])
    if verdict.energy is not None:
        say(f"energy: {verdict_text.energy_words(verdict.energy)}")
    for replay in verdict.replays:
        say(verdict_text.sentence(replay))
    for text in verdict_text.sources(verdict.replays):
        say(text)
    if (agreed := verdict.agreement) is not None:
        say(verdict_text.agreement(agreed))
    draws: Any = verdict.monte_carlo or {"engines": ()}
    for figures in draws["engines"]:
        say(verdict_text.survival(figures))
    for sweep in verdict.servo_sweep or ():
        for text in verdict_text.servo_sweep(sweep):
            say(text)
    if verdict.left_out:
        say(f"not made, since the motion was not planned: {', '.join(verdict.left_out)}")
    if not verdict.replays:
        say("no replay in physics: falling was not checked")
    for missing in verdict.engines_missing:
        say(missing)
    if verdict.guesses:
        say(f"rests on values in robot.yaml that were guessed: {', '.join(verdict.guesses)}")
    failed = verdict.failed
    say(bad(f"FAIL: {', '.join(failed)}") if failed else good("PASS"))
