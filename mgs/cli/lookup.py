"""The command mgs library lookup."""

from __future__ import annotations

from pathlib import Path

import click

from mgs.cli.common import FiniteRange, force_option, json_option, print_json, say, with_progress
from mgs.cli.layout_option import layout_option, listing
from mgs.motion_file.formats.lookup import LOOKUPS


@click.command(
    epilog=listing("Tables", LOOKUPS),
    short_help="Write the walks of a library as one table by velocity.",
)
@click.argument(
    "folder", metavar="DIR", type=click.Path(exists=True, file_okay=False, path_type=Path)
)
@click.option(
    "--format", "name", type=click.Choice(list(LOOKUPS)), metavar="NAME", required=True,
    help="Name of the table, see below.",
)  # fmt: skip
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False, path_type=Path),
    help="File to write. Default: DIR with the name and the ending of the table.",
)  # fmt: skip
@click.option(
    "--where", metavar="CONDITION", default="verdict == 'pass'", show_default=True,
    help="Condition that selects the gaits.",
)  # fmt: skip
@click.option(
    "--fps", type=FiniteRange(min=0.0, min_open=True),
    help="Frames per second [Hz], at which the period of every walk is a whole number of frames. "
    "Default: the rate that readers of the table expect.",
)  # fmt: skip
@click.option(
    "--digits", type=click.IntRange(0, 6), default=3, show_default=True,
    help="Number of digits after the point to which velocities are rounded.",
)  # fmt: skip
@click.option(
    "--joints", metavar="NAMES",
    help="Names of the joints to write, separated by commas, in this order. Default: those of the "
    "table, in its order.",
)  # fmt: skip
@layout_option(LOOKUPS)
@force_option
@json_option
def lookup(
    folder: Path,
    name: str,
    output: Path | None,
    where: str,
    fps: float | None,
    digits: int,
    joints: str | None,
    force: bool,
    as_json: bool,
) -> None:
    """Write the walks of a library as one table, from which a policy looks up by velocity.

    Each walk becomes a cycle of two steps that begins with single support on the left sole. Its
    velocity is that of the cycle, rounded to --digits.

    \b
    Examples:
      mgs library lookup outputs/speeds --format open-duck-poly
      mgs library lookup outputs/speeds --format toddlerbot-zmp --where "robot == 'mine'"
    """  # noqa: D301
    from mgs.core.atomic_files import refuse_taken
    from mgs.library.lookup import walks_of, write_lookup
    from mgs.motion_file.formats import Options

    table = LOOKUPS[name]
    path = output or folder.with_name(f"{folder.resolve().name}.{name}{table.suffix}")
    refuse_taken(path, force)
    chosen = None if joints is None else tuple(part.strip() for part in joints.split(","))
    walks = with_progress(
        "reading walks", lambda bar: walks_of(folder, where, fps or table.fps, digits, bar)
    )
    written = write_lookup(walks, path, name, Options(joints=chosen), force=force)
    velocities = sorted(walk.velocity for walk in walks)
    if as_json:
        print_json(
            {
                "file": str(path),
                "format": name,
                "walks": len(walks),
                "velocities": velocities,
                "joints": list(written.joints),
                "notes": list(written.notes),
            }
        )
        return
    say(f"{click.format_filename(path)}: {len(walks)} walks, {len(written.joints)} joints")
    for axis, unit, values in zip(
        ("vx", "vy", "wz"), ("m/s", "m/s", "rad/s"), zip(*velocities, strict=True), strict=True
    ):
        listed = ", ".join(f"{value:g}" for value in sorted(set(values)))
        say(f"  {axis}        {listed} {unit}")
    say(f"  joints    {', '.join(written.joints)}")
    for note in written.notes:
        say(f"  note      {note}")
