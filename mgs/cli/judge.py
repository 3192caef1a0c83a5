"""The commands mgs validate and mgs replay."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from mgs.cli.common import (
    FiniteRange,
    json_option,
    motion_argument,
    print_json,
    progress_bars,
    with_progress,
)

if TYPE_CHECKING:
    from mgs.judge.motion_checks import Check
    from mgs.judge.verdict import Verdict
    from mgs.sim import Agreement, EngineName, Replay, ServoName

F = TypeVar("F", bound=Callable[..., Any])


def servo_option_of(default: str) -> Callable[[F], F]:
    """Option --servo with the given default."""
    return click.option(
        "--servo", type=click.Choice(["ideal", "model"]), default=default,
        help="Servos in the replays: ideal position control, or the servo models of robot.yaml. "
        f"Default: {default}.",
    )  # fmt: skip


servo_option = servo_option_of("ideal")
feed_forward_option = click.option(
    "--feed-forward/--no-feed-forward", default=None,
    help="Commands to modelled servos: angles that compensate their position error under load, or "
    "the planned angles. Default: --feed-forward.",
)  # fmt: skip


@click.command()
@motion_argument
@click.option(
    "--physics", metavar="ENGINES",
    help="Physics engines for the replays: pybullet, mujoco, pybullet,mujoco or none. Default: all "
    "installed engines.",
)  # fmt: skip
@servo_option
@feed_forward_option
@click.option(
    "--monte-carlo", "n_draws", metavar="N", type=click.IntRange(1, 100_000),
    help="Number of additional replays under randomly varied conditions.",
)  # fmt: skip
@click.option(
    "--ranges", type=click.Choice(["wide", "lab"]), default="wide",
    help="Ranges of the random conditions: wide, or lab with half of the width. Default: wide.",
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
    help="Replay the motion under random conditions number K instead of the planned conditions.",
)  # fmt: skip
@json_option
@click.pass_context
def validate(
    ctx: click.Context,
    file: Path,
    physics: str | None,
    servo: ServoName,
    feed_forward: bool | None,
    n_draws: int | None,
    ranges: str,
    seed: int,
    workers: int,
    sample: int | None,
    as_json: bool,
) -> None:
    """Judge a motion by static checks and by open-loop replays in physics engines.

    Reads FILE.mcap, writes no file, and prints each check with its value and its limit, a summary
    of each replay, and PASS or FAIL.

    With --monte-carlo N the motion is also replayed N times under random conditions: floor
    friction, slope and bumps, masses, centre of mass, servo gains, supply voltage, latency and
    joint zero positions vary. The robot has to stay up in at least 95 % of these replays.

    Exit code 0 if all checks pass, 1 if a check fails.

    \b
    Examples:
      mgs validate walk.mcap
      mgs validate walk.mcap --physics none --json
      mgs validate walk.mcap --servo model
      mgs validate walk.mcap --monte-carlo 200 --ranges wide --workers 4
      mgs validate walk.mcap --sample 17
    """  # noqa: D301
    from mgs.judge.validate import validate as run

    engines = engines_of(physics)
    check_servo(servo, feed_forward)
    with progress_bars() as tell:
        verdict = run(
            file,
            physics=engines,
            servo=servo,
            feed_forward=feed_forward,
            monte_carlo=n_draws,
            ranges=ranges,
            seed=seed,
            workers=workers,
            sample=sample,
            progress=tell,
        )
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
@click.option("--step", type=FiniteRange(1e-5, 0.01), help="Time step of the simulation [s].")
@click.option(
    "--iterations", type=click.IntRange(1, 10_000),
    help="Largest number of iterations of the contact solver per time step.",
)  # fmt: skip
@click.option(
    "--friction", type=FiniteRange(0.0, 10.0),
    help="Friction coefficient between soles and ground.",
)  # fmt: skip
@servo_option
@feed_forward_option
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
    feed_forward: bool | None,
    as_json: bool,
) -> None:
    """Execute a motion open loop in one physics engine and measure the result.

    Reads FILE.mcap, writes no file, and prints whether the robot stays up, the distance covered,
    tilt, sole slip, joint errors and the time at torque limits. Exit code 1 if the robot falls.

    \b
    Examples:
      mgs replay walk.mcap
      mgs replay walk.mcap --engine mujoco --friction 0.5 --json
      mgs replay walk.mcap --servo model --no-feed-forward
    """  # noqa: D301
    import dataclasses

    from mgs.sim import DEFAULTS
    from mgs.sim import replay as run

    check_servo(servo, feed_forward)
    name = engine or engines_of(None)[0]
    changes = {"dt": step, "iterations": iterations, "friction": friction}
    given = {key: value for key, value in changes.items() if value is not None}
    settings = dataclasses.replace(DEFAULTS[name], **given)  # type: ignore[arg-type]
    result = with_progress(
        name, lambda bar: run(file, name, settings, bar, servo=servo, feed_forward=feed_forward)
    )
    if as_json:
        print_json(result.to_json())
    else:
        click.echo(_sentence(result))
    ctx.exit(1 if result.fell else 0)


def engines_of(physics: str | None) -> list[EngineName]:
    """Physics engines named in an option; without an option, all installed engines."""
    from mgs.sim import choose_engines

    return list(choose_engines(physics, "--physics"))


def check_servo(servo: ServoName, feed_forward: bool | None) -> None:
    """Raise ConfigError if feed-forward commands are requested for ideal servos."""
    from mgs.sim import check_servo

    check_servo(servo, feed_forward, "--feed-forward")


def _print_verdict(verdict: Verdict) -> None:
    for check in verdict.checks:
        click.echo(_line(check))
    for replay in verdict.replays:
        click.echo(_sentence(replay))
    if (agreed := verdict.agreement) is not None:
        click.echo(_agreement(agreed))
    draws: Any = verdict.monte_carlo or {"engines": ()}
    for figures in draws["engines"]:
        click.echo(_survival(figures))
    if not verdict.replays:
        click.echo("no replay in physics: falling was not checked")
    failed = verdict.failed
    click.echo(f"FAIL: {', '.join(failed)}" if failed else "PASS")


def _line(check: Check) -> str:
    mark = "ok  " if check.ok else "FAIL"
    time = "" if check.time is None else f"  at {check.time:.2f} s"
    where = f"  {check.where}" if check.where else ""
    figure = f"{check.value:.4g} {check.unit} (limit {check.limit:.4g})"
    return f"{mark} {check.name:22s} {figure}{time}{where}"


def _survival(figures: dict[str, Any]) -> str:
    low, high = figures["wilson_95"]
    text = (
        f"{figures['engine']}, {figures['servo']} servos, ranges {figures['ranges']}, "
        f"seed {figures['seed']}: the robot stays up in {figures['survived']} of {figures['n']} "
        f"replays, 95 % confidence interval {low:.3f} to {high:.3f}"
    )
    worst = figures["offenders"]
    if worst:
        told = (f"{o['parameter']} ({o['probability']:.2f})" for o in worst[:3])
        text += f"; falls correlate with {', '.join(told)}"
    return text


def _agreement(found: Agreement) -> str:
    apart = (
        f"sole loads {100.0 * found.load:.0f} % of the weight (RMS), ZMP "
        f"{1e3 * found.zmp:.1f} mm (RMS), tilt {found.tilt_deg:.1f} deg, "
        f"final pose {1e3 * found.end_position:.1f} mm and {found.end_yaw_deg:.1f} deg"
    )
    fate = "" if found.same_fate else "; they DISAGREE on whether the robot falls"
    return f"differences between {' and '.join(found.engines)}: {apart}{fate}"


def _sentence(replay: Replay) -> str:
    x, y = replay.distance
    planned_x, planned_y = replay.planned_distance
    fate = f"FELL at {replay.fall_time:.2f} s" if replay.fell else "stays up"
    servos = {
        ("ideal", False): "ideal servos",
        ("model", True): "modelled servos, feed-forward",
        ("model", False): "modelled servos",
    }[replay.servo, replay.feed_forward]
    if replay.command_clipped_joint is not None:
        servos += (
            f" (commands clipped by up to {replay.command_clipped_deg:.1f} deg at the limit of "
            f"{replay.command_clipped_joint})"
        )
    return (
        f"{replay.engine} {replay.version}, {servos}: {fate}; displacement ({x:+.3f}, {y:+.3f}) m, "
        f"planned ({planned_x:+.3f}, {planned_y:+.3f}) m, yaw error "
        f"{replay.yaw_error_deg:+.2f} deg, largest tilt {replay.max_tilt_deg:.1f} deg, "
        f"sole slip {1e3 * replay.sole_slip_max:.1f} mm, "
        f"joint error {replay.joint_error_rms_deg:.2f} deg RMS, longest torque saturation "
        f"{1e3 * replay.torque_saturation:.0f} ms; computing time {replay.wall_seconds:.1f} s"
    )
