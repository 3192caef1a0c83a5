"""Support phases: when they begin, and which footsteps the robot stands on in each of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mgs.core.contact import Footstep, Side, Support
from mgs.core.errors import ConfigError
from mgs.core.limits import MAX_SAMPLES
from mgs.motion_planner.motion_plan import Phase

MIN_SAMPLES = 5  # of a phase; with fewer the quintic blend is no longer sampled

Duration = tuple[str, float]  # keys that give it, and the duration itself [s]


def phase_bounds(durations: Sequence[Duration], dt: float) -> list[int]:
    """First sample of every phase, and last sample of the last one.

    Bounds are rounded one by one, so that rounding errors do not add up.

    Raises:
        ConfigError: a phase has too few samples, or all together have too many.
    """
    ends = np.cumsum([0.0, *(seconds for _, seconds in durations)])
    if not ends[-1] / dt <= MAX_SAMPLES:
        raise ConfigError(
            "dt",
            f"{ends[-1]:.0f} s at dt = {dt:g} s are {ends[-1] / dt:.2g} samples; at most "
            f"{MAX_SAMPLES:g} allowed; use a shorter motion or a larger dt",
        )
    samples = np.round(ends / dt).astype(int)
    shortest = int(np.argmin(np.diff(samples)))
    if samples[shortest + 1] - samples[shortest] < MIN_SAMPLES:
        keys, seconds = durations[shortest]
        raise ConfigError(
            keys,
            f"{seconds:g} s is fewer than {MIN_SAMPLES} samples of dt = {dt:g} s; use at least "
            f"{MIN_SAMPLES * dt:g} s or a smaller dt",
        )
    return [int(k) for k in samples]


def step_phases(bounds: list[int], footsteps: tuple[Footstep, ...]) -> tuple[Phase, ...]:
    """Rest, a weight shift and a swing for each footstep, a last weight shift, and rest."""
    feet = (0, 1)
    phases = [Phase(bounds[0], bounds[1], Support.DOUBLE, feet)]
    for target in range(2, len(footsteps)):
        shift, lift, land = bounds[2 * target - 3 : 2 * target]
        swing = footsteps[target].side
        phases.append(Phase(shift, lift, Support.DOUBLE, feet))
        phases.append(Phase(lift, land, Support.single(swing.other), feet, target))
        feet = (target, feet[1]) if swing is Side.LEFT else (feet[0], target)
    phases.append(Phase(bounds[-3], bounds[-2], Support.DOUBLE, feet))
    phases.append(Phase(bounds[-2], bounds[-1] + 1, Support.DOUBLE, feet))
    return tuple(phases)
