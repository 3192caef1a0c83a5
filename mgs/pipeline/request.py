"""From a robot and a gait as a user names them to a motion; `mgs.generate` and `mgs generate`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mgs.core.errors import ConfigError
from mgs.core.progress import Progress
from mgs.gait import Gait, load_gait
from mgs.motion import Motion
from mgs.pipeline.generate import Generated
from mgs.pipeline.generate import generate as run
from mgs.robot import Robot, load_robot


@dataclass(frozen=True, eq=False)
class Request:
    """A robot and the gait that it shall perform, both read and checked for themselves."""

    robot: Robot
    gait: Gait  # names the robot
    name: str  # of the gait, for the motion file
    source: str  # of the gait, for messages

    def generate(self, progress: Progress | None = None) -> Generated:
        """The motion; raises the errors of `mgs.pipeline.generate`, naming the gait's source."""
        try:
            return run(self.robot, self.gait, self.name, progress)
        except ConfigError as error:  # a stage knows the key, not the file that it came from
            problems = [f"{error.source}: {problem}" for problem in error.problems]
            raise ConfigError(self.source, problems) from error


def request(
    robot: Robot | str | Path | None,
    gait: Gait | str | Path,
    assignments: tuple[str, ...] = (),
    **settings: object,
) -> Request:
    """Read robot and gait; see `mgs.gait.load_gait` for assignments and settings.

    Args:
        robot: a robot, the name of one that ships or a robot folder; None: the gait's own.
        gait: a gait, the name of one that ships or a gait file.
        assignments: changes of the gait as `dotted.key=value`.
        settings: changes of the gait, values by key.

    Raises:
        ConfigError: a file is missing or malformed, a value is out of range, or neither the
            argument nor the gait names a robot.
        TypeError: an argument has a wrong type.
    """
    given = None if robot is None else load_robot(robot)
    if given is not None:
        settings["robot"] = given.spec.name if given is robot else str(robot)
    wanted = load_gait(gait, assignments, **settings)
    source, name = _called(gait, wanted)
    if wanted.robot is None:
        remedy = "give it in the gait file, with --robot or as an argument of mgs.generate"
        raise ConfigError(source, f"robot: missing; {remedy}")
    return Request(given or load_robot(wanted.robot), wanted, name, source)


def _called(given: Gait | str | Path, gait: Gait) -> tuple[str, str]:
    """What messages and what the motion file call a gait."""
    if not isinstance(given, str | Path):
        return f"{gait.motion} gait", gait.motion
    # a file name may be no text, what a motion file holds is
    return str(given), Path(given).stem.encode("utf-8", "replace").decode()


def generate(
    robot: Robot | str | Path | None = None,
    gait: Gait | str | Path | None = None,
    *,
    progress: Progress | None = None,
    **settings: object,
) -> Motion:
    """The motion of any gait, a sequence too, on any robot.

    Args:
        robot: a Robot, the name of one that ships (`melson`) or the path of a robot folder;
            None: the robot that the gait names.
        gait: a gait, the name of one that ships (`melson/walk_5cm`) or the path of a gait file.
        progress: called with work done and work in all.
        settings: changes of single values of the gait. `walk__n_steps=6`, `walk={"n_steps": 6}`
            and `**{"walk.n_steps": 6}` all do what `--set walk.n_steps=6` does on the command line.

    Raises:
        ConfigError: a file is missing or malformed, or a value is unknown or out of range.
        InfeasibleGaitError: the robot cannot do it.
        TypeError: an argument has a wrong type.

    Example:
        mgs.generate("melson", "melson/walk_practical", walk__n_steps=6)
    """
    if gait is None:
        raise TypeError("a gait is needed: mgs.generate(robot, gait) or mgs.generate(gait=gait)")
    return request(robot, gait, (), **settings).generate(progress).motion
