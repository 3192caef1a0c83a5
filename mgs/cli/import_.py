"""The command mgs import."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mgs.cli.common import force_option, json_option, print_json, say
from mgs.cli.foreign_options import foreign_argument, foreign_options, placed_of

if TYPE_CHECKING:
    from mgs.judge.recorded import Choices


@click.command(name="import")
@foreign_argument
@foreign_options
@click.option(
    "-o", "--output", metavar="FILE.mcap", type=click.Path(dir_okay=False, path_type=Path),
    help="Motion file to write. Default: path of FILE with the ending .mcap.",
)  # fmt: skip
@force_option
@json_option
def import_(
    file: Path,
    robot: str | None,
    layout: str | None,
    choices: Choices,
    output: Path | None,
    force: bool,
    as_json: bool,
) -> None:
    """Make a motion file of somebody else's motion.

    Reads FILE, a table, an archive or a folder in one of the layouts that mgs export writes, or a
    CSV table with a time and named joints. Layout and order of quaternions are found out by how the
    robot stands, and told; where two fit, the command asks for the choice. If the file has joints
    only, the base is found from the contacts of the soles.

    mgs validate, replay, plot, report and info then work on the motion file. Since nobody has
    planned the motion, checks of how well a plan is followed are not made. mgs audit says what is
    wrong with a motion, mgs repair mends it.

    Exit code 2 if the file cannot be read, or leaves a choice open.

    \b
    Examples:
      mgs import dance.csv --robot robots/g1 --fps 30 -o dance.mcap
      mgs import walk.npz --robot melson
      mgs import walk.csv --robot melson --layout unitree-csv --fps 50 --quaternion wxyz
    """  # noqa: D301
    import mgs
    from mgs.core.atomic_files import refuse_taken
    from mgs.judge.recorded import motion_of
    from mgs.motion_file import write_motion

    path = output or file.with_suffix(".mcap")
    refuse_taken(path, force)
    found, placed = placed_of(file, robot, layout, choices)
    motion = motion_of(placed, found, file.name, mgs.__version__, file.stem)
    write_motion(motion, path, force=force)
    if as_json:
        print_json(
            {
                "file": str(path),
                "source": str(file),
                "layout": found,
                "robot": motion.robot.spec.name,
                "samples": motion.n_samples,
                "dt": motion.dt,
                "duration": motion.duration,
                "balanced": motion.gait.is_balanced,
                "base": placed.base,
                "notes": list(placed.notes),
            }
        )
        return
    say(
        f"{click.format_filename(path)}\n"
        f"  robot   {motion.robot.spec.name}, layout {found}\n"
        f"  motion  {motion.duration:.2f} s, {motion.n_samples} samples of {motion.dt:.6g} s"
    )
    for note in placed.notes:
        say(f"  note    {note}")
    if not motion.gait.is_balanced:
        say("  note    not on its soles all the time: no verdict on balance is given")
