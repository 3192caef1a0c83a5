"""Options of exports that several commands share."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mgs.cli.common import FiniteRange

if TYPE_CHECKING:
    from mgs.motion_file.formats import Options
    from mgs.robot.orders import Links, Order

input_file = click.Path(exists=True, dir_okay=False, path_type=Path)


@dataclass(frozen=True)
class Choice:
    """What a user chose, as the command line has it."""

    fps: float | None
    joints: str | None
    order: Order | None
    links: Links
    motors: Path | None
    unit: Path | None
    feed_forward: bool
    approach: float | None
    tolerance_deg: float | None

    def options(self, name: str) -> Options:
        """Options for the format of this name.

        Raises:
            ConfigError: the format does not use one that is given, or a file is malformed.
        """
        from mgs.motion_file.formats import Options
        from mgs.robot import read_motors

        used = self._used(name)
        return Options(
            joints=None if self.joints is None else _joint_names(self.joints),
            order=self.order,
            links=self.links,
            motors=None if self.motors is None else read_motors(self.motors),
            motors_file=str(self.motors or ""),
            approach=used.get("approach", Options.approach),
            tolerance=used.get("tolerance", Options.tolerance),
        )

    def _used(self, name: str) -> dict[str, float]:
        """Options that only some formats use, as far as they are given."""
        from mgs.core.errors import ConfigError
        from mgs.motion_file.formats import FORMATS

        given = {}
        if self.approach is not None:
            given["approach"] = self.approach
        if self.tolerance_deg is not None:
            given["tolerance"] = math.radians(self.tolerance_deg)
        for option in given:
            if option not in FORMATS[name].uses:
                users = [other for other, entry in FORMATS.items() if option in entry.uses]
                raise ConfigError(
                    f"--{option}",
                    f"format {name} does not use it, only {', '.join(users)}; leave the option out",
                )
        return given


def _joint_names(text: str) -> tuple[str, ...]:
    """Names of joints in a text, or in the file that it names after @."""
    if text.startswith("@"):
        from mgs.core.input_files import read_text

        return tuple(read_text(Path(text[1:]), kind="a list of joints").replace(",", "\n").split())
    return tuple(name.strip() for name in text.split(",") if name.strip())


OPTIONS = (
    click.option(
        "--fps", type=FiniteRange(min=0.0, min_open=True),
        help="Frames per second [Hz]. Default: the rate that readers of the format expect, else "
        "the planned samples.",
    ),
    click.option(
        "--joints", metavar="NAMES",
        help="Names of the joints to write, separated by commas, in this order; or @FILE with one "
        "name per line. Default: all joints in the order of the format.",
    ),
    click.option(
        "--order", type=click.Choice(["depth-first", "breadth-first"]),
        help="Order of joints and links: depth-first as MuJoCo counts them, breadth-first as Isaac "
        "Lab does. Default: the order that the format is defined with.",
    ),
    click.option(
        "--links", type=click.Choice(["moving", "all"]), default="moving", show_default=True,
        help="Links to write: moving ones, into which fixed links are merged, or all links of the "
        "URDF.",
    ),
    click.option(
        "--motors", metavar="FILE.yaml", type=input_file,
        help="Motors on the bus: id, direction, zero and model for each joint, with the keys mgs "
        "and motors. Default: motors of robot.yaml.",
    ),
    click.option(
        "--unit", metavar="FILE.yaml", type=input_file,
        help="Corrections of one physical robot: zero, sign, scale, backlash and stiffness of its "
        "joints. Default: none.",
    ),
    click.option(
        "--feed-forward", is_flag=True,
        help="Write commands that compensate the position error of the servos of robot.yaml under "
        "load, instead of the planned angles.",
    ),
    click.option(
        "--approach", metavar="S", type=FiniteRange(0.1, 60.0),
        help="Time to the first frame [s], for op3-action, bitbots, nubots and naoqi, whose "
        "players begin in any posture. Default: 2.",
    ),
    click.option(
        "--tolerance", "tolerance_deg", metavar="DEG", type=FiniteRange(0.01, 30.0),
        help="Distance of joints from lines between keyframes [deg], for op3-action. Default: 0.5.",
    ),
)  # fmt: skip


def export_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the options of exports, packed into its argument `choice`."""

    @functools.wraps(command)
    def packed(**values: Any) -> Any:
        chosen = {name: values.pop(name) for name in Choice.__dataclass_fields__}
        return command(choice=Choice(**chosen), **values)

    wrapped: Callable[..., Any] = packed
    for option in reversed(OPTIONS):
        wrapped = option(wrapped)
    return wrapped
