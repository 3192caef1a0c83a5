"""One motion on a real robot: look, compare postures, go to the first one slowly, play, hold.

with Bus(port, baud, protocol) as bus:
    situation = look_around(bus, servos, goals, wish)  # nothing moves
    result = perform(bus, situation, goals, wish, stop)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import HardwareError
from mgs.core.short_repr import short_repr
from mgs.robot.hardware.bus import Bus
from mgs.robot.hardware.line import Line, Ticks, look_at, positions
from mgs.robot.hardware.player import (
    Played,
    approach_path,
    refuse_outside,
    stream,
    take_hold,
    torque_off,
)
from mgs.robot.hardware.watch import StopAt


@dataclass(frozen=True, eq=False)
class Wish:
    """How a motion is to be played; arrays in the order of the servos."""

    rate: float  # [Hz]
    near: Array  # (n,) distance to the first goal that needs no approach [ticks]
    approach: Array | None  # (n,) largest speed of the approach [ticks/s]; None: no approach
    stop_at: StopAt = field(default_factory=StopAt)
    off_when_stopped: bool = False
    off_at_end: bool = False

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class Situation:
    """Servos before anything moves."""

    line: Line
    present: Ticks  # (n,)
    gap: Ticks  # (n,) from the present positions to the first goals
    approach_seconds: float  # 0: no approach is needed

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class Result:
    """What was done."""

    approach: Played | None  # None: not needed
    motion: Played | None  # None: the approach was stopped
    holds: bool  # whether servos have torque at the end

    @property
    def stopped(self) -> str | None:
        """Why it ended early; None: it did not."""
        last = self.motion or self.approach
        return None if last is None else last.stopped


def look_around(bus: Bus, servos: Sequence[int], goals: Ticks, wish: Wish) -> Situation:
    """Look at servos and compare their posture with the first goals.

    Raises:
        HardwareError: a servo is missing or unfit, a goal is outside its limits, answers take too
            long for the rate, or the posture is far and no approach is allowed.
    """
    line = look_at(bus, servos)
    refuse_outside(goals, line)
    line.at_once(1.0 / wish.rate)
    present = positions(bus, line)
    gap = goals[0] - present
    far = np.abs(gap) > wish.near
    seconds = 0.0
    if far.any():
        if wish.approach is None:
            worst = int(np.argmax(np.abs(gap) / wish.near))
            raise HardwareError(
                f"servo {line.servos[worst]} is at {present[worst]}, but the motion begins at "
                f"{goals[0, worst]}; bring the robot into its first posture or allow an approach"
            )
        seconds = len(approach_path(present, goals[0], wish.approach, wish.rate)) / wish.rate
    return Situation(line, present, gap, seconds)


def perform(
    bus: Bus,
    situation: Situation,
    goals: Ticks,
    wish: Wish,
    stop: Callable[[], str | None],
) -> Result:
    """Switch torque on, go to the first goals, play, then hold or switch torque off.

    Args:
        bus: an open bus.
        situation: from `look_around`.
        goals: (N, n) [ticks].
        wish: how to play.
        stop: gives a reason to stop, or None.

    Raises:
        HardwareError: a servo does not take its first goal, or has not reached the first posture.
    """
    line = situation.line
    present = take_hold(bus, line)
    ways = {"stop": stop, "stop_at": wish.stop_at, "off_when_stopped": wish.off_when_stopped}
    approach = None
    if (np.abs(goals[0] - present) > wish.near).any():
        if wish.approach is None or not situation.approach_seconds:
            raise HardwareError("the robot has moved since it was looked at; try again")
        path = approach_path(present, goals[0], wish.approach, wish.rate)
        approach = stream(bus, line, path, wish.rate, **ways)  # type: ignore[arg-type]
        if approach.stopped is not None:
            return Result(approach, None, not wish.off_when_stopped)
        _refuse_blocked(bus, line, goals[0], wish)
    motion = stream(bus, line, goals, wish.rate, **ways)  # type: ignore[arg-type]
    off = wish.off_at_end if motion.stopped is None else wish.off_when_stopped
    if off:
        torque_off(bus, line)
    return Result(approach, motion, not off)


def measured(played: Played, line: Line) -> tuple[Array, Array]:
    """Answers of the servos as a log.

    Returns:
        times: (K,) since the first goal was due [s].
        ticks: (K, n); NaN where a servo was not asked or did not answer.
    """
    times = np.unique([heard.time for heard in played.heard])
    ticks = np.full((len(times), len(line.servos)), np.nan)
    column = {servo: i for i, servo in enumerate(line.servos)}
    for heard in played.heard:
        ticks[np.searchsorted(times, heard.time), column[heard.servo]] = heard.position
    return times - played.start, ticks


def _refuse_blocked(bus: Bus, line: Line, first: Ticks, wish: Wish) -> None:
    """Raise HardwareError, with servos that hold, unless the first posture has been reached."""
    present = positions(bus, line)
    far = np.abs(first - present) > 2.0 * wish.near
    if far.any():
        worst = int(np.argmax(np.abs(first - present) / wish.near))
        if wish.off_when_stopped:
            torque_off(bus, line)
        raise HardwareError(
            f"servo {line.servos[worst]} is at {present[worst]} after the approach to "
            f"{first[worst]}; it is blocked, too weak or limited in speed"
        )
