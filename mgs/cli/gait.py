"""The commands mgs gait list and show."""

from __future__ import annotations

import click

from mgs.cli.common import json_option, print_json, say


@click.group()
def gait() -> None:
    """List and show the shipped gait files.

    A gait file describes a motion; mgs schema gait describes its keys. To write your own, save a
    shipped one under another name and change it.

    \b
    Examples:
      mgs gait list --robot melson
      mgs gait show melson/walk_practical > my_walk.yaml
      mgs generate my_walk.yaml
    """  # noqa: D301


@gait.command("list", short_help="List the shipped gaits and what they are for.")
@click.option("--robot", metavar="NAME", help="Only gaits of this robot, and those for any robot.")
@click.option("--motion", metavar="KIND", help="Only gaits of this kind of motion, e.g. walk.")
@json_option
def list_command(robot: str | None, motion: str | None, as_json: bool) -> None:
    """List the shipped gaits: name, kind of motion and purpose.

    Gaits in the folder generic suit any robot: choose it by mgs generate --robot.

    \b
    Examples:
      mgs gait list
      mgs gait list --robot coman --motion walk
    """  # noqa: D301
    from mgs.core.errors import ConfigError
    from mgs.gait import list_gaits, load_gait
    from mgs.gait.find import about

    gaits = {name: load_gait(name) for name in list_gaits()}
    for key, value, known in (
        ("--robot", robot, {str(g.robot) for g in gaits.values() if g.robot}),
        ("--motion", motion, {g.motion for g in gaits.values()}),
    ):
        if value is not None and value not in known:
            raise ConfigError(key, f"no gait for {value!r}; known here: {', '.join(sorted(known))}")
    found = [
        {"name": name, "robot": g.robot, "motion": g.motion, "about": about(name)}
        for name, g in gaits.items()
        if (robot is None or g.robot in (robot, None)) and motion in (None, g.motion)
    ]
    if as_json:
        print_json({"gaits": found})
        return
    width = max(len(str(row["name"])) for row in found)
    for row in found:
        say(f"{row['name']:{width}s}  {row['motion']:9s}  {row['about']}")


@gait.command(short_help="Print the file of a gait.")
@click.argument("name", metavar="NAME")
def show(name: str) -> None:
    """Print the file of a gait, as a start for your own.

    \b
    Example:
      mgs gait show melson/walk_practical > my_walk.yaml
    """  # noqa: D301
    from mgs.core.input_files import read_text
    from mgs.gait import find_gait

    say(read_text(find_gait(name)), nl=False)
