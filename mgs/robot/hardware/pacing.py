"""A fixed rate by absolute deadlines, and how well it is kept.

Deadline k is start + k / rate, whatever happened before: an error of one period is not carried into
the next, and the last goal goes out when the plan says.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass

import numpy as np

SLICE = 2e-3  # [s] of sleep between two looks at whether to stop


@dataclass(frozen=True)
class Jitter:
    """How late goals were sent after their deadlines [s]."""

    mean: float
    p99: float
    worst: float
    missed: int  # deadlines: later than a whole period, or left out
    sent: int

    def to_dict(self) -> dict[str, float | int]:
        """Plain dict for JSON."""
        return asdict(self)


def jitter(late: list[float], period: float, left_out: int) -> Jitter:
    """Figures of delays [s] behind the deadlines."""
    delays = np.array(late or [0.0])
    return Jitter(
        mean=float(delays.mean()),
        p99=float(np.percentile(delays, 99)),
        worst=float(delays.max()),
        missed=int((delays > period).sum()) + left_out,
        sent=len(late),
    )


@dataclass(frozen=True)
class Pace:
    """Deadlines from a start on; times are those of time.monotonic [s]."""

    start: float
    period: float

    def due(self, k: int) -> float:
        """Time of deadline k."""
        return self.start + k * self.period

    def current(self) -> int:
        """Number of the last deadline that is over."""
        return int((time.monotonic() - self.start) / self.period)

    def wait(self, k: int, stop: Callable[[], str | None]) -> str | None:
        """Sleep until deadline k; ends at once, with the reason, if `stop` gives one."""
        while True:
            if (reason := stop()) is not None:
                return reason
            left = self.due(k) - time.monotonic()
            if left <= 0.0:
                return None
            time.sleep(min(left, SLICE))


@contextlib.contextmanager
def real_time() -> Iterator[bool]:
    """Run before all ordinary programs of this computer, if that is allowed; gives whether it is.

    Linux alone has such a priority that programs can take, and lets root and users with the limit
    `rtprio` take it. What runs so has to sleep most of the time.
    """
    if not hasattr(os, "sched_setscheduler"):
        yield False
        return
    before = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))
    except OSError:
        yield False
        return
    try:
        yield True
    finally:
        os.sched_setscheduler(0, *before)
