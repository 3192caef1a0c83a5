"""Result of an experiment: a claim and whether it holds."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal


@dataclass(frozen=True)
class Claim:
    """One claim and whether the measured values support it.

    Attributes:
        id: short and stable name, for scripts.
        claim: text of the claim.
        figure: measured value, as it is printed.
        holds: True, False, or "not applicable".
        note: time window and method; the reason, if the claim does not hold.
        values: numbers from which `figure` was made.
    """

    id: str
    claim: str
    figure: float | str
    holds: bool | Literal["not applicable"]
    note: str = ""
    values: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.holds, bool | str):  # NumPy booleans cannot be written as JSON
            raise TypeError(f"{self.id}: holds is {type(self.holds).__name__}")

    def to_dict(self) -> dict[str, object]:
        """Convert the claim to plain data."""
        return {
            "id": self.id,
            "claim": self.claim,
            "figure": self.figure,
            "holds": self.holds,
            "note": self.note,
            "values": dict(self.values),
        }
