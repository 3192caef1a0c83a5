"""Which engines and servos a replay uses, from what a user has asked for."""

from __future__ import annotations

from collections.abc import Iterable

from mgs.core.errors import ConfigError, SimulationError
from mgs.core.wrong_type import wrong_type
from mgs.sim.engine import available_engines
from mgs.sim.settings import ENGINES, SERVOS, EngineName, ServoName


def choose_engines(
    physics: str | Iterable[str] | None, source: str = "physics"
) -> tuple[EngineName, ...]:
    """Engines to replay a motion in, in the order of `ENGINES`.

    Args:
        physics: names, in a list or in one text with commas between them; "none" or an empty list:
            no engine; None: every engine that is installed.
        source: name of the option or the argument, for messages.

    Raises:
        SimulationError: every installed engine is asked for and there is none.
        ConfigError: a name is unknown or given twice.
        TypeError: `physics` is of another type.
    """
    if physics is None:
        if not available_engines():
            raise SimulationError("no physics engine is installed; install mujoco or pybullet")
        return available_engines()
    if not isinstance(physics, Iterable):
        raise wrong_type(source, f"names of engines ({', '.join(ENGINES)}) or None", physics)
    names = physics.split(",") if isinstance(physics, str) else physics
    asked = [str(name).strip() for name in names]
    if asked in ([], ["none"]):
        return ()
    if not set(asked) <= set(ENGINES) or len(set(asked)) != len(asked):
        told = physics if isinstance(physics, str) else ", ".join(asked)
        known = f"{', '.join(ENGINES)} (separated by commas) or none"
        raise ConfigError(source, f"{told!r} is not a list of physics engines; use {known}")
    return tuple(engine for engine in ENGINES if engine in asked)


def check_servo(servo: ServoName, feed_forward: bool | None, source: str = "feed_forward") -> None:
    """Raise ConfigError for unknown servos, or if feed-forward is requested for ideal ones.

    Args:
        servo: kind of servo.
        feed_forward: whether commands that compensate position errors under load are requested.
        source: name of the option or the argument of `feed_forward`, for messages.
    """
    if servo not in SERVOS:
        raise ConfigError("servo", f"{servo!r} is unknown; use {' or '.join(SERVOS)}")
    if feed_forward and servo == "ideal":
        remedy = "use modelled servos (--servo model)"
        raise ConfigError(source, f"ideal servos have no position error to compensate; {remedy}")
