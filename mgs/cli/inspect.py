"""The commands mgs info and mgs plot."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click

from mgs.cli.common import (
    force_option,
    json_option,
    motion_argument,
    print_json,
    say,
    with_progress,
)


@click.command()
@motion_argument
@click.option(
    "--check", is_flag=True,
    help="Judge the motion by the static checks, too, which takes about a second.",
)  # fmt: skip
@json_option
def info(file: Path, check: bool, as_json: bool) -> None:
    """Print the contents and the origin of a motion file.

    Prints robot, gait, duration, solver with the settings that it uses, topics and attachments of
    FILE.mcap, and the physics engines that are installed or missing here; with --json everything
    that is known of its making. A motion file holds no verdict: --check judges the motion by its
    static checks, mgs validate also in physics. Writes no file.

    \b
    Examples:
      mgs info walk.mcap
      mgs info walk.mcap --check
    """  # noqa: D301
    from mgs.cli.info_text import info_lines
    from mgs.core.engines import engine_versions, missing_engines
    from mgs.judge.motion_checks import check_motion
    from mgs.motion_file import read_info, read_motion

    content = read_info(file)
    checks = check_motion(read_motion(file)) if check else None
    engines, missing = engine_versions(), missing_engines()
    if as_json:
        absent = [engine.to_dict() for engine in missing]
        judged = {} if checks is None else {"static_checks": [c.to_dict() for c in checks]}
        print_json({**content, "engines": engines, "engines_missing": absent, **judged})
        return
    for text in info_lines(content, checks):
        say(click.format_filename(text))
    told = ", ".join(f"{name} {version}" for name, version in engines.items())
    say(f"engines: {told or 'none'}")
    for engine in missing:
        say(engine)


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
@click.option(
    "--strip", metavar="FILE.png", type=click.Path(dir_okay=False, path_type=Path),
    help="Write one picture instead: the robot at several instants, its tracks from above, and a "
    "title with the result of the static checks.",
)  # fmt: skip
@click.option(
    "--animate", metavar="FILE", type=click.Path(dir_okay=False, path_type=Path),
    help="Write a moving picture instead, in real time: .gif, or .mp4 if ffmpeg is installed.",
)  # fmt: skip
@force_option
@json_option
def plot(
    file: Path,
    output: Path | None,
    fmt: Literal["png", "svg"],
    strip: Path | None,
    animate: Path | None,
    force: bool,
    as_json: bool,
) -> None:
    """Plot footsteps, zero-moment point (ZMP), centre of mass and joints of a motion.

    Reads FILE.mcap and writes several pictures; joint positions, speeds and torques are shown with
    their limits, and every title has the result of the static checks. With --strip or --animate it
    writes one picture, or one moving picture, instead.

    \b
    Examples:
      mgs plot walk.mcap -o plots
      mgs plot walk.mcap --strip walk.png
      mgs plot walk.mcap --animate walk.gif
    """  # noqa: D301
    from mgs.motion_file import read_motion
    from mgs.report import plot_motion

    if strip is not None or animate is not None:
        paths = _single_pictures(file, strip, animate, force)
        _tell(file, paths, as_json)
        return
    motion = read_motion(file)
    paths = plot_motion(motion, output or file.with_suffix(""), fmt, force=force)
    _tell(file, paths, as_json)


def _tell(file: Path, paths: list[Path], as_json: bool) -> None:
    if as_json:
        print_json({"file": str(file), "plots": [str(path) for path in paths]})
    else:
        for path in paths:
            say(click.format_filename(path))


def _single_pictures(
    file: Path, strip: Path | None, animate: Path | None, force: bool
) -> list[Path]:
    """Write the pictures that are asked for by name."""
    from mgs.core.atomic_files import refuse_taken
    from mgs.core.errors import ConfigError
    from mgs.motion_file import read_motion
    from mgs.report import write_picture
    from mgs.report.animation import animate as write_animation
    from mgs.report.animation import check_output
    from mgs.report.title import static_verdict, title_line

    if strip is not None:
        if strip.suffix != ".png":
            raise ConfigError("--strip", f"{strip}: the name should end in .png")
        refuse_taken(strip, force)
    if animate is not None:
        check_output(animate, force)
    motion, paths = read_motion(file), []
    if strip is not None:
        paths.append(write_picture(motion, strip, force=force, verdict=static_verdict(motion)))
    if animate is not None:
        path, title = animate, title_line(motion)
        with_progress(
            path.name,
            lambda bar: write_animation(motion, path, title=title, force=force, progress=bar),
        )
        paths.append(path)
    return paths
