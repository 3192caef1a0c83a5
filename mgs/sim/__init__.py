"""Open-loop replay of motions in physics engines."""

from mgs.core.engines import MissingEngine, available_engines, missing_engines
from mgs.core.progress import Progress
from mgs.sim.agreement import Agreement, agreement
from mgs.sim.choice import check_servos, choose_engines, choose_servos, engine_settings
from mgs.sim.figures import Trace
from mgs.sim.one_robot import OneRobot
from mgs.sim.replay import Replay, replay
from mgs.sim.settings import DEFAULTS, ENGINES, SERVOS, EngineName, ServoName, Settings
from mgs.sim.strike import Strike

__all__ = [
    "DEFAULTS",
    "ENGINES",
    "SERVOS",
    "Agreement",
    "EngineName",
    "MissingEngine",
    "OneRobot",
    "Progress",
    "Replay",
    "ServoName",
    "Settings",
    "Strike",
    "Trace",
    "agreement",
    "available_engines",
    "check_servos",
    "choose_engines",
    "choose_servos",
    "engine_settings",
    "missing_engines",
    "replay",
]
