"""How a motion was made: by which solver, with which settings, and what was corrected."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from mgs.core.plugins import Origin


@dataclass(frozen=True)
class ZmpError:
    """Distance of the whole robot's ZMP from the planned one over a motion [m]."""

    mean: float
    max: float


@dataclass(frozen=True)
class FilterReport:
    """What the dynamic filter found in its first pass, and what its best pass leaves."""

    before: ZmpError
    after: ZmpError
    passes: int  # corrections that are part of the motion


@dataclass(frozen=True)
class Corrections:
    """What `mgs refine` learned from replays and added to the motion."""

    parts: tuple[float, ...]  # share of the observed deviation that each correction takes back
    engines: tuple[str, ...]


@dataclass(frozen=True)
class Optimisation:
    """What `mgs optimize` asked for, and the objective before and after."""

    weights: Mapping[str, float]
    margin: float  # of the centre of pressure from the edge of a sole [m]
    objective: tuple[float, float]


@dataclass(frozen=True)
class Provenance:
    """Everything about the making of a motion that its gait file does not say."""

    solver: Origin
    com_generator: Origin | None = None  # None: the gait itself says where the CoM goes
    tuning: Mapping[str, Any] = field(default_factory=dict)  # block `ik` of the gait, as resolved
    report: Mapping[str, Any] = field(default_factory=dict)  # how the solver fared
    zmp_error: FilterReport | None = None  # None: no ZMP was planned
    refined: Corrections | None = None
    optimised: Optimisation | None = None
    parts: tuple[Provenance, ...] = ()  # those of the parts of a sequence

    def to_dict(self) -> dict[str, Any]:
        """All figures in one flat dictionary, for people and scripts that read a motion file."""
        optional = {
            "com_generator": self.com_generator and asdict(self.com_generator),
            "zmp_error": self.zmp_error and asdict(self.zmp_error),
            "refined": self.refined and asdict(self.refined),
            "optimised": self.optimised and asdict(self.optimised),
            "parts": [part.to_dict() for part in self.parts],
        }
        return {
            **self.report,
            **self.tuning,
            "solver": self.solver.name,
            "package": self.solver.package,
            "version": self.solver.version,
            **{key: value for key, value in optional.items() if value},
        }


def provenance_of_sequence(parts: list[Provenance]) -> Provenance:
    """The provenance of gaits joined into one motion; the solver's name lists all of them."""
    solvers = list(dict.fromkeys(part.solver for part in parts))
    name, package, version = (
        ", ".join(dict.fromkeys(getattr(solver, key) for solver in solvers))
        for key in ("name", "package", "version")
    )
    return Provenance(Origin(name, package, version), parts=tuple(parts))
