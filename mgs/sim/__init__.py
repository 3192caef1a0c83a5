"""Open-loop replay of motions in physics engines."""

from mgs.sim.engine import DEFAULTS, ENGINES, EngineName, Settings, available_engines
from mgs.sim.playback import Progress
from mgs.sim.replay import Replay, Trace, replay

__all__ = [
    "DEFAULTS",
    "ENGINES",
    "EngineName",
    "Progress",
    "Replay",
    "Settings",
    "Trace",
    "available_engines",
    "replay",
]
