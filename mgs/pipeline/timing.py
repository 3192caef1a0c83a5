"""Wall time of each stage, collected while they run."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")


def timed(seconds: dict[str, float], stage: str, work: Callable[[], T]) -> T:
    """Add the time of `work` to its stage, which may be worked on more than once."""
    start = time.perf_counter()
    product = work()
    seconds[stage] = seconds.get(stage, 0.0) + time.perf_counter() - start
    return product
