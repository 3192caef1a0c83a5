"""What an experiment found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal


@dataclass(frozen=True)
class Claim:
    """One statement and whether the figures bear it out.

    Attributes:
        id: short name, stable, for scripts.
        claim: what is claimed.
        figure: what was found, as it is printed.
        holds: whether the claim does.
        note: window, method, and the reason where a claim does not hold.
        values: the numbers behind `figure`.
    """

    id: str
    claim: str
    figure: float | str
    holds: bool | Literal["not applicable"]
    note: str = ""
    values: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.holds, bool | str):  # numpy's are no JSON
            raise TypeError(f"{self.id}: holds is {type(self.holds).__name__}")

    def to_dict(self) -> dict[str, object]:
        """The claim as plain data."""
        return {
            "id": self.id,
            "claim": self.claim,
            "figure": self.figure,
            "holds": self.holds,
            "note": self.note,
            "values": dict(self.values),
        }
