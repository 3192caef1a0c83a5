"""Figures of one joint of a physical robot from its angles under load.

The law of mgs.robot.unit, with the delay d of command and answer:

    y(t + d) = sign c(t) + zero_offset - load(t) / stiffness - (backlash / 2) side(t)

load is the torque that the plan predicts and, where robot.yaml describes the servos, their friction
and damping, which make a servo lag too. Offset, compliance and play are the most probable ones
under what is known before (`Prior`) and independent errors of the samples of `MEMORY` seconds each;
the delay is the one that leaves the smallest error. A figure that the log says little about stays
at what was known before.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array

MEMORY = 1.0  # [s] over which errors of a log depend on one another
DELAYS = (-0.1, 0.5)  # [s] that are looked at
DELAY_STEP = 0.005  # [s] of the first look
MOVES = np.radians(1.0)  # [rad] range of a joint whose delay can be seen
LEARNED = 0.5  # part of the uncertainty before that may be left of a figure that was measured
OFFSET, BACKLASH = np.radians(3.0), np.radians(0.5)  # [rad] uncertainty before
STIFFNESS = 0.3  # relative uncertainty of the described stiffness
LEAST_NOISE = np.radians(0.02)  # [rad]


@dataclass(frozen=True)
class Prior:
    """What is known of the compliance of a joint before [rad/(N m)]."""

    compliance: float
    uncertainty: float


@dataclass(frozen=True, eq=False)
class Curves:
    """What a joint was told and carried, at the samples k dt of the plan."""

    dt: float  # [s]
    command: Array  # (N,) [rad]
    load: Array  # (N,) [N m]
    side: Array  # (N,) on which side the teeth lie, -1 to 1

    def at(self, times: Array) -> tuple[Array, Array, Array]:
        """Command, load and side (M,) at times (M,) [s]; before and after, as at the ends."""
        own = self.dt * np.arange(len(self.command))
        command, load, side = (
            np.interp(times, own, values) for values in (self.command, self.load, self.side)
        )
        return command, load, side


@dataclass(frozen=True)
class JointFit:
    """Figures of a joint; angles [rad], times [s]."""

    sign: int
    delay: float | None  # None: the joint moves too little
    zero_offset: float
    backlash: float
    compliance: float  # [rad/(N m)]
    compliance_error: float  # its standard error
    backlash_error: float
    knows_compliance: bool  # whether the log says more of it than was known before
    knows_backlash: bool
    left: float  # RMS of what the law does not explain
    samples: int
    delay_at_edge: bool  # of the delays that were looked at, so that it may well be beyond


def fit_joint(
    times: Array, position: Array, curves: Curves, prior: Prior, delay: float | None = None
) -> JointFit:
    """Fit the law to a joint.

    Args:
        times: on the clock of the plan (M,) [s].
        position: measured angles (M,) [rad].
        curves: what the joint was told and carried.
        prior: what is known of its compliance.
        delay: [s], if it is known; None: it is looked for.
    """
    sign = _sign(times, position, curves)
    sought = delay is None and float(np.ptp(curves.command)) > MOVES
    at = 0.0 if delay is None else delay
    if sought:
        at = _best_delay(times, position, curves, prior, sign)
    values, errors, left, known = _fit(times - at, position, curves, prior, sign)
    return JointFit(
        sign=sign,
        delay=at if sought or delay is not None else None,
        zero_offset=float(values[0]),
        backlash=2.0 * float(values[2]),
        compliance=float(values[1]),
        compliance_error=float(errors[1]),
        backlash_error=2.0 * float(errors[2]),
        knows_compliance=known[0],
        knows_backlash=known[1],
        left=left,
        samples=len(position),
        delay_at_edge=sought and not DELAYS[0] < at < DELAYS[1],
    )


def _sign(times: Array, position: Array, curves: Curves) -> int:
    """-1 if the joint turns against its command."""
    command = curves.at(times)[0]
    a, b = command - command.mean(), position - position.mean()
    size = float(np.sqrt((a @ a) * (b @ b)))
    return -1 if size > 0.0 and np.ptp(command) > MOVES and float(a @ b) < -0.5 * size else 1


def _best_delay(times: Array, position: Array, curves: Curves, prior: Prior, sign: int) -> float:
    """Delay [s] that leaves the smallest error, between samples too."""
    from scipy.optimize import minimize_scalar

    def left(delay: float) -> float:
        return _fit(times - delay, position, curves, prior, sign)[2]

    looked_at = np.arange(DELAYS[0], DELAYS[1] + DELAY_STEP / 2.0, DELAY_STEP)
    best = float(looked_at[int(np.argmin([left(float(delay)) for delay in looked_at]))])
    bounds = (best - DELAY_STEP, best + DELAY_STEP)
    found = minimize_scalar(left, bounds=bounds, method="bounded", options={"xatol": 1e-5})
    return float(found.x)


def _fit(
    times: Array, position: Array, curves: Curves, prior: Prior, sign: int
) -> tuple[Array, Array, float, tuple[bool, bool]]:
    """Offset, compliance and half the play (3,); errors; RMS left; which of the last two are known.

    What stays uncertain, or would be negative, is put back to what was known before, and the rest
    is fitted again; but a compliance that is negative for certain is 0.
    """
    command, load, side = curves.at(times)
    A = np.stack([np.ones_like(load), -load, -side], axis=1)
    y = position - sign * command
    mean = np.array([0.0, prior.compliance, 0.0])
    before = np.array([OFFSET, prior.uncertainty, 0.5 * BACKLASH])
    share = min(1.0, max(float(np.ptp(times)) / MEMORY, 3.0) / len(y))  # of independent samples
    free, rigid = np.array([True, True, True]), False
    while True:
        values, errors, left = _most_probable(A, y, mean, before, free, share)
        doubt = np.where(values < 0.0, np.inf, errors / before)
        doubt[0] = 0.0
        doubt[~free] = 0.0
        worst = int(doubt.argmax())
        if doubt[worst] <= LEARNED:
            return values, errors, left, (bool(free[1]) or rigid, bool(free[2]))
        free[worst] = False
        if worst == 1 and values[1] < 0.0 and errors[1] <= LEARNED * before[1]:
            mean[1], rigid = 0.0, True


def _most_probable(
    A: Array, y: Array, mean: Array, before: Array, free: NDArray[np.bool_], share: float
) -> tuple[Array, Array, float]:
    """Most probable values (3,), their errors (3,), and the RMS of what is left of y (M,)."""
    values, errors = mean.copy(), before.copy()
    rest = y - A[:, ~free] @ mean[~free]
    noise = max(float(np.std(y)), LEAST_NOISE)
    for _ in range(3):  # the noise is what the last fit left
        weight = share / noise**2
        H = weight * A[:, free].T @ A[:, free] + np.diag(before[free] ** -2.0)
        g = weight * A[:, free].T @ rest + mean[free] / before[free] ** 2
        values[free] = np.linalg.solve(H, g)
        errors[free] = np.sqrt(np.diag(np.linalg.inv(H)))
        left = float(np.sqrt(np.mean((y - A @ values) ** 2)))
        noise = max(left, LEAST_NOISE)
    return values, errors, left
