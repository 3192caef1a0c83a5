"""mgs validate and mgs replay."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mgs.cli.common import FiniteRange, json_option, motion_argument, print_json, with_progress
from mgs.errors import ConfigError

if TYPE_CHECKING:
    from mgs.checks import Check
    from mgs.motion import Motion
    from mgs.sim import EngineName, Replay, Settings


@click.command()
@motion_argument
@click.option(
    "--physics", metavar="ENGINES",
    help="pybullet, mujoco, both with a comma, or none; default: every engine present.",
)  # fmt: skip
@json_option
@click.pass_context
def validate(ctx: click.Context, file: Path, physics: str | None, as_json: bool) -> None:
    """Judge a motion: static checks and an open-loop replay in physics.

    Exit code 0 when nothing fails, 1 when anything does.

    \b
    Examples:
      mgs validate walk.mcap
      mgs validate walk.mcap --physics none --json
    """  # noqa: D301
    from mgs.checks import check_motion
    from mgs.motion_file import read_motion
    from mgs.verdict import judge

    engines = _engines(physics)
    motion = read_motion(file)
    checks = with_progress("static checks", lambda bar: check_motion(motion, bar))
    replays = [_replay(motion, engine, None) for engine in engines]
    verdict = judge(str(file), checks, replays)
    if as_json:
        print_json(verdict.to_dict())
    else:
        for check in verdict.checks:
            click.echo(_line(check))
        for replay in replays:
            click.echo(_sentence(replay))
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
@json_option
@click.pass_context
def replay(
    ctx: click.Context,
    file: Path,
    engine: EngineName | None,
    step: float | None,
    iterations: int | None,
    friction: float | None,
    as_json: bool,
) -> None:
    """Execute a motion open loop in one physics engine and measure it.

    Exit code 1 when the robot falls.

    \b
    Examples:
      mgs replay walk.mcap
      mgs replay walk.mcap --engine mujoco --friction 0.5 --json
    """  # noqa: D301
    import dataclasses

    from mgs.motion_file import read_motion
    from mgs.sim import DEFAULTS

    name = engine or _engines(None)[0]
    changes = {"dt": step, "iterations": iterations, "friction": friction}
    given = {key: value for key, value in changes.items() if value is not None}
    settings = dataclasses.replace(DEFAULTS[name], **given)  # type: ignore[arg-type]
    result = _replay(read_motion(file), name, settings)
    if as_json:
        print_json(result.to_json())
    else:
        click.echo(_sentence(result))
    ctx.exit(1 if result.fell else 0)


def _engines(physics: str | None) -> list[EngineName]:
    """Engines asked for, or all that are installed."""
    from mgs.errors import SimulationError
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


def _replay(motion: Motion, engine: EngineName, settings: Settings | None) -> Replay:
    from mgs.sim import replay as run

    return with_progress(engine, lambda bar: run(motion, engine, settings, bar))


def _line(check: Check) -> str:
    mark = "ok  " if check.ok else "FAIL"
    time = "" if check.time is None else f"  at {check.time:.2f} s"
    where = f"  {check.where}" if check.where else ""
    figure = f"{check.value:.4g} {check.unit} (limit {check.limit:.4g})"
    return f"{mark} {check.name:22s} {figure}{time}{where}"


def _sentence(replay: Replay) -> str:
    x, y = replay.distance
    planned_x, planned_y = replay.planned_distance
    fate = f"FELL at {replay.fall_time:.2f} s" if replay.fell else "stays up"
    return (
        f"{replay.engine} {replay.version}: {fate}; went ({x:+.3f}, {y:+.3f}) m, "
        f"plan ({planned_x:+.3f}, {planned_y:+.3f}) m, yaw {replay.yaw_error_deg:+.2f} deg off; "
        f"tilt up to {replay.max_tilt_deg:.1f} deg, slip {1e3 * replay.sole_slip_max:.1f} mm, "
        f"joints {replay.joint_error_rms_deg:.2f} deg rms, "
        f"saturated {1e3 * replay.torque_saturation:.0f} ms; {replay.wall_seconds:.1f} s"
    )
