"""All sweeps of the crouch experiment, and the torques that physics engines measure."""

from __future__ import annotations

from dataclasses import dataclass

from mgs.core.progress import Progress
from mgs.experiments.crouch.engines import Measured, measure
from mgs.experiments.crouch.runs import (
    FRACTIONS,
    MOTIONS,
    MotionName,
    Sweep,
    given_robots,
    methods_of,
    run_one,
)
from mgs.experiments.variant import BASE, Variant

SweepKey = tuple[str, MotionName, str]  # robot, motion, method


@dataclass(frozen=True, eq=False)
class Study:
    """All sweeps, and both ends of some of them in physics."""

    sweeps: dict[SweepKey, Sweep]
    engines: tuple[Measured, ...]

    def __getitem__(self, key: SweepKey) -> Sweep:
        """Sweep of a robot, a motion and a method."""
        return self.sweeps[key]

    def of(self, robot: str, motion: MotionName) -> list[Sweep]:
        """Sweeps of all methods of a motion."""
        return [s for s in self.sweeps.values() if (s.robot, s.motion) == (robot, motion)]


def solve(
    progress: Progress | None = None,
    variant: Variant | None = None,
    fractions: tuple[float, ...] = FRACTIONS,
) -> Study:
    """Generate all runs, and replay some of them in every engine that is installed.

    Args:
        progress: called with the number of finished runs and of all runs.
        variant: what differs from the settings of the experiment.
        fractions: CoM heights as parts of that on straight legs, the largest first.
    """
    variant = variant or BASE
    robots = {name: variant.robot(robot) for name, robot in given_robots().items()}
    keys = [(r, m, how) for r in robots for m in MOTIONS for how in methods_of(r, m)]
    sweeps: dict[SweepKey, Sweep] = {}
    done, total = 0, len(keys) * len(fractions)
    for name, motion, method in keys:
        runs = []
        for fraction in fractions:
            runs.append(run_one(name, robots[name], motion, method, fraction, variant))
            done += 1
            if progress is not None:
                progress(done, total)
        standing = runs if motion == "stand" else sweeps[name, "stand", method].runs
        quiet = next((run for run in standing if run is not None and run.is_feasible), None)
        sweeps[name, motion, method] = Sweep(name, motion, method, tuple(runs), quiet)
    return Study(sweeps, measure(sweeps))
