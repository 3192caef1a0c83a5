"""Which engines and servos a replay uses, from what a user has asked for."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from mgs.core.engines import available_engines
from mgs.core.errors import ConfigError, SimulationError
from mgs.core.wrong_type import wrong_type
from mgs.sim.settings import DEFAULTS, ENGINES, SERVOS, EngineName, ServoName, Settings


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


def choose_servos(servo: str | Iterable[str], source: str = "servo") -> tuple[ServoName, ...]:
    """Kinds of servos to replay a motion with, in the order given.

    Args:
        servo: names, in a list or in one text with commas between them.
        source: name of the option or the argument, for messages.

    Raises:
        ConfigError: a name is unknown or given twice, or there is none.
        TypeError: `servo` is of another type.
    """
    if not isinstance(servo, Iterable):
        raise wrong_type(source, f"names of servos ({', '.join(SERVOS)})", servo)
    names = servo.split(",") if isinstance(servo, str) else servo
    asked = [str(name).strip() for name in names]
    if not asked or not set(asked) <= set(SERVOS) or len(set(asked)) != len(asked):
        told = ", ".join(asked)
        raise ConfigError(source, f"{told!r} is unknown; use {' or '.join(SERVOS)}")
    return tuple(asked)  # type: ignore[arg-type]


def check_servos(servos: Sequence[ServoName], options: Mapping[str, float | None]) -> None:
    """Raise ConfigError for an option that has no effect on any of the servos.

    Args:
        servos: kinds of servos.
        options: values by the names of the options or arguments for feed-forward, sag and damping
            time, in this order; None: not given.
    """
    feed_forward, *of_pd = options
    if options[feed_forward] and set(servos) == {"ideal"}:
        remedy = "use modelled servos (--servo model) or PD servos (--servo pd)"
        raise ConfigError(
            feed_forward, f"ideal servos have no position error to compensate; {remedy}"
        )
    for name in of_pd:
        if options[name] is not None and "pd" not in servos:
            raise ConfigError(name, "only PD servos have it; use PD servos (--servo pd)")


def engine_settings(
    engine: EngineName,
    sag_deg: float | None = None,
    damping_time: float | None = None,
    **changes: float | None,
) -> Settings:
    """Default settings of an engine, but for values that are not None.

    Args:
        engine: name of the engine.
        sag_deg: position error of PD servos at stall torque [deg].
        damping_time: damping of PD servos divided by their stiffness [s].
        changes: other fields of `Settings`.

    Raises:
        ConfigError: sag or damping time is out of range.
    """
    ranges = {"sag_deg": (sag_deg, 0.01, 90.0, "deg"), "damping_time": (damping_time, 0, 1, "s")}
    for name, (value, least, most, unit) in ranges.items():
        if value is not None and not least <= value <= most:
            raise ConfigError(name, f"{value:g} is outside the range {least:g} to {most:g} {unit}")
    sag = None if sag_deg is None else math.radians(sag_deg)
    changes |= {"sag": sag, "damping_time": damping_time}
    given: dict[str, Any] = {key: value for key, value in changes.items() if value is not None}
    return dataclasses.replace(DEFAULTS[engine], **given)
