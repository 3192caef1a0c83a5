"""The command mgs repair."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mgs.cli.colour import bad, good
from mgs.cli.common import force_option, json_option, print_json, say, with_progress
from mgs.cli.foreign_options import either_of, foreign_argument, foreign_options

if TYPE_CHECKING:
    from mgs.judge.recorded import Choices
    from mgs.search.repair import Repaired

# of the figures: what they are called, their unit, and what they are multiplied by to have it
ROWS = {
    "penetration": ("soles below the floor", "mm", 1e3),
    "slip": ("slip of a sole that bears", "mm/s", 1e3),
    "range_excess": ("joint outside its range", "mrad", 1e3),
    "speed_ratio": ("fastest joint, of its limit", "", 1.0),
    "zmp_outside": ("time with the ZMP outside", "%", 1e2),
    "zmp_distance": ("ZMP outside by", "mm", 1e3),
    "jitter": ("jitter of a joint", "mrad", 1e3),
}


@click.command()
@foreign_argument
@foreign_options
@click.option(
    "-o", "--output", metavar="FILE.mcap", required=True,
    type=click.Path(dir_okay=False, path_type=Path), help="Motion file to write.",
)  # fmt: skip
@force_option
@json_option
@click.pass_context
def repair(
    ctx: click.Context,
    file: Path,
    robot: str | None,
    layout: str | None,
    choices: Choices,
    output: Path,
    force: bool,
    as_json: bool,
) -> None:
    """Make the nearest motion that holds of a motion that does not.

    Reads FILE, a motion file (MCAP) or a file that mgs import reads, and writes a motion file. In
    the new motion soles stand still and level on the floor, joints keep their ranges and speeds,
    the zero-moment point (ZMP) is inside the soles, and nothing trembles. All samples are solved
    for at once, as near to the given motion as possible. Only motions on the soles, on a level
    floor, can be repaired. Torques and collisions are not looked at: mgs audit does so afterwards.

    Prints the figures before and after. Exit code 1 if one of them is still beyond its goal; the
    file is written all the same.

    \b
    Examples:
      mgs repair dance.csv --robot robots/g1 --fps 30 -o dance.mcap
      mgs repair walk.mcap -o walk_repaired.mcap && mgs audit walk_repaired.mcap
    """  # noqa: D301
    import mgs
    from mgs.core.atomic_files import refuse_taken
    from mgs.judge.recorded import motion_of
    from mgs.motion_file import write_motion
    from mgs.search.repair import repair as run

    refuse_taken(output, force)
    found, placed, _ = either_of(file, robot, layout, choices)
    result = with_progress(file.name, lambda bar: run(placed.given, bar))
    notes = (*placed.notes, "changed by mgs repair")
    changed = dataclasses.replace(placed, given=result.motion, notes=notes)
    write_motion(
        motion_of(changed, found, file.name, mgs.__version__, output.stem), output, force=force
    )
    if as_json:
        print_json({"file": str(output), "source": str(file), **result.to_dict()})
    else:
        _print(result, output)
    ctx.exit(1 if result.left else 0)


def _print(result: Repaired, output: Path) -> None:
    from mgs.search.repair import GOALS

    say(click.format_filename(output))
    before, after = vars(result.before), vars(result.after)
    for name, (title, unit, factor) in ROWS.items():
        goal = f"goal {factor * GOALS[name]:g}" if name in GOALS else ""
        mark = bad("FAIL") if name in result.left else good("ok  ") if name in GOALS else "    "
        figures = f"{factor * before[name]:9.2f} -> {factor * after[name]:7.2f} {unit}"
        say(f"{mark} {title:28s} {figures:28s} {goal}".rstrip())
    say(f"     links are {1e3 * result.moved:.1f} mm (RMS) from where they were")
