"""Loading of robot folders, by path or by the name of a shipped robot."""

from __future__ import annotations

from pathlib import Path

from mgs.core.errors import ConfigError
from mgs.core.foreign import told_as
from mgs.core.input_files import is_file, is_inside, read_text
from mgs.core.limits import MAX_URDF
from mgs.core.shipped import shipped_folder
from mgs.core.wrong_type import wrong_type
from mgs.robot.build import build_robot
from mgs.robot.robot import Robot
from mgs.robot.spec import parse_spec


def load_robot(robot: Robot | str | Path) -> Robot:
    """Read a robot folder, or a shipped robot by name; a robot is returned as it is.

    Raises:
        ConfigError: a file is missing or malformed, or robot.yaml and URDF contradict each other.
        TypeError: `robot` is of another type.
    """
    if isinstance(robot, Robot):
        return robot
    if not isinstance(robot, str | Path):
        raise wrong_type("the robot", "a Robot, the name of a shipped robot or a folder", robot)
    folder = find_robot(robot)
    path = folder / "robot.yaml"
    with told_as(lambda what: ConfigError(path, f"no robot can be made of this folder: {what}")):
        text = read_text(path)
        spec = parse_spec(text, path)
        urdf = folder / spec.urdf
        if not is_inside(urdf, (folder, path.resolve().parent, shipped_folder("robots"))):
            raise ConfigError(path, f"urdf: {spec.urdf} is not in the robot folder; put it there")
        return build_robot(text, read_text(urdf, MAX_URDF, "a URDF"), path, spec)


def find_robot(name_or_dir: str | Path) -> Path:
    """Folder of a robot given by path or by name; raises ConfigError with the shipped names."""
    path = Path(name_or_dir)
    path = path.parent if path.name == "robot.yaml" else path
    shipped = shipped_folder("robots")
    for folder in (path, shipped / name_or_dir):
        if is_file(folder / "robot.yaml"):
            return folder
    raise ConfigError(
        name_or_dir,
        "contains no robot.yaml and is not the name of a shipped robot; shipped: "
        f"{', '.join(list_robots())}",
    )


def list_robots() -> list[str]:
    """Names of the shipped robots."""
    return sorted(path.parent.name for path in shipped_folder("robots").glob("*/robot.yaml"))
