"""Several measurements of one time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Spread:
    """Of times in seconds. Noise of a shared machine only adds, so the least says most."""

    least: float
    median: float
    p99: float
    n: int

    def to_dict(self) -> dict[str, float]:
        """As plain data."""
        return asdict(self)


def spread(seconds: Sequence[float] | NDArray[np.float64]) -> Spread:
    """Spread of measurements [s]."""
    values = np.asarray(seconds, dtype=np.float64)
    median, p99 = np.percentile(values, [50.0, 99.0])
    return Spread(float(values.min()), float(median), float(p99), len(values))
