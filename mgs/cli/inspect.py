"""mgs info and mgs plot."""

from __future__ import annotations

from pathlib import Path

import click

from mgs.cli.common import force_option, json_option, motion_argument, print_json


@click.command()
@motion_argument
@json_option
def info(file: Path, as_json: bool) -> None:
    r"""Say what is in a motion file: robot, gait, solver, duration, topics, provenance.

    \b
    Example:
      mgs info walk.mcap
    """
    from mgs.motion_file import read_info

    content = read_info(file)
    if as_json:
        print_json(content)
        return
    for key, value in content.items():
        if isinstance(value, dict):
            click.echo(f"{key}:")
            for name, entry in value.items():
                click.echo(f"  {name}: {entry}")
        else:
            click.echo(f"{key}: {value}")


@click.command()
@motion_argument
@click.option(
    "-o", "--output", type=click.Path(file_okay=False, path_type=Path),
    help="Folder for the pictures; default: beside FILE.mcap, named like it.",
)  # fmt: skip
@click.option(
    "--format", "fmt", type=click.Choice(["png", "svg"]), default="png", show_default=True
)
@force_option
@json_option
def plot(file: Path, output: Path | None, fmt: str, force: bool, as_json: bool) -> None:
    r"""Draw footsteps, ZMP, CoM and joints of a motion against their limits.

    \b
    Example:
      mgs plot walk.mcap -o plots
    """
    from mgs.motion_file import read_motion
    from mgs.report import plot_motion

    motion = read_motion(file)
    paths = plot_motion(motion, output or file.with_suffix(""), fmt, force=force)
    if as_json:
        print_json({"file": str(file), "plots": [str(path) for path in paths]})
    else:
        for path in paths:
            click.echo(path)
