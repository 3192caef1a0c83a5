"""Options of the commands that read motions of others."""

from __future__ import annotations

import functools
from collections.abc import Callable
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
degrees_option = click.option(
    "--degrees", is_flag=True, help="Joint angles and speeds of a CSV table are in degrees."
)


def foreign_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command all of them, what is said of the file packed into its argument `choices`."""

    @functools.wraps(command)
    def packed(**values: Any) -> Any:
        from mgs.judge.recorded import Choices

        said = {name: values.pop(name) for name in ("fps", "order", "quaternion", "degrees")}
        return command(choices=Choices(**said), **values)

    wrapped: Callable[..., Any] = packed
    for option in (
        degrees_option, quaternion_option, order_option, fps_option, layout_option, robot_option,
    ):  # fmt: skip
        wrapped = option(wrapped)
    return wrapped


def either_of(
    file: Path, robot: str | None, layout: str | None, choices: Choices
) -> tuple[str, Placed, Motion | None]:
    """Layout and motion of a file; of a motion file also the motion as mgs has it."""
    from mgs.judge.audit import given_by
    from mgs.judge.recorded import Placed

    if file.suffix == ".mcap" and layout is None:
        motion = read_own(file, robot, choices)
        return "mgs", Placed(given_by(motion), "file", (), 0.0), motion
    return *placed_of(file, robot, layout, choices), None


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
    for name in ("fps", "order", "quaternion", "degrees"):
        if getattr(choices, name) not in (None, False):
            raise ConfigError(
                f"--{name}", f"{file} is a motion file, which states it; leave the option out"
            )
    own = motion.robot.spec.name
    if robot is not None and (other := load_robot(robot).spec.name) != own:
        raise ConfigError(
            "--robot", f"{file} is a motion of robot {own}, not of {other}; leave the option out"
        )
    return motion
