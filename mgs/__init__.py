"""Offline motion generation for humanoid robots.

A gait file passes through four stages, motion planner, trajectory planner, CoM generator and
inverse kinematics, and becomes a joint trajectory that a position-controlled robot plays back.

    import mgs

    motion = mgs.generate("melson", "melson/walk_practical", walk__n_steps=6)
    print(mgs.validate(motion))
    mgs.write_motion(motion, "walk.mcap")

This is the front door. Every function takes names, paths and objects alike: a robot is a `Robot`,
the name of one that ships or a robot folder, a gait is an object, a name or a gait file, a motion
is a `Motion` or a motion file. What a name stands for is imported when it is first used (PEP 562),
so that `import mgs` alone is instant.
"""

import importlib
import sys
from typing import TYPE_CHECKING

from mgs.core.former_paths import FormerPaths

if TYPE_CHECKING:
    from mgs.core.errors import ComNotAtRestError as ComNotAtRestError
    from mgs.core.errors import ComOutsideFeetError as ComOutsideFeetError
    from mgs.core.errors import ConfigError as ConfigError
    from mgs.core.errors import CycleError as CycleError
    from mgs.core.errors import DivergenceError as DivergenceError
    from mgs.core.errors import FootstepError as FootstepError
    from mgs.core.errors import HardwareError as HardwareError
    from mgs.core.errors import IkError as IkError
    from mgs.core.errors import InfeasibleGaitError as InfeasibleGaitError
    from mgs.core.errors import InputError as InputError
    from mgs.core.errors import JointLimitError as JointLimitError
    from mgs.core.errors import JointSpeedError as JointSpeedError
    from mgs.core.errors import LogError as LogError
    from mgs.core.errors import MgsError as MgsError
    from mgs.core.errors import MotionFileError as MotionFileError
    from mgs.core.errors import OutputExistsError as OutputExistsError
    from mgs.core.errors import SeamError as SeamError
    from mgs.core.errors import SimulationError as SimulationError
    from mgs.core.errors import ZmpMarginError as ZmpMarginError
    from mgs.gait import Gait as Gait
    from mgs.gait import list_gaits as list_gaits
    from mgs.gait import load_gait as load_gait
    from mgs.judge.validate import validate as validate
    from mgs.judge.verdict import Verdict as Verdict
    from mgs.motion import Motion as Motion
    from mgs.motion_file import read_motion as read_motion
    from mgs.motion_file import write_motion as write_motion
    from mgs.motion_file.export import export as export
    from mgs.pipeline.request import generate as generate
    from mgs.report.figures import plot as plot
    from mgs.robot import Robot as Robot
    from mgs.robot import list_robots as list_robots
    from mgs.robot import load_robot as load_robot
    from mgs.sim.replay import Replay as Replay
    from mgs.sim.replay import replay as replay

__version__ = "0.2.0.dev0"

# Where each name comes from; the imports above tell it to type checkers.
_HOMES = {
    "ComNotAtRestError": "mgs.core.errors.ComNotAtRestError",
    "ComOutsideFeetError": "mgs.core.errors.ComOutsideFeetError",
    "ConfigError": "mgs.core.errors.ConfigError",
    "CycleError": "mgs.core.errors.CycleError",
    "DivergenceError": "mgs.core.errors.DivergenceError",
    "FootstepError": "mgs.core.errors.FootstepError",
    "HardwareError": "mgs.core.errors.HardwareError",
    "Gait": "mgs.gait.Gait",
    "IkError": "mgs.core.errors.IkError",
    "InfeasibleGaitError": "mgs.core.errors.InfeasibleGaitError",
    "InputError": "mgs.core.errors.InputError",
    "JointLimitError": "mgs.core.errors.JointLimitError",
    "JointSpeedError": "mgs.core.errors.JointSpeedError",
    "LogError": "mgs.core.errors.LogError",
    "MgsError": "mgs.core.errors.MgsError",
    "Motion": "mgs.motion.Motion",
    "MotionFileError": "mgs.core.errors.MotionFileError",
    "OutputExistsError": "mgs.core.errors.OutputExistsError",
    "Replay": "mgs.sim.replay.Replay",
    "Robot": "mgs.robot.Robot",
    "SeamError": "mgs.core.errors.SeamError",
    "SimulationError": "mgs.core.errors.SimulationError",
    "Verdict": "mgs.judge.verdict.Verdict",
    "ZmpMarginError": "mgs.core.errors.ZmpMarginError",
    "export": "mgs.motion_file.export.export",
    "generate": "mgs.pipeline.request.generate",
    "list_gaits": "mgs.gait.list_gaits",
    "list_robots": "mgs.robot.list_robots",
    "load_gait": "mgs.gait.load_gait",
    "load_robot": "mgs.robot.load_robot",
    "plot": "mgs.report.figures.plot",
    "read_motion": "mgs.motion_file.read_motion",
    "replay": "mgs.sim.replay.replay",
    "validate": "mgs.judge.validate.validate",
    "write_motion": "mgs.motion_file.write_motion",
}
__all__ = sorted(_HOMES)

sys.meta_path.append(FormerPaths())


if not TYPE_CHECKING:  # a type checker would take every name for one that exists

    def __getattr__(name: str) -> object:
        """A name of the front door, or a room: `mgs.robot` is there without `import mgs.robot`."""
        if name in _HOMES:
            module, _, attribute = _HOMES[name].rpartition(".")
            found = getattr(importlib.import_module(module), attribute)
            globals()[name] = found
            return found
        try:
            if not name.startswith("_"):
                return importlib.import_module(f"mgs.{name}")
        except ModuleNotFoundError as error:
            if error.name != f"mgs.{name}":
                raise
        raise AttributeError(f"module 'mgs' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
