"""The command mgs refine."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mgs.cli.common import (
    FiniteRange,
    ProgressBar,
    force_option,
    json_option,
    motion_argument,
    print_json,
    say,
    with_progress,
)
from mgs.cli.judge import engines_of
from mgs.cli.servo_options import check_servos, feed_forward_option, servo_option_of
from mgs.core.errors import ConfigError

if TYPE_CHECKING:
    from mgs.search.refine import Refinement, Trial
    from mgs.sim import ServoName


@click.command()
@motion_argument
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False, path_type=Path),
    help="Motion file to write. Default: FILE_refined.mcap in the folder of FILE.mcap.",
)  # fmt: skip
@click.option(
    "--physics", metavar="ENGINES",
    help="Physics engines for the replays: pybullet, mujoco or pybullet,mujoco. Default: all "
    "installed engines.",
)  # fmt: skip
@servo_option_of("model")
@feed_forward_option
@click.option(
    "--attempts", type=click.IntRange(1, 1000), default=6,
    help="Largest number of corrections to try. Default: 6.",
)  # fmt: skip
@click.option(
    "--part", type=FiniteRange(0.05, 1.0), default=0.4,
    help="Fraction of the measured deviation that the first correction removes. Default: 0.4.",
)  # fmt: skip
@force_option
@json_option
@click.pass_context
def refine(
    ctx: click.Context,
    file: Path,
    output: Path | None,
    physics: str | None,
    servo: ServoName,
    feed_forward: bool | None,
    attempts: int,
    part: float,
    force: bool,
    as_json: bool,
) -> None:
    """Correct a motion by the deviations that its replays show.

    If the robot leans away from its plan slowly and in every physics engine, the reference of its
    centre of mass is moved in the opposite direction. A correction is kept if, in every engine,
    the robot then stays up longer, fails fewer checks or tilts less. Corrections help most if
    servos get the planned angles only (--no-feed-forward) and yield under load.

    Reads FILE.mcap and writes a corrected motion file. Exit code 1, and no file, if no correction
    is an improvement.

    \b
    Examples:
      mgs refine walk.mcap
      mgs refine walk.mcap -o better.mcap --no-feed-forward --attempts 10
    """  # noqa: D301
    from mgs.core.atomic_files import refuse_taken
    from mgs.motion_file import read_motion, write_motion
    from mgs.search.refine import refine as run

    check_servos((servo,), feed_forward)
    engines = engines_of(physics)
    if not engines:
        raise ConfigError("--physics", "none is not possible, because the corrections need "
                          "replays; name pybullet or mujoco")  # fmt: skip
    path = output or file.with_name(f"{file.stem}_refined.mcap")
    refuse_taken(path, force)
    motion = read_motion(file)

    def work(bar: ProgressBar) -> Refinement:
        return run(
            motion, tuple(engines), servo=servo, feed_forward=feed_forward,
            attempts=attempts, part=part, progress=bar,
        )  # fmt: skip

    found = with_progress("replays", work)
    if found.improved:
        write_motion(found.motion, path, force=force)
    if as_json:
        print_json(
            {
                "file": str(path) if found.improved else None,
                "improved": found.improved,
                "before": [trial.to_dict() for trial in found.before],
                "after": [trial.to_dict() for trial in found.after],
                "attempts": [attempt.to_dict() for attempt in found.attempts],
            }
        )
    else:
        _print(found, path)
    ctx.exit(0 if found.improved else 1)


def _print(found: Refinement, path: Path) -> None:
    say("as planned")
    for trial in found.before:
        say(f"  {_figures(trial)}")
    for number, attempt in enumerate(found.attempts, start=1):
        fate = "kept" if attempt.kept else f"rejected: {attempt.reason}"
        say(f"correction {number}, {attempt.part:g} of the deviation: {fate}")
        for trial in attempt.trials:
            say(f"  {_figures(trial)}")
    if found.improved:
        say(f"improved motion: {click.format_filename(str(path))}")
    else:
        say("no correction is an improvement; no file was written")


def _figures(trial: Trial) -> str:
    fate = "stays up" if trial.fall_time is None else f"FELL at {trial.fall_time:.2f} s"
    failed = (
        f"; fails {', '.join(trial.failed)}" if trial.failed and trial.fall_time is None else ""
    )
    early, late = 1e3 * trial.touchdown.earliest, 1e3 * trial.touchdown.latest
    return (
        f"{trial.engine:8s} {fate}; RMS errors: tilt {trial.tilt_rms_deg:.3f} deg, CoM "
        f"{1e3 * trial.com_rms:.1f} mm, ZMP {1e3 * trial.zmp_rms:.1f} mm; "
        f"touchdown errors {early:+.0f} to {late:+.0f} ms{failed}"
    )
