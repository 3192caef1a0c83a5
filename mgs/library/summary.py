"""Progress and result of a run that makes a gait library."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from mgs.library.manifest import MANIFEST, Value


@dataclass(eq=False)
class Summary:
    """How many gaits of a library are done, and with which verdicts."""

    folder: Path
    n: int  # number of gaits in the library
    kept: int = 0  # gaits that an earlier run made and this one keeps
    done: int = 0  # gaits made by this run
    verdicts: Counter[str] = field(default_factory=Counter)  # of all gaits so far
    reasons: Counter[str] = field(default_factory=Counter)  # of the gaits that did not pass
    workers: int = 0
    dashboard: str | None = None  # address of Dask's dashboard
    seconds: float = 0.0  # [s] since the workers were ready

    @property
    def rate(self) -> float:
        """Gaits made per second."""
        return self.done / self.seconds if self.seconds else 0.0

    def count(self, verdict: Value, reason: Value) -> None:
        """Add the verdict on one gait."""
        self.verdicts[str(verdict)] += 1
        if reason is not None:
            self.reasons[str(reason)] += 1

    def to_dict(self) -> dict[str, object]:
        """Convert to plain data, for JSON."""
        return {
            "folder": str(self.folder),
            "manifest": str(self.folder / MANIFEST),
            "gaits": self.n,
            "kept": self.kept,
            "made": self.done,
            "verdicts": dict(self.verdicts),
            "reasons": dict(self.reasons.most_common()),
            "seconds": self.seconds,
            "gaits_per_second": self.rate,
            "workers": self.workers,
            "dashboard": self.dashboard,
        }
