"""Result of an experiment: what a paper says, what was measured, and whether the two agree."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

Holds = bool | Literal["not applicable"]
Kind = Literal["paper", "ours"]


@dataclass(frozen=True)
class Claim:
    """One claim and whether the measured values support it.

    Attributes:
        id: short and stable name, for scripts.
        claim: what the paper says, as close to its words as fair.
        figure: measured value, as it is printed.
        holds: True, False, or "not applicable".
        note: measure and threshold, time window and method; the reason, if the claim does not hold.
        values: numbers from which `figure` was made.
        source: paper and section of the sentence, such as "FI III-B"; "" for a claim of ours.
        methods: every method that the sentence names, such as ("ik1", "ik3").
        kind: "paper" for a sentence of a paper, "ours" for a statement that no paper makes.
        robustness: result of `mgs.experiments.sensitivity`: "robust", or "fragile: breaks at" and
            the variants; None: not measured.
    """

    id: str
    claim: str
    figure: float | str
    holds: Holds
    note: str = ""
    values: dict[str, float] = field(default_factory=dict)
    source: str = ""
    methods: tuple[str, ...] = ()
    kind: Kind = "paper"
    robustness: str | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.holds, bool | str):  # NumPy booleans cannot be written as JSON
            raise TypeError(f"{self.id}: holds is {type(self.holds).__name__}")

    def to_dict(self) -> dict[str, object]:
        """Convert the claim to plain data."""
        unknown = "ours" if self.kind == "ours" else "not measured"
        return {
            "id": self.id,
            "source": self.source,
            "claim": self.claim,
            "methods": list(self.methods),
            "class": self.kind,
            "figure": self.figure,
            "holds": self.holds,
            "robustness": self.robustness or unknown,
            "note": self.note,
            "values": {k: v for k, v in self.values.items() if math.isfinite(v)},
        }
