"""Report of a run of ik1 to ik5."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mgs.core.arrays import Array


@dataclass(frozen=True)
class FarajiReport:
    """How one of the methods fared.

    The series are not part of `to_dict`, because computing times differ from run to run.
    """

    hard_error: float  # largest entry of the error of a hard task [m] or [rad]
    elastic_samples: int  # samples at which hard rows and bounds contradicted each other
    recovering_samples: int  # samples at which a joint could not reach its safety region
    returns: int = 0  # times that a part of the motion was repeated with bent knees
    iterations: Array = field(default_factory=lambda: np.zeros(0), repr=False, compare=False)
    seconds: Array = field(default_factory=lambda: np.zeros(0), repr=False, compare=False)
    """CPU time (N,) of each sample [s]; other processes do not count."""

    def to_dict(self) -> dict[str, object]:
        """Convert the numbers to plain data."""
        return {
            "hard_error": self.hard_error,
            "elastic_samples": self.elastic_samples,
            "recovering_samples": self.recovering_samples,
            "returns": self.returns,
        }
