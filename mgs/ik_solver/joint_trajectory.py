"""The product of stage 4."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from mgs.core.short_repr import short_repr


class SolverReport(Protocol):
    """How a solver fared: a frozen dataclass of its own, with figures by name for motion files."""

    def to_dict(self) -> dict[str, object]:
        """The report as plain data."""
        ...


Report = TypeVar("Report", bound=SolverReport)


@dataclass(frozen=True, eq=False)
class JointTrajectory:
    """Joint angles at every sample, in the order of `Robot.joint_names`.

    `velocities` are those that a solver finds by itself, not by differences of the angles (ik2).
    """

    angles: NDArray[np.float64]  # (N, n) [rad]
    velocities: NDArray[np.float64] | None = None  # (N, n) [rad/s]
    report: SolverReport | None = None  # None: the solver has nothing to report

    __repr__ = short_repr

    def report_of(self, kind: type[Report]) -> Report:
        """The report, known to be of one kind; raises TypeError if another solver wrote it."""
        if not isinstance(self.report, kind):
            raise TypeError(f"the report is a {type(self.report).__name__}, not a {kind.__name__}")
        return self.report
