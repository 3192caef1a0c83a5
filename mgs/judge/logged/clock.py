"""Where a motion begins on the clock of a log that may have been started at any time.

The speeds of the joints are correlated, since speeds know nothing of offsets. At a start s the
agreement of a log with a plan that rests before its beginning and after its end is

    R(s) = sum_j w_j <y_j', c_j'> / sqrt(sum_j w_j <y_j', y_j'>  sum_j w_j <c_j', c_j'>)

where c' is taken at t - s, over the time of the log: 1 for the same curves, and lower where the log
shows movement that the plan does not have, or the other way round. A walk resembles itself one
stride later, and a log of its middle does not tell which stride it was: such a log is refused.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import LogError

GRID = 0.01  # [s] of the correlation
SMOOTH = 5  # samples of the grid, a moving average over noise and ticks
MOVES = np.radians(2.0)  # [rad] range of a joint that is looked at
LEAST_TIME = 1.0  # [s] of movement in a log
LEAST_SAMPLES = 30  # of a joint
LEAST_RATE = 5.0  # [Hz] of the samples of a joint
LEAST_AGREEMENT = 0.8
LEAST_SHARE = 0.05  # of the movement of the plan that a log has to show
AGAINST = 0.5  # correlation of a joint that is mounted the wrong way round, negative
APART = 0.15  # [s] between two different starts
RIVAL = 1.5  # times as far from 1 as the best agreement: a start that cannot be told from it
NOISE = 0.005  # of an agreement
IN_DEGREES = 20.0  # slope of angles in degrees over angles in radians is 57


@dataclass(frozen=True)
class Start:
    """Where a motion begins on the clock of a log."""

    time: float  # [s]
    agreement: float  # R there
    rival: float  # the best agreement at another start; -1: there is none
    rival_time: float  # [s]


def find_start(times: Array, position: Array, plan: Array, dt: float) -> Start:
    """Find the start of a plan in a log.

    Args:
        times: of the log (M,) [s].
        position: measured angles (M, j) [rad]; NaN where nothing was read.
        plan: angles that the joints were told (N, j) at k dt [rad].
        dt: sampling period of the plan [s].

    Raises:
        LogError: the log is too short or too coarse, shows another motion, or fits at two starts.
    """
    refuse_poor(times, position)
    moving = np.flatnonzero(np.ptp(plan, axis=0) > MOVES)
    if not len(moving):
        raise LogError("no joint that is in the log moves by more than 2 deg in the motion")
    grid = np.arange(times[0], times[-1], GRID)
    y = np.stack([_speed(_on_grid(times, position[:, j], grid)) for j in moving], axis=1)
    plan_times = np.arange(0.0, (len(plan) - 1) * dt + GRID, GRID)
    sampled = [np.interp(plan_times, dt * np.arange(len(plan)), plan[:, j]) for j in moving]
    c = np.stack([_speed(values) for values in sampled], axis=1)
    _refuse_still(y)
    scale = np.sqrt((c**2).mean(axis=0))
    agreement, starts = _agreement(y / scale, c / scale, grid[0])
    best = int(agreement.argmax())
    y = y * _turns(y, c, round((starts[best] - grid[0]) / GRID))
    agreement, starts = _agreement(y / scale, c / scale, grid[0])
    best = int(agreement.argmax())
    _refuse_other_motion(y, c, round((starts[best] - grid[0]) / GRID), agreement[best])
    others = np.abs(starts - starts[best]) > APART
    inner = np.r_[False, (agreement[1:-1] >= agreement[:-2]) & (agreement[1:-1] >= agreement[2:])]
    peaks = np.flatnonzero(others & np.r_[inner, False])
    rival = int(peaks[agreement[peaks].argmax()]) if len(peaks) else None
    start = Start(
        time=float(starts[best]),
        agreement=float(agreement[best]),
        rival=-1.0 if rival is None else float(agreement[rival]),
        rival_time=0.0 if rival is None else float(starts[rival]),
    )
    if 1.0 - start.rival < RIVAL * (1.0 - start.agreement) + NOISE:
        raise LogError(
            f"the motion fits the log from {start.time:.2f} s on (agreement {start.agreement:.3f}) "
            f"and from {start.rival_time:.2f} s on ({start.rival:.3f}); give --start, or log from "
            "before the beginning to the end"
        )
    return start


def refuse_poor(times: Array, position: Array) -> None:
    """Raise LogError for a log that is too short or too coarse."""
    read = np.isfinite(position).sum(axis=0)
    span = float(times[-1] - times[0])
    if span < LEAST_TIME or read.max() < LEAST_SAMPLES:
        raise LogError(
            f"the log is too short: {span:.2f} s and at most {read.max()} samples of a joint; at "
            f"least {LEAST_TIME:g} s and {LEAST_SAMPLES} samples are needed"
        )
    if read.max() / span < LEAST_RATE:
        raise LogError(
            f"the log is too coarse: {read.max() / span:.1f} samples of a joint in a second; at "
            f"least {LEAST_RATE:g} are needed"
        )


def _on_grid(times: Array, values: Array, grid: Array) -> Array:
    read = np.isfinite(values)
    if not read.any():
        return np.zeros_like(grid)
    return np.asarray(np.interp(grid, times[read], values[read]))


def _speed(values: Array) -> Array:
    """Smoothed derivative (N,) of values (N,) on the grid."""
    padded = np.pad(values, SMOOTH // 2, mode="edge")
    smooth = np.convolve(padded, np.full(SMOOTH, 1.0 / SMOOTH), mode="valid")
    return np.asarray(np.gradient(smooth, GRID))


def _agreement(y: Array, c: Array, first: float) -> tuple[Array, Array]:
    """Agreements (L,) and the starts (L,) [s] that they are of; y (M, j) and c (N, j) speeds."""
    from scipy.signal import correlate

    both = sum(correlate(y[:, j], c[:, j], method="fft") for j in range(y.shape[1]))
    inside = correlate(np.ones(len(y)), (c**2).sum(axis=1), method="fft")
    energy = float((c**2).sum())
    seen = np.maximum(inside, LEAST_SHARE * energy)
    shifts = np.arange(-(len(c) - 1), len(y))
    agreement = np.asarray(both / np.sqrt((y**2).sum() * seen), dtype=np.float64)
    return agreement, np.asarray(first + GRID * shifts, dtype=np.float64)


def _refuse_still(y: Array) -> None:
    moving = np.abs(y).max(axis=1) > MOVES  # [rad/s], as slow as a range of 2 deg in a second
    if moving.sum() * GRID < LEAST_TIME / 2.0:
        raise LogError("the robot hardly moves in the log: there is nothing to compare")


def _turns(y: Array, c: Array, shift: int) -> Array:
    """-1 for joints (j,) that turn against their command while the others follow theirs, else 1."""
    here = np.arange(max(0, shift), min(len(y), shift + len(c)))
    both = (y[here] * c[here - shift]).sum(axis=0)
    size = np.sqrt((y[here] ** 2).sum(axis=0) * (c[here - shift] ** 2).sum(axis=0))
    return np.where(both < -AGAINST * size, -1.0, 1.0)


def _refuse_other_motion(y: Array, c: Array, shift: int, agreement: float) -> None:
    """Raise LogError for a log that shows something else, or is in degrees."""
    here = np.arange(max(0, shift), min(len(y), shift + len(c)))
    seen, told = y[here], c[here - shift]
    slope = float((seen * told).sum() / max((told**2).sum(), 1e-12))
    if slope > IN_DEGREES:
        raise LogError(
            f"the joints turn {slope:.0f} times as far as in the motion: if the log is in degrees, "
            "add --degrees"
        )
    if agreement < LEAST_AGREEMENT:
        raise LogError(
            f"the log does not show this motion: the best agreement of the speeds is "
            f"{agreement:.2f}, at least {LEAST_AGREEMENT:g} is needed"
        )
