"""Servos watched while goals are streamed: silent ones, errors, loads.

Each period a few servos are asked, in turns. One that does not answer is suspected and asked again
in the following periods until it answers, or until it has been silent `lost_after` times in a row.
When several servos are asked by one Sync Read, those behind a silent one may be silent because of
it, so only the first silent one is suspected.
"""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass, field

from mgs.robot.hardware.bus import Bus, ServoState
from mgs.robot.hardware.line import Line


@dataclass(frozen=True)
class StopAt:
    """When to stop by itself."""

    lost_after: int = 8  # questions in a row that a servo does not answer
    max_load: int | None = None  # unit: `ControlTable.load_unit`; None: any
    loaded_for: int = 3  # answers in a row with a higher load
    most_late: float = 0.25  # [s] behind a deadline


@dataclass(frozen=True)
class Finding:
    """Why to stop."""

    kind: str  # lost, error, load
    servo: int
    words: str
    state: ServoState | None = None  # None: it is silent


@dataclass(frozen=True)
class Heard:
    """A position that a servo has answered."""

    time: float  # time.monotonic in the middle between question and answer [s]
    servo: int
    position: int  # [ticks]


@dataclass(eq=False)
class Watch:
    """The servos of a line under watch."""

    bus: Bus
    line: Line
    stop_at: StopAt
    at_once: int  # servos that are asked in a period
    asked: Counter[int] = field(default_factory=Counter)
    missed: Counter[int] = field(default_factory=Counter)
    heard: list[Heard] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._next = 0
        self._turn = 0
        self._silent: Counter[int] = Counter()
        self._loaded: Counter[int] = Counter()

    def look(self) -> Finding | None:
        """Ask the servos whose turn it is; what is wrong, if anything."""
        self._turn += 1
        suspect = max(self._silent, key=lambda servo: self._silent[servo], default=None)
        if suspect is not None and (self.at_once > 1 or self._turn % 2):
            if (finding := self._ask([suspect])) is not None:
                return finding
            if self.at_once == 1:
                return None
        return self._ask(self._of_this_turn())

    def _of_this_turn(self) -> list[int]:
        servos = self.line.servos
        count = self.at_once - bool(self._silent) if self.at_once > 1 else 1
        return [servos[(self._next + i) % len(servos)] for i in range(count)]

    def _ask(self, servos: list[int]) -> Finding | None:
        start = time.monotonic()
        states = self.bus.states(servos, self.line.table)
        middle = (start + time.monotonic()) / 2.0
        alone = self.line.table.protocol == 1  # each was asked by itself
        for servo in servos:
            self._next = (self.line.servos.index(servo) + 1) % len(self.line.servos)
            self.asked[servo] += 1
            state = states.get(servo)
            if state is None:
                self.missed[servo] += 1
                self._silent[servo] += 1
                if self._silent[servo] >= self.stop_at.lost_after:
                    return Finding(
                        "lost",
                        servo,
                        f"servo {servo} has not answered {self._silent[servo]} times in a row",
                    )
                if not alone:
                    break
                continue
            del self._silent[servo]
            self.heard.append(Heard(middle, servo, state.position))
            if (finding := self._judged(servo, state)) is not None:
                return finding
        return None

    def _judged(self, servo: int, state: ServoState) -> Finding | None:
        if state.has_error:
            return Finding("error", servo, f"servo {servo} reports an error", state)
        most = self.stop_at.max_load
        self._loaded[servo] += 1
        if most is None or abs(state.load) <= most:
            self._loaded[servo] = 0
        elif self._loaded[servo] >= self.stop_at.loaded_for:
            words = f"servo {servo} has a load of {state.load}, more than {most}"
            return Finding("load", servo, words, state)
        return None
