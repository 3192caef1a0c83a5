"""Open-loop replay of motions in physics engines."""

from mgs.sim.engine import available_engines
from mgs.sim.playback import Progress
from mgs.sim.replay import Replay, Trace, replay
from mgs.sim.settings import DEFAULTS, ENGINES, EngineName, Settings

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
