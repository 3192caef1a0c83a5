"""Servos on a bus before they are trusted: are they there, can they follow, how fast they answer.

Nothing is written here; a robot that is looked at does not move.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.errors import HardwareError
from mgs.robot.hardware.bus import Bus, ServoState
from mgs.robot.hardware.tables import ControlTable, error_words, table_of

Ticks = NDArray[np.int64]

SAMPLES = 16  # answers that are timed
QUICK = 25.0  # [%] of the answers: a busy computer delays some, an adapter all of them
SHARE = 0.4  # of a period, that answers may take
LEAST_WAIT = 2e-3  # [s] for an answer beyond its time on the wire
MOST_TICKS = 1 << 20  # of a limit; a register may hold any number of turns


@dataclass(frozen=True, eq=False)
class Line:
    """Servos that have been looked at; arrays in the order of `servos`."""

    servos: tuple[int, ...]  # ids
    table: ControlTable
    lower: Ticks  # (n,) smallest goals
    upper: Ticks  # (n,) largest goals
    answer: float  # [s] for one servo, exceeded by three quarters of the answers
    further: float  # [s] for each further servo that is asked together with it
    voltage: float  # [V] smallest
    warnings: tuple[str, ...]

    def wait(self, period: float) -> float:
        """How long to wait for an answer beyond its time on the wire, with a period [s]."""
        return min(max(LEAST_WAIT, 3.0 * self.answer), SHARE * period)

    def at_once(self, period: float) -> int:
        """How many servos can be asked in a period [s].

        Raises:
            HardwareError: not even one.
        """
        budget = SHARE * period
        if self.answer > budget:
            raise HardwareError(
                f"an answer of a servo takes {1e3 * self.answer:.1f} ms, and a period of "
                f"{1e3 * period:.1f} ms leaves {1e3 * budget:.1f} ms for it; set the latency timer "
                "of the USB adapter to 1 ms and Return Delay Time of the servos to 0, or lower "
                f"--rate to {SHARE / self.answer:.0f} Hz"
            )
        more = (budget - self.answer) / max(self.further, 1e-6)
        return min(len(self.servos), 1 + int(more))


def look_at(bus: Bus, servos: Sequence[int]) -> Line:
    """Look at servos.

    Args:
        bus: an open bus.
        servos: ids.

    Raises:
        HardwareError: a servo does not answer, is of another series, is in a mode without goal
            position, or reports an error.
    """
    models = {servo: bus.model(servo) for servo in servos}
    tables = {servo: table_of(bus.protocol, model) for servo, model in models.items()}
    table = tables[servos[0]]
    for servo in servos:
        if tables[servo] is not table:
            raise HardwareError(
                f"servo {servo} has the control table of {tables[servo].name}, servo {servos[0]} "
                f"that of {table.name}; one line has to be of one series"
            )
    warnings: list[str] = []
    for servo in servos:
        _refuse_unfit(bus, table, servo)
        if limit := bus.read(servo, table.speed_limit):
            warnings.append(
                f"servo {servo} limits its speed (value {limit} at address "
                f"{table.speed_limit.address}); 0 lets it follow at any speed"
            )
    lower = np.array([bus.read(servo, table.lower) for servo in servos], dtype=np.int64)
    upper = np.array([bus.read(servo, table.upper) for servo in servos], dtype=np.int64)
    endless = (lower == upper) | (upper > MOST_TICKS)  # extended position, several turns
    answer, further = _answer_times(bus, table, servos)
    return Line(
        servos=tuple(servos),
        table=table,
        lower=np.where(endless, -MOST_TICKS, lower),
        upper=np.where(endless, MOST_TICKS, upper),
        answer=answer,
        further=further,
        voltage=min(bus.read(servo, table.voltage) for servo in servos) / 10.0,
        warnings=tuple(warnings),
    )


def positions(bus: Bus, line: Line) -> Ticks:
    """Present positions (n,) of all servos [ticks].

    Raises:
        HardwareError: one does not answer.
    """
    return np.array([bus.read(s, line.table.position) for s in line.servos], dtype=np.int64)


def _refuse_unfit(bus: Bus, table: ControlTable, servo: int) -> None:
    if table.error is not None and (value := bus.read(servo, table.error)):
        words = error_words(2, value) or f"status {value}"
        raise HardwareError(
            f"servo {servo} reports a hardware error ({words}); find its cause, then switch the "
            "power of the servo off and on"
        )
    if table.mode is not None:
        mode = bus.read(servo, table.mode)
        if mode not in table.position_modes:
            raise HardwareError(
                f"servo {servo} is in operating mode {mode}, which has no goal position; set "
                f"address {table.mode.address} to {table.position_modes[0]} while its torque is off"
            )
    elif bus.read(servo, table.lower) == bus.read(servo, table.upper) == 0:
        raise HardwareError(
            f"servo {servo} turns as a wheel, since both of its angle limits are 0; set them"
        )


def _answer_times(bus: Bus, table: ControlTable, servos: Sequence[int]) -> tuple[float, float]:
    """Time [s] of the answer of one servo, and of each further one asked with it."""
    single = _timed(bus, table, servos[:1])
    if not single:
        raise HardwareError(f"servo {servos[0]} does not answer when its state is read")
    one = float(np.percentile(single, QUICK))
    if len(servos) == 1:
        return one, one
    together = _timed(bus, table, servos)
    if not together:  # too many answers are lost: count on single ones
        return one, one
    further = (float(np.percentile(together, QUICK)) - one) / (len(servos) - 1)
    return one, max(further, 0.0)


def _timed(bus: Bus, table: ControlTable, servos: Sequence[int]) -> list[float]:
    """Durations [s] of those questions that all of the servos answered."""
    times = []
    for _ in range(SAMPLES):
        start = time.monotonic()
        states: dict[int, ServoState] = bus.states(servos, table)
        if len(states) == len(servos):
            times.append(time.monotonic() - start)
    return times
