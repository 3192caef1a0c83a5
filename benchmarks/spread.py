"""Statistics of repeated time measurements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Spread:
    """Statistics of measured times [s]; noise only adds time, so the minimum is most reliable."""

    least: float
    median: float
    p99: float
    n: int

    def to_dict(self) -> dict[str, float]:
        """Convert to plain data."""
        return asdict(self)


def spread(seconds: Sequence[float] | NDArray[np.float64]) -> Spread:
    """Statistics of measured times [s]."""
    values = np.asarray(seconds, dtype=np.float64)
    median, p99 = np.percentile(values, [50.0, 99.0])
    return Spread(float(values.min()), float(median), float(p99), len(values))
