"""Options of the commands that read motions of others."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mgs.cli.common import FiniteRange

if TYPE_CHECKING:
    from mgs.judge.recorded import Choices, Placed
    from mgs.motion import Motion

foreign_argument = click.argument(
    "file", metavar="FILE", type=click.Path(exists=True, path_type=Path)
)
robot_option = click.option(
    "--robot", metavar="ROBOT", help="Name of a shipped robot, or path of a robot folder."
)
layout_option = click.option(
    "--layout", metavar="NAME",
    help="Layout of the file, see mgs export --help for their names; joint-table is a CSV with a "
    "head line of a time and names of joints. Default: found out.",
)  # fmt: skip
fps_option = click.option(
    "--fps",
    type=FiniteRange(0.0, min_open=True),
    help="Frames per second, if the file states none.",
)
order_option = click.option(
    "--order", type=click.Choice(["depth-first", "breadth-first"]),
    help="Order of joints that the file does not name. Default: that of the layout.",
)  # fmt: skip
quaternion_option = click.option(
    "--quaternion", type=click.Choice(["xyzw", "wxyz"]),
    help="Order of the numbers of the base's quaternions. Default: the one in which the robot "
    "stands.",
)  # fmt: skip


def foreign_options(command: Any) -> Any:
    """All of them, for one command."""
    for option in (quaternion_option, order_option, fps_option, layout_option, robot_option):
        command = option(command)
    return command


def choices_of(fps: float | None, order: str | None, quaternion: str | None) -> Choices:
    """What the user says of a file."""
    from mgs.judge.recorded import Choices

    return Choices(fps=fps, order=order, quaternion=quaternion)  # type: ignore[arg-type]


def placed_of(
    file: Path, robot: str | None, layout: str | None, choices: Choices
) -> tuple[str, Placed]:
    """The motion of a foreign file and its layout.

    Raises:
        ConfigError: the robot is not given, or the file cannot be read.
    """
    from mgs.core.errors import ConfigError
    from mgs.core.plugins import unknown_name
    from mgs.judge.recorded import layouts, read_placed
    from mgs.robot import load_robot

    if robot is None:
        raise ConfigError(
            "--robot", f"{file} does not say whose motion it is; name a robot or its folder"
        )
    if layout is not None and layout not in layouts():
        raise ConfigError(
            "--layout", unknown_name(layout, layouts()).replace("is not installed", "is unknown")
        )
    return read_placed(file, load_robot(robot), layout, choices)


def read_own(file: Path, robot: str | None, choices: Choices) -> Motion:
    """The motion of a motion file, which leaves nothing to choose.

    Raises:
        ConfigError: the user says of it what it says itself, or names another robot.
        MotionFileError: it is damaged.
    """
    from mgs.core.errors import ConfigError
    from mgs.motion_file import read_motion
    from mgs.robot import load_robot

    motion = read_motion(file)
    for name in ("fps", "order", "quaternion"):
        if getattr(choices, name) is not None:
            raise ConfigError(
                f"--{name}", f"{file} is a motion file, which states it; leave the option out"
            )
    own = motion.robot.spec.name
    if robot is not None and (other := load_robot(robot).spec.name) != own:
        raise ConfigError(
            "--robot", f"{file} is a motion of robot {own}, not of {other}; leave the option out"
        )
    return motion
