"""What a format of motions is: its name, how to write it and how to read it.

The module of a format has two functions:

    write(sampled: SampledMotion, path: Path, options: Options) -> Written
    read(path: Path, robot: Robot | None) -> RecordedMotion

`write` makes the file, or files in the folder, that `path` names; nothing else is there, and
whoever calls it puts the result in its place when it is complete. A format that holds no motion
which could be read back has no `read`. The docstring of the module states the layout: keys, shapes,
units, order of joints and links, order of quaternions. Users read it (`mgs export --layout NAME`).
"""

from __future__ import annotations

import contextlib
import dataclasses
import importlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from mgs.core.errors import ConfigError, MgsError
from mgs.core.plugins import unknown_name
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.recorded import RecordedMotion
from mgs.robot import Motors, MotorSpec, Robot, motors_of
from mgs.robot.orders import Links, Order, robot_order


@dataclass(frozen=True)
class Options:
    """What a user chose for one export."""

    joints: tuple[str, ...] | None = None  # in this order; None: all, in the order of the format
    order: Order | None = None  # of joints and links; None: that of the format
    links: Links = "moving"
    motors: Mapping[str, MotorSpec] | None = None  # by joint; None: those of robot.yaml
    motors_file: str = ""  # where they are from, for messages
    approach: float = 2.0  # of a player that begins in any posture, to the first frame [s]
    tolerance: float = math.radians(0.5)  # of a joint, for formats of few keyframes [rad]
    remarks: tuple[str, ...] = ()  # what the file should tell its readers, where it can

    def motors_of(self, robot: Robot, joints: Sequence[str]) -> Motors:
        """Motors of some joints of a robot, in their order.

        Raises:
            ConfigError: a joint has no motor.
        """
        given = robot.spec.motors if self.motors is None else self.motors
        chosen = {name: spec for name, spec in given.items() if name not in robot.joint_names}
        chosen |= {name: given[name] for name in joints if name in given}
        return motors_of(chosen, joints, self.motors_source(robot))

    def motors_source(self, robot: Robot) -> str:
        """File that the motors are from, for messages."""
        return robot.source if self.motors is None else self.motors_file


@dataclass(frozen=True)
class Written:
    """What a file holds, to be told to the user."""

    joints: tuple[str, ...]  # in the order of the file
    links: tuple[str, ...] = ()  # in the order of the file; empty: it has none
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Format:
    """A format of motions; the module that writes and reads it is imported when it is used."""

    name: str
    summary: str  # one line
    suffix: str  # of its files, such as ".csv"; "": a folder
    module: str
    fps: float | None = None  # that its readers expect [Hz]; None: any, so the planned samples
    closed: bool = False  # True: a cycle ends with its first frame
    resolution: float = 0.0  # of a joint angle, which it may come back wrong by [rad]
    uses: frozenset[str] = frozenset()  # of `approach` and `tolerance` in `Options`
    extra: str = ""  # of mgs, which installs the libraries that it needs

    def write(self, sampled: SampledMotion, path: Path, options: Options) -> Written:
        """Write a motion where nothing is yet.

        Raises:
            MgsError: a library that the format needs is not installed.
        """
        with self._libraries():
            written: Written = self._module().write(sampled, path, options)
        return written

    def read(
        self, path: Path, robot: Robot | None = None, order: Order | None = None
    ) -> RecordedMotion:
        """Motion in a file.

        Args:
            path: the file or folder.
            robot: whose motion it is, for formats that do not name their joints; None: unknown.
            order: of joints and links that the file does not name; None: that of the format.

        Raises:
            ConfigError, MotionFileError: the file is missing, damaged or of another layout.
            MgsError: the format cannot be read, or a library that it needs is not installed.
        """
        module = self._module()
        if not hasattr(module, "read"):
            raise MgsError(f"{path}: files of format {self.name} cannot be read, only written")
        with self._libraries():
            recorded: RecordedMotion = module.read(path, robot)
        return recorded if robot is None else with_names(recorded, robot, order)

    @property
    def readable(self) -> bool:
        """Whether its files can be read."""
        return hasattr(self._module(), "read")

    @property
    def layout(self) -> str:
        """Description of its files."""
        return (self._module().__doc__ or "").strip()

    def _module(self) -> ModuleType:
        return importlib.import_module(self.module)

    @contextlib.contextmanager
    def _libraries(self) -> Iterator[None]:
        """Say how to install a library that is missing; formats import theirs when they run."""
        try:
            yield
        except ModuleNotFoundError as error:
            library = error.name or ""
            how = f"pip install 'mgs[{self.extra}]'" if self.extra else f"pip install {library}"
            raise MgsError(
                f"format {self.name} needs {library}, which is not installed; {how} installs it"
            ) from error


def with_names(
    recorded: RecordedMotion, robot: Robot, order: Order | None = None
) -> RecordedMotion:
    """A motion with the names of a robot's joints, if it has none and as many as the robot.

    Args:
        recorded: what the file says.
        robot: whose motion it is.
        order: of joints and links without names; None: that of the layout, if it has one.
    """
    if recorded.joint_names is not None:
        ignored = () if order is None else ("the file names its joints: no order is needed",)
        return dataclasses.replace(recorded, notes=(*recorded.notes, *ignored))
    if (order := order or recorded.order) is None:
        return recorded
    names = robot_order(robot, order).joints
    if len(names) != recorded.joints.shape[1]:
        return recorded
    note = f"the joints without names are taken {order}: {', '.join(names[:2])}, ..."
    return dataclasses.replace(
        recorded, joint_names=names, order=order, notes=(*recorded.notes, note)
    )


def chosen_joints(
    robot: Robot, options: Options, order: Order | None
) -> tuple[tuple[str, ...], NDArray[np.intp]]:
    """Joints that are written, and their indices in `Robot.joint_names`.

    Args:
        robot: the robot.
        options: the user's choice.
        order: of the format; None: that of `Robot.joint_names`.

    Raises:
        ConfigError: a joint is unknown or named twice.
    """
    known = robot.joint_names
    if options.joints is not None:
        names: Sequence[str] = options.joints
        for name in names:
            if name not in known:
                raise ConfigError("joints", unknown_joint(name, robot))
        if len(set(names)) < len(names) or not names:
            raise ConfigError("joints", "name every joint once, and at least one")
    elif (how := options.order or order) is not None:
        names = robot_order(robot, how, options.links).joints
    else:
        names = known
    return tuple(names), np.array([known.index(name) for name in names], dtype=np.intp)


def unknown_joint(name: str, robot: Robot) -> str:
    """What to say of a joint that a robot does not have."""
    if name in robot.spec.locked:
        return f"{name!r} is locked in robot.yaml of {robot.spec.name}, so it has no motion"
    told = unknown_name(name, list(robot.joint_names)).replace("is not installed", "is no joint")
    return f"{told}, of robot {robot.spec.name}"
