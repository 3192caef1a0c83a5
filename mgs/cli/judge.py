"""mgs validate and mgs replay."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from mgs.cli.common import (
    FiniteRange,
    ProgressBar,
    json_option,
    motion_argument,
    print_json,
    with_progress,
)
from mgs.core.errors import ConfigError

if TYPE_CHECKING:
    from mgs.judge.monte_carlo import Robustness
    from mgs.judge.motion_checks import Check
    from mgs.motion import Motion
    from mgs.sim import Agreement, EngineName, Replay, ServoName, Settings
    from mgs.sim.conditions import Conditions

F = TypeVar("F", bound=Callable[..., Any])


def servo_option_of(default: str) -> Callable[[F], F]:
    """The option --servo with a default."""
    return click.option(
        "--servo", type=click.Choice(["ideal", "model"]), default=default,
        help=f"Ideal servos, or those that robot.yaml describes. Default: {default}.",
    )  # fmt: skip


servo_option = servo_option_of("ideal")
feed_forward_option = click.option(
    "--feed-forward/--no-feed-forward", default=None,
    help="Tell modelled servos what makes up for their droop, or the planned angles. Default: yes.",
)  # fmt: skip


@click.command()
@motion_argument
@click.option(
    "--physics", metavar="ENGINES",
    help="pybullet, mujoco, both with a comma, or none; default: every engine present.",
)  # fmt: skip
@servo_option
@feed_forward_option
@click.option(
    "--monte-carlo", "n_draws", metavar="N", type=click.IntRange(1, 100_000),
    help="Also replay N times with robot, servos and floor not quite as planned.",
)  # fmt: skip
@click.option(
    "--ranges", type=click.Choice(["wide", "lab"]), default="wide",
    help="How far they stray; lab: half as far as wide. Default: wide.",
)  # fmt: skip
@click.option("--seed", type=click.IntRange(0), default=0, help="Of the draws. Default: 0.")
@click.option("--workers", type=click.IntRange(1, 1024), default=1, help="Processes. Default: 1.")
@click.option(
    "--sample", metavar="K", type=click.IntRange(0),
    help="Replay draw K alone instead of the plan's conditions.",
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
    """Judge a motion: static checks and an open-loop replay in physics.

    With --monte-carlo at least 95 % of the draws have to survive: friction, slope, bumps, masses,
    CoM, servo gains, supply, latency and joint zeros differ from the plan's. Exit code 0 when
    nothing fails, 1 when anything does.

    \b
    Examples:
      mgs validate walk.mcap
      mgs validate walk.mcap --physics none --json
      mgs validate walk.mcap --servo model
      mgs validate walk.mcap --monte-carlo 200 --ranges wide --workers 4
      mgs validate walk.mcap --sample 17
    """  # noqa: D301
    from mgs.judge.monte_carlo import summary, survival_check
    from mgs.judge.motion_checks import check_motion
    from mgs.judge.verdict import judge
    from mgs.motion_file import read_motion
    from mgs.robot import servos_of
    from mgs.sim.conditions import RANGES, draw

    engines = engines_of(physics)
    check_servo(servo, feed_forward)
    motion = read_motion(file)
    if servo == "model":
        servos_of(motion.robot)  # before the checks take their time
    checks = with_progress("static checks", lambda bar: check_motion(motion, bar))
    conditions = None if sample is None else draw(motion, RANGES[ranges], seed, sample)
    replays = [_replay(motion, engine, None, servo, feed_forward, conditions) for engine in engines]
    found = []
    if n_draws is not None:
        options = {"n": n_draws, "seed": seed, "ranges": ranges, "servo": servo, "workers": workers}
        found = [_monte_carlo(motion, engine, options) for engine in engines]
    checks += [survival_check(result) for result in found]
    verdict = judge(str(file), checks, replays, summary(found))
    if as_json:
        print_json(verdict.to_dict())
    else:
        for check in verdict.checks:
            click.echo(_line(check))
        for replay in replays:
            click.echo(_sentence(replay))
        if (agreed := verdict.agreement) is not None:
            click.echo(_agreement(agreed))
        for result in found:
            click.echo(_survival(result))
        if not engines:
            click.echo("no physics: nothing is said about falling")
        failed = [check.name for check in verdict.checks if not check.ok]
        click.echo(f"FAIL: {', '.join(failed)}" if failed else "PASS")
    ctx.exit(0 if verdict.passed else 1)


@click.command()
@motion_argument
@click.option(
    "--engine", type=click.Choice(["pybullet", "mujoco"]), help="Default: pybullet where present."
)
@click.option("--step", type=FiniteRange(1e-5, 0.01), help="Simulation step [s].")
@click.option("--iterations", type=click.IntRange(1, 10_000), help="Of the contact solver.")
@click.option("--friction", type=FiniteRange(0.0, 10.0), help="Of soles on the ground.")
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
    """Execute a motion open loop in one physics engine and measure it.

    Exit code 1 when the robot falls.

    \b
    Examples:
      mgs replay walk.mcap
      mgs replay walk.mcap --engine mujoco --friction 0.5 --json
      mgs replay walk.mcap --servo model --no-feed-forward
    """  # noqa: D301
    import dataclasses

    from mgs.motion_file import read_motion
    from mgs.sim import DEFAULTS

    check_servo(servo, feed_forward)
    name = engine or engines_of(None)[0]
    changes = {"dt": step, "iterations": iterations, "friction": friction}
    given = {key: value for key, value in changes.items() if value is not None}
    settings = dataclasses.replace(DEFAULTS[name], **given)  # type: ignore[arg-type]
    result = _replay(read_motion(file), name, settings, servo, feed_forward)
    if as_json:
        print_json(result.to_json())
    else:
        click.echo(_sentence(result))
    ctx.exit(1 if result.fell else 0)


def engines_of(physics: str | None) -> list[EngineName]:
    """Engines asked for, or all that are installed."""
    from mgs.core.errors import SimulationError
    from mgs.sim import ENGINES, available_engines

    if physics == "none":
        return []
    if physics is None:
        if not available_engines():
            raise SimulationError("no physics engine is installed; install mujoco or pybullet")
        return list(available_engines())
    asked = [name.strip() for name in physics.split(",")]
    unknown = [name for name in asked if name not in ENGINES]
    if unknown or len(set(asked)) != len(asked):
        raise ConfigError("--physics", f"{physics!r}; use {', '.join(ENGINES)}, or none")
    return [engine for engine in ENGINES if engine in asked]


def check_servo(servo: ServoName, feed_forward: bool | None) -> None:
    """Raise ConfigError for feed-forward to servos that have no use for it."""
    if feed_forward and servo == "ideal":
        raise ConfigError("--feed-forward", "an ideal servo has no droop; add --servo model")


def _replay(
    motion: Motion,
    engine: EngineName,
    settings: Settings | None,
    servo: ServoName,
    feed_forward: bool | None,
    conditions: Conditions | None = None,
) -> Replay:
    from mgs.sim import replay as run

    return with_progress(
        engine,
        lambda bar: run(
            motion,
            engine,
            settings,
            bar,
            servo=servo,
            feed_forward=feed_forward,
            conditions=conditions,
        ),
    )


def _line(check: Check) -> str:
    mark = "ok  " if check.ok else "FAIL"
    time = "" if check.time is None else f"  at {check.time:.2f} s"
    where = f"  {check.where}" if check.where else ""
    figure = f"{check.value:.4g} {check.unit} (limit {check.limit:.4g})"
    return f"{mark} {check.name:22s} {figure}{time}{where}"


def _monte_carlo(motion: Motion, engine: EngineName, options: dict[str, Any]) -> Robustness:
    from mgs.judge.monte_carlo import monte_carlo

    def work(bar: ProgressBar) -> Robustness:
        return monte_carlo(motion, engine, progress=bar, **options)

    return with_progress(f"{engine}, {options['n']} draws", work)


def _survival(found: Robustness) -> str:
    figures = found.to_dict()
    low, high = found.interval
    text = (
        f"{found.engine}, {found.servo} servos, ranges {found.ranges}, seed {found.seed}: "
        f"{found.survived} of {found.n} draws survive, 95 % interval {low:.3f} to {high:.3f}"
    )
    worst = figures["offenders"]
    if isinstance(worst, list) and worst:
        told = (f"{o['parameter']} ({o['probability']:.2f})" for o in worst[:3])
        text += f"; falls go with {', '.join(told)}"
    return text


def _agreement(found: Agreement) -> str:
    apart = (
        f"loads on the soles {100.0 * found.load:.0f} % of the weight and ZMP "
        f"{1e3 * found.zmp:.1f} mm rms, tilt {found.tilt_deg:.1f} deg, "
        f"end {1e3 * found.end_position:.1f} mm and {found.end_yaw_deg:.1f} deg"
    )
    fate = "" if found.same_fate else "; they DISAGREE on whether it falls"
    return f"{' and '.join(found.engines)} differ by: {apart}{fate}"


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
            f" (cut by up to {replay.command_clipped_deg:.1f} deg at the limit of "
            f"{replay.command_clipped_joint})"
        )
    return (
        f"{replay.engine} {replay.version}, {servos}: {fate}; went ({x:+.3f}, {y:+.3f}) m, "
        f"plan ({planned_x:+.3f}, {planned_y:+.3f}) m, yaw {replay.yaw_error_deg:+.2f} deg off; "
        f"tilt up to {replay.max_tilt_deg:.1f} deg, slip {1e3 * replay.sole_slip_max:.1f} mm, "
        f"joints {replay.joint_error_rms_deg:.2f} deg rms, "
        f"saturated {1e3 * replay.torque_saturation:.0f} ms; {replay.wall_seconds:.1f} s"
    )
