"""Spans of a trajectory in which something stays the same, such as the support."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def span_starts(values: NDArray[np.generic]) -> list[int]:
    """First samples of the spans of equal values (N,), N >= 1; the first one is 0."""
    return [0, *(np.flatnonzero(values[1:] != values[:-1]) + 1).tolist()]


def spans(values: NDArray[np.generic]) -> list[tuple[int, int]]:
    """Spans start <= k < end of equal values (N,), which tile 0 <= k < N."""
    starts = span_starts(values)
    return list(zip(starts, [*starts[1:], len(values)], strict=True))
