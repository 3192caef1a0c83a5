"""The command mgs optimize."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from mgs.cli.colour import bad
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

if TYPE_CHECKING:
    from mgs.judge.motion_checks import Check
    from mgs.search.whole_body import Optimised

Decorated = TypeVar("Decorated", bound=Callable[..., object])
# of the figures: what they are called, their unit, and what they are multiplied by to have it
ROWS = {
    "torque_rms": ("RMS torque of all joints", "N m", 1.0),
    "lasting_torque": ("RMS torque of the hottest joint", "% of its limit", 1e2),
    "positive_work": ("positive joint work", "J", 1.0),
    "cost_of_transport": ("cost of transport", "", 1.0),
    "zmp_margin": ("least ZMP margin", "mm", 1e3),
    "joint_speed": ("fastest joint", "% of its limit", 1e2),
}


def _weight(name: str, default: float, text: str) -> Callable[[Decorated], Decorated]:
    return click.option(
        f"--{name}", type=FiniteRange(0.0, 1e6), default=default, show_default=True,
        metavar="WEIGHT", help=text,
    )  # fmt: skip


@click.command()
@motion_argument
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False, path_type=Path),
    help="Motion file to write. Default: FILE_optimized.mcap in the folder of FILE.mcap.",
)  # fmt: skip
@_weight("torque", 1.0, "Weight of the squared torques of all joints.")
@_weight("work", 0.0, "Weight of the positive work of all joints.")
@_weight("distance", 0.01, "Weight of the squared distance of all joint angles from the plan.")
@_weight("upright", 1.0, "Weight of the squared turn of the torso away from the plan.")
@click.option(
    "--hands", type=FiniteRange(0.0, 1e6), metavar="WEIGHT",
    help="Weight of the squared distance of the hands from the plan. Default: 0 for walks, kicks "
    "and sequences, 1000 for other motions.",
)  # fmt: skip
@click.option(
    "--margin", type=FiniteRange(0.0, 1.0), metavar="M",
    help="Least distance of the centre of pressure from the edge of a sole [m]. Default: the least "
    "ZMP margin of the motion, at most 0.02.",
)  # fmt: skip
@click.option(
    "--iterations", type=click.IntRange(1, 1000), default=15, show_default=True,
    help="Largest number of quadratic programs to solve, apart from 5 at most that follow if a "
    "limit is violated.",
)  # fmt: skip
@force_option
@json_option
@click.pass_context
def optimize(
    ctx: click.Context,
    file: Path,
    output: Path | None,
    torque: float,
    work: float,
    distance: float,
    upright: float,
    hands: float | None,
    margin: float | None,
    iterations: int,
    force: bool,
    as_json: bool,
) -> None:
    """Lower the torques of a finished motion.

    All samples are changed at once: joint angles, motion of the base, forces on the soles. The
    dynamics of the whole robot hold at every sample. Footsteps, times and the paths of both soles
    stay as they are, and so do the first and the last posture. The centre of pressure stays inside
    the soles that bear the robot, and joints keep their ranges, speeds and torques.

    Reads FILE.mcap and writes a motion file. It is judged by mgs validate like any other: lower
    torques often mean straighter knees and freer arms. Exit code 1 if the motion that was found
    violates a limit or fails a static check; the file is written all the same.

    \b
    Examples:
      mgs optimize walk.mcap
      mgs optimize walk.mcap -o calm.mcap --work 1 --distance 0.1
    """  # noqa: D301
    from mgs.core.atomic_files import refuse_taken
    from mgs.judge.motion_checks import check_motion
    from mgs.motion_file import read_motion, write_motion
    from mgs.search.whole_body import Weights, default_hands, optimise

    path = output or file.with_name(f"{file.stem}_optimized.mcap")
    refuse_taken(path, force)
    motion = read_motion(file)
    held = default_hands(motion) if hands is None else hands
    weights = Weights(torque, work, distance, upright, held)

    def run(bar: ProgressBar) -> Optimised:
        return optimise(motion, weights, margin=margin, iterations=iterations, progress=bar)

    found = with_progress("programs", run)
    write_motion(found.motion, path, force=force)
    failed = [check for check in check_motion(found.motion) if not check.ok]
    if as_json:
        names = [check.name for check in failed]
        print_json({"file": str(path), **found.to_dict(), "failed_checks": names})
    else:
        _print(found, path, failed)
    ctx.exit(0 if found.holds and not failed else 1)


def _print(found: Optimised, path: Path, failed: list[Check]) -> None:
    say(click.format_filename(path))
    before, after = vars(found.before), vars(found.after)
    for name, (title, unit, factor) in ROWS.items():
        if before[name] is None or after[name] is None:
            continue
        figures = f"{factor * before[name]:10.3f} -> {factor * after[name]:8.3f} {unit}"
        say(f"  {title:32s} {figures}".rstrip())
    values = found.solution.objective
    say(f"  objective {values[0]:.5g} -> {values[-1]:.5g} in {len(values) - 1} steps")
    if not found.holds:
        over = vars(found.solution.violations)
        name = max(over, key=lambda kind: over[kind])
        say(f"{bad('FAIL')} {name}: a limit is violated by {over[name]:.2g}")
    for check in failed:
        say(f"{bad('FAIL')} {check.name}: mgs validate says more")
