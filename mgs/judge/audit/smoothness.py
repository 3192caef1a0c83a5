"""Jitter and jumps: what a motion does from sample to sample that no servo could follow.

Jitter. Of white noise with standard deviation s added to a smooth signal, the fourth differences
d_k have variance 70 s^2 and E[d_k d_k+1] = -56 s^2, while those of the signal itself are alike from
one sample to the next, so that their product is positive. Over a window therefore

    s^2 is about max(0, - mean(d_k d_k+1)) / 56

and it counts where -mean(d_k d_k+1) is more than `ALTERNATION` of the mean of d_k^2, 0.8 for white
noise and at most 0.5 where the acceleration alone has a step.

Jump. A coordinate that jumps by J at one step has J + motion as its step there and the motion alone
before and after: J is the step less the median of its neighbours. It counts where it is large by
itself, and many times what the coordinate does elsewhere nearby.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from mgs.core.arrays import Array
from mgs.judge.audit.body import Body
from mgs.judge.audit.finding import Finding, findings_where
from mgs.judge.audit.given import GivenMotion
from mgs.judge.audit.rates import moving_mean

JITTER_TIME = 0.3  # [s] over which noise is averaged
JITTER_SAMPLES = 15  # at least
ALTERNATION = 0.55
JITTER_LIMIT = 2e-3  # [rad], and [m] for the place of the base
JITTER_ACCELERATION = 3.0  # [rad/s^2] and [m/s^2]: what kinks of an acceleration may look like
JUMP_LIMIT = 0.05  # [rad]
BASE_JUMP_LIMIT = 0.015  # [m]
JUMP_RATIO = 5.0  # to the largest unevenness nearby
NEIGHBOURS = 3  # steps on either side
NEARBY = 12  # steps on either side


def smoothness_findings(given: GivenMotion, body: Body) -> list[Finding]:
    """Coordinates that tremble or jump."""
    names = [*("base x", "base y", "base z"), *("base rotation",) * 3, *given.robot.joint_names]
    limits = np.full(len(names), JUMP_LIMIT)
    limits[:3] = BASE_JUMP_LIMIT
    return [*_jumps(given, body.steps, names, limits), *_jitter(given, body.steps, names)]


def jump_sizes(steps: Array) -> tuple[Array, Array]:
    """By how much each step (M, m) stands out from its neighbours, and its ratio to those nearby.

    Ends have fewer neighbours: their windows are filled with the outermost steps.
    """
    stands_out = np.abs(steps - _median_around(steps, NEIGHBOURS))
    padded = np.pad(stands_out, ((NEARBY, NEARBY), (0, 0)))
    windows = sliding_window_view(padded, 2 * NEARBY + 1, axis=0).copy()
    windows[..., NEARBY - 1 : NEARBY + 2] = 0.0  # a step, and the two that it makes uneven
    return stands_out, stands_out / np.maximum(windows.max(axis=-1), 1e-9)


def _median_around(steps: Array, reach: int) -> Array:
    padded = np.pad(steps, ((reach, reach), (0, 0)), mode="edge")
    windows = sliding_window_view(padded, 2 * reach + 1, axis=0)
    others = np.delete(windows, reach, axis=-1)
    return np.asarray(np.median(others, axis=-1))


def _jumps(given: GivenMotion, steps: Array, names: list[str], limits: Array) -> list[Finding]:
    sizes, ratios = jump_sizes(steps)
    bad = (sizes > limits) & (ratios > JUMP_RATIO)
    found = []
    for j in np.flatnonzero(bad.any(axis=0)):
        unit = "m" if j < 3 else "rad"
        found += findings_where("jump", sizes[:, j], limits[j], given.dt, unit, names[j], bad[:, j])
    return found


def noise(steps: Array, dt: float) -> Array:
    """Standard deviation (M - 4, m) of the noise on coordinates with these steps (M, m)."""
    fourth = np.diff(steps, n=3, axis=0)
    width = max(JITTER_SAMPLES, round(JITTER_TIME / dt))
    power = moving_mean(0.5 * (fourth[1:] ** 2 + fourth[:-1] ** 2), width)
    opposed = -moving_mean(fourth[1:] * fourth[:-1], width)
    return np.where(opposed > ALTERNATION * power, np.sqrt(np.maximum(opposed, 0.0) / 56.0), 0.0)


def _jitter(given: GivenMotion, steps: Array, names: list[str]) -> list[Finding]:
    if len(steps) < 5 + JITTER_SAMPLES:
        return []
    calm = _without_jumps(steps)
    sizes = np.pad(noise(calm, given.dt), ((2, 3), (0, 0)), mode="edge")
    found, limit = [], JITTER_LIMIT + JITTER_ACCELERATION * given.dt**2
    for j in np.flatnonzero((sizes > limit).any(axis=0)):
        unit = "m" if j < 3 else "rad"
        found += findings_where("jitter", sizes[:, j], limit, given.dt, unit, names[j])
    return found


def _without_jumps(steps: Array) -> Array:
    """Steps (M, m), the ones that jump replaced by the median of their neighbours."""
    sizes, ratios = jump_sizes(steps)
    jumps = (sizes > 0.3 * JUMP_LIMIT) & (ratios > JUMP_RATIO)
    return np.where(jumps, _median_around(steps, NEIGHBOURS), steps)
