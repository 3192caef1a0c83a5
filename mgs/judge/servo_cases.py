"""Cases and outcomes of a servo sweep: see mgs.judge.servo_sweep."""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import dataclass

from mgs.sim import EngineName

SAGS_DEG = (0.25, 0.5, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0)  # position error at stall torque
FRICTIONS = (0.7, 1.0, 1.3)
ASSUMED_STIFFNESS = (None, 0.7, 1.4)  # of the feed-forward, relative to the servos'; None: without


@dataclass(frozen=True)
class Case:
    """Servos and floor of one replay."""

    assumed_stiffness: float | None
    friction: float
    sag_deg: float


CASES = tuple(Case(*values) for values in itertools.product(ASSUMED_STIFFNESS, FRICTIONS, SAGS_DEG))


@dataclass(frozen=True)
class Outcome:
    """What became of one replay."""

    case: Case
    fell: bool
    failed: tuple[str, ...]  # checks without the engine, the fall included


@dataclass(frozen=True)
class ServoSweep:
    """All replays of one motion in one engine."""

    engine: EngineName
    outcomes: tuple[Outcome, ...]

    def passing(self, assumed_stiffness: float | None, friction: float) -> tuple[float, ...]:
        """Sags [deg] at which the motion stays up and arrives, from small to large."""
        return tuple(
            outcome.case.sag_deg
            for outcome in self.outcomes
            if not outcome.failed
            and (outcome.case.assumed_stiffness, outcome.case.friction)
            == (assumed_stiffness, friction)
        )

    def to_dict(self) -> dict[str, object]:
        """Convert to plain data."""
        return {
            "engine": self.engine,
            "passed": sum(not outcome.failed for outcome in self.outcomes),
            "n": len(self.outcomes),
            "replays": [
                {
                    **dataclasses.asdict(outcome.case),
                    "fell": outcome.fell,
                    "failed": list(outcome.failed),
                }
                for outcome in self.outcomes
            ],
        }
