"""The commands mgs info and mgs plot."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click

from mgs.cli.common import force_option, json_option, motion_argument, print_json


@click.command()
@motion_argument
@json_option
def info(file: Path, as_json: bool) -> None:
    """Print the contents and the origin of a motion file.

    Prints robot, gait, solver with its parameters, duration, topics and attachments of FILE.mcap,
    and the physics engines that are installed or missing here. Writes no file.

    \b
    Example:
      mgs info walk.mcap
    """  # noqa: D301
    from mgs.core.engines import engine_versions, missing_engines
    from mgs.motion_file import read_info

    content = read_info(file)
    engines, missing = engine_versions(), missing_engines()
    if as_json:
        absent = [engine.to_dict() for engine in missing]
        print_json({**content, "engines": engines, "engines_missing": absent})
        return
    for key, value in content.items():
        if isinstance(value, dict):
            click.echo(f"{key}:")
            for name, entry in value.items():
                click.echo(f"  {name}: {entry}")
        elif isinstance(value, list):
            click.echo(f"{key}:")
            for entry in value:
                click.echo("  " + ", ".join(str(part) for part in entry.values()))
        else:
            click.echo(f"{key}: {click.format_filename(str(value))}")
    told = ", ".join(f"{name} {version}" for name, version in engines.items())
    click.echo(f"engines: {told or 'none'}")
    for engine in missing:
        click.echo(engine)


@click.command()
@motion_argument
@click.option(
    "-o", "--output", type=click.Path(file_okay=False, path_type=Path),
    help="Folder for the pictures. Default: path of FILE.mcap without the ending .mcap.",
)  # fmt: skip
@click.option(
    "--format", "fmt", type=click.Choice(["png", "svg"]), default="png", show_default=True,
    help="Format of the pictures.",
)  # fmt: skip
@force_option
@json_option
def plot(
    file: Path, output: Path | None, fmt: Literal["png", "svg"], force: bool, as_json: bool
) -> None:
    """Plot footsteps, zero-moment point (ZMP), centre of mass and joints of a motion.

    Reads FILE.mcap and writes several pictures; joint positions, speeds and torques are shown with
    their limits.

    \b
    Example:
      mgs plot walk.mcap -o plots
    """  # noqa: D301
    from mgs.motion_file import read_motion
    from mgs.report import plot_motion

    motion = read_motion(file)
    paths = plot_motion(motion, output or file.with_suffix(""), fmt, force=force)
    if as_json:
        print_json({"file": str(file), "plots": [str(path) for path in paths]})
    else:
        for path in paths:
            click.echo(click.format_filename(path))
