"""Streaming of goals to servos: Sync Write at a fixed rate, a watch on the servos, a safe stop."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import HardwareError
from mgs.robot.hardware.bus import Bus
from mgs.robot.hardware.line import Line, Ticks, positions
from mgs.robot.hardware.pacing import Jitter, Pace, jitter, real_time
from mgs.robot.hardware.watch import Finding, Heard, StopAt, Watch

REPEATS = 3  # of a packet that stops servos and that nobody confirms
PEAK = 1.875  # largest speed of a minimum-jerk path over its mean speed


@dataclass(frozen=True, eq=False)
class Played:
    """What came of a stream of goals."""

    n_goals: int
    jitter: Jitter
    has_priority: bool  # whether the computer let goals go before other programs
    stopped: str | None  # why; None: all goals were sent
    stop_kind: str | None  # asked, late, lost, error, load, port
    stop_seconds: float  # from the finding until servos were told to hold, or have no torque
    asked: dict[int, int]  # answers expected, by servo
    missed: dict[int, int]  # answers that did not come or were damaged
    start: float  # time.monotonic of goal 0 [s]
    heard: tuple[Heard, ...]

    @property
    def words(self) -> str:
        """Figures in a few lines."""
        j, asked, missed = self.jitter, sum(self.asked.values()), sum(self.missed.values())
        text = (
            f"{j.sent} of {self.n_goals} goals sent; late after their deadlines by "
            f"{1e3 * j.mean:.2f} ms on average, {1e3 * j.p99:.2f} ms in 99 % of cases, "
            f"{1e3 * j.worst:.2f} ms at most; {j.missed} deadlines missed"
            f"{'' if self.has_priority else '; no real-time priority'}\n"
            f"  {missed} of {asked} answers of servos missing or damaged"
        )
        if self.stopped is not None:
            text += f"\n  stopped: {self.stopped} (told servos in {1e3 * self.stop_seconds:.1f} ms)"
        return text

    def to_dict(self) -> dict[str, object]:
        """Plain dict of all figures for JSON."""
        return {
            "goals": self.n_goals,
            "jitter": self.jitter.to_dict(),
            "real_time": self.has_priority,
            "stopped": self.stopped,
            "stop_kind": self.stop_kind,
            "stop_seconds": self.stop_seconds,
            "asked": self.asked,
            "missed": self.missed,
        }


def approach_path(present: Ticks, first: Ticks, speed: Array, rate: float) -> Ticks:
    """Goals (M, n) from the present positions to the first ones, at rest at both ends.

    All servos arrive together, on minimum-jerk paths.

    Args:
        present: positions (n,) [ticks].
        first: positions (n,) to reach [ticks].
        speed: largest speed (n,) [ticks/s].
        rate: goals per second.
    """
    way = first - present
    duration = PEAK * float((np.abs(way) / speed).max(initial=0.0))
    n = max(1, int(np.ceil(duration * rate)))
    s = (np.arange(1, n + 1, dtype=np.float64) / n)[:, None]
    blend = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    return np.asarray(np.rint(present + blend * way), dtype=np.int64)


def refuse_outside(goals: Ticks, line: Line) -> None:
    """Raise HardwareError if a goal is outside the limits that a servo has been given."""
    for i, servo in enumerate(line.servos):
        least, most = int(goals[:, i].min()), int(goals[:, i].max())
        if least < line.lower[i] or most > line.upper[i]:
            raise HardwareError(
                f"goals of servo {servo} go from {least} to {most} ticks, outside its own limits "
                f"[{line.lower[i]}, {line.upper[i]}]; correct zero_offset or sign of the motor in "
                "robot.yaml, or the limits in the servo"
            )


def take_hold(bus: Bus, line: Line) -> Ticks:
    """Switch torque on where the servos are; returns these positions (n,) [ticks].

    A servo keeps its last goal while its torque is off, and would jump there.

    Raises:
        HardwareError: a servo does not answer or does not take its goal.
    """
    present = positions(bus, line)
    goals = dict(zip(line.servos, present.tolist(), strict=True))
    bus.write_surely(line.table.goal, goals)
    bus.write_surely(line.table.torque_enable, dict.fromkeys(line.servos, 1))
    return present


def stream(
    bus: Bus,
    line: Line,
    goals: Ticks,
    rate: float,
    *,
    stop: Callable[[], str | None] = lambda: None,
    stop_at: StopAt | None = None,
    off_when_stopped: bool = False,
) -> Played:
    """Send goals, one row a period, and watch the servos.

    A row whose deadline is over when the next one is due is left out. When something is wrong, or
    `stop` gives a reason, servos hold: they are told their last goal again, a servo with too much
    load its measured position.

    Args:
        bus: an open bus.
        line: its servos.
        goals: (N, n) [ticks].
        rate: rows per second [Hz].
        stop: asked at least every 2 ms between packets; gives a reason to stop, or None.
        stop_at: when to stop by itself; None: as `StopAt` has it.
        off_when_stopped: switch torque off when stopped, instead of holding.

    Raises:
        HardwareError: answers take too long for this rate.
    """
    period = 1.0 / rate
    at_once = line.at_once(period)
    bus.wait = line.wait(period)
    watch = Watch(bus, line, stop_at or StopAt(), at_once)
    pace = Pace(time.monotonic() + period, period)
    with real_time() as has_priority:
        sending = _send(watch, pace, goals, stop)
        found = sending.found
        seconds, words = 0.0, None
        if found is not None:
            noticed = time.monotonic()
            last = goals[max(sending.sent, 0)]
            words = found.words + _stop(bus, line, last, found, off_when_stopped)
            seconds = time.monotonic() - noticed
            words += _named(bus, line, found)
    return Played(
        n_goals=len(goals),
        jitter=jitter(sending.late, period, sending.left_out),
        has_priority=has_priority,
        stopped=words,
        stop_kind=None if found is None else found.kind,
        stop_seconds=seconds,
        asked=dict(watch.asked),
        missed=dict(watch.missed),
        start=pace.start,
        heard=tuple(watch.heard),
    )


@dataclass(eq=False)
class _Sending:
    """Goals under way."""

    late: list[float] = field(default_factory=list)  # [s]
    left_out: int = 0
    sent: int = -1  # last row
    found: Finding | None = None


def _send(watch: Watch, pace: Pace, goals: Ticks, stop: Callable[[], str | None]) -> _Sending:
    """Send goals at their deadlines until there is a reason to stop."""
    way, goal = _Sending(), watch.line.table.goal
    try:
        while way.found is None and way.sent < len(goals) - 1:
            k = max(way.sent + 1, min(pace.current(), len(goals) - 1))
            way.left_out += k - way.sent - 1
            if (reason := pace.wait(k, stop)) is not None:
                way.found = Finding("asked", 0, reason)
                break
            late = time.monotonic() - pace.due(k)
            way.late.append(late)
            if late > watch.stop_at.most_late:
                words = f"a goal was {late:.2f} s late: the computer is too busy"
                way.found = Finding("late", 0, words)
                break
            watch.bus.write_all(goal, _by_servo(watch.line, goals[k]))
            way.sent = k
            way.found = watch.look()
    except HardwareError as error:
        way.found = Finding("port", 0, str(error))
    return way


def torque_off(bus: Bus, line: Line) -> None:
    """Switch torque off, several times, since nobody confirms it.

    Raises:
        HardwareError: the port is gone.
    """
    for _ in range(REPEATS):
        bus.write_all(line.table.torque_enable, dict.fromkeys(line.servos, 0))


def _by_servo(line: Line, row: Ticks) -> dict[int, int]:
    return dict(zip(line.servos, row.tolist(), strict=True))


def _stop(bus: Bus, line: Line, last: Ticks, found: Finding, off: bool) -> str:
    """Hold or switch off; words on a failure to do so."""
    goals = _by_servo(line, last)
    if found.state is not None:
        goals[found.servo] = found.state.position
    try:
        if off:
            torque_off(bus, line)
        else:
            for _ in range(REPEATS):
                bus.write_all(line.table.goal, goals)
    except HardwareError as error:
        return f"; servos could not be told to stop ({error}): switch their power off"
    return ""


def _named(bus: Bus, line: Line, found: Finding) -> str:
    """Name of the error that a servo reports, which takes a question of its own."""
    if found.kind != "error" or found.state is None:
        return ""
    try:
        return f": {bus.error_of(found.servo, line.table, found.state)}"
    except HardwareError as error:
        return f", which cannot be read: {error}"
