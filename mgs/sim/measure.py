"""Figures of a replay from the poses at its samples; arrays in the world frame, SI units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.geometry import wrap_angle, yaw_from_quat_xyzw
from mgs.core.spans import spans

LANDED = 0.05  # of the weight that a sole bears when it has landed
TOUCHDOWN = 0.02  # [s] at both ends of a support phase that are left out of its slip


@dataclass(frozen=True)
class Slip:
    """The largest horizontal displacement of a sole within one of its support phases."""

    distance: float = 0.0  # [m]
    side: Side | None = None
    sample: int | None = None


def largest_slip(soles: Array, planned: Array, support: NDArray[np.int8], dt: float) -> Slip:
    """Slip of soles (M, 2, 7) against planned poses (M, 2, 7) under the planned support (M,).

    A phase is measured from shortly after its planned beginning to shortly before its planned end,
    because touchdown and take-off come a little early or late in physics.
    """
    margin = round(TOUCHDOWN / dt)
    worst = Slip()
    for side in Side:
        carries = np.isin(support, (Support.DOUBLE, Support.single(side)))
        for start, end in _runs(carries):
            start, end = start + margin, end - margin
            if end <= start:
                continue
            away = soles[start:end, side, :2] - planned[start:end, side, :2]
            path = away - away[0]  # the centre of a sole that rolls moves by plan
            lengths = np.linalg.norm(path, axis=1)
            k = int(lengths.argmax())
            if lengths[k] > worst.distance:
                worst = Slip(float(lengths[k]), side, start + k)
    return worst


@dataclass(frozen=True)
class Touchdowns:
    """When swing soles meet the ground, against the plan; late is positive [s]."""

    n: int  # planned within the replay
    earliest: float = 0.0
    latest: float = 0.0


def touchdowns(contacts: Array, support: NDArray[np.int8], dt: float) -> Touchdowns:
    """Touchdowns of soles with contacts (M, 2, 5) under the planned support (M,).

    A sole has landed when it bears `LANDED` of the weight, from the middle of its planned swing on;
    one that has not until the middle of its next swing counts as that late.
    """
    vertical = contacts[:, :, 2]
    landed = vertical > LANDED * vertical.sum(axis=1).mean()
    late = []
    for side in Side:
        swings = _runs(support == Support.single(side.other))
        for i, (start, end) in enumerate(swings):
            if end >= len(support):
                continue
            begin = (start + end) // 2
            stop = sum(swings[i + 1]) // 2 if i + 1 < len(swings) else len(support)
            late.append((begin + int(np.argmax([*landed[begin:stop, side], True])) - end) * dt)
    return Touchdowns(len(late), min(late, default=0.0), max(late, default=0.0))


def _runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and past-the-last index of every stretch of True in mask (M,), which may be empty."""
    return [(start, end) for start, end in spans(mask) if mask[start]] if len(mask) else []


def travel(soles: Array) -> Array:
    """Displacement (x, y, yaw) from the first to the last of soles (M, 2, 7).

    Of the midpoint between the soles in x and y, of their mean heading in yaw.
    """
    shift = soles[-1, :, :2].mean(axis=0) - soles[0, :, :2].mean(axis=0)
    headings = yaw_from_quat_xyzw(soles[[0, -1], :, 3:])
    left, right = wrap_angle(headings[1] - headings[0])
    turn = left + 0.5 * wrap_angle(right - left)  # the mean on the side where both soles are
    return np.array([*shift, float(wrap_angle(turn))])


def angle_between(a: Array, b: Array) -> Array:
    """Angle (...) [rad] between unit vectors (..., 3); exact near zero."""
    return np.asarray(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.sum(a * b, axis=-1)))
