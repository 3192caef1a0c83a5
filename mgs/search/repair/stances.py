"""When which sole stands, and where: from how both soles move against each other.

A base that is too low, too high or slides moves both soles alike; it is the legs that tell which
sole stands. While the soles are level and do not move against each other, both stand, else the
lower one. Each time a sole stands it has one place (x, y, yaw) on the floor:

    min over places   sum_i |place_i - median_i|^2 + CHAIN sum_ij |place_j - place_i - way_ij|^2

median_i is where the given motion has the sole, way_ij the way from one sole to the other while
both stand, which a sliding base does not change.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.geometry import wrap_angle
from mgs.core.short_repr import short_repr
from mgs.core.spans import spans
from mgs.judge.audit.body import Body
from mgs.judge.audit.hulls import distance_outside
from mgs.judge.audit.rates import moving_mean
from mgs.motion.dynamics import zmp_at

Bools = NDArray[np.bool_]
# of soles that stand, in lengths of a leg: differences of their heights, and speed per second at
# which they move against each other
LEVEL, TOGETHER = 0.02, 0.16
NEAR = 0.06  # lengths of a leg above the lower sole, up to which a sole that has to bear stands
BEYOND = 0.02  # lengths of a leg outside the other sole
FAST = 3.0  # times `TOGETHER`, at which one sole swings for sure
TREMBLING = 1.5  # times as much where the motion trembled
SHORTEST = 0.06  # [s] a sole stands, or does not
CHAIN = 100.0
LIFTED = 0.03  # [m] of the lower sole above its usual height: the robot is in the air


@dataclass(frozen=True, eq=False)
class Stances:
    """Which soles stand, and the poses that they then have."""

    stands: Bools  # (T, 2)
    places: Array  # (T, 2, 3) x, y [m], yaw [rad]; of meaning where a sole stands

    __repr__ = short_repr


def stances_of(stands: Bools, planar: Array) -> Stances:
    """Stances of soles that stand (T, 2), of their places (T, 2, 3) in the given motion."""
    return Stances(stands, _places(stands, planar))


def planar_places(soles: Array, turns: Array) -> Array:
    """Places x, y [m], yaw [rad] (T, 2, 3) of centres (T, 2, 3) and rotations (T, 2, 3, 3)."""
    yaw = np.unwrap(np.arctan2(turns[..., 1, 0], turns[..., 0, 0]), axis=0)
    return np.concatenate([soles[..., :2], yaw[..., None]], axis=-1)


def standing_soles(body: Body, dt: float, leg: float, blur: float = 0.0) -> Bools:
    """Which soles (T, 2) stand.

    A sole stands too if it is near the floor and the ZMP is clearly outside the other one, so that
    it has to bear; and the other one then does not, however low, if it moves and need not bear.
    While one moves fast against the other, that one stands which is nearer to the ZMP.

    Args:
        body: the motion, its forces averaged over about `blur`.
        dt: sampling period [s].
        leg: length of a leg [m].
        blur: time over which the ways between the soles are averaged, for a motion that trembled.
    """
    width, size = max(1, round(blur / dt)), leg * (TREMBLING if blur else 1.0)
    low = moving_mean(body.corners[..., 2].min(axis=-1), width)
    between = body.soles[:, 1] - body.soles[:, 0]
    way = moving_mean(np.einsum("tji,tj->ti", body.turns[:, 0], between), width)
    apart = np.linalg.norm(np.gradient(way, dt, axis=0), axis=1)
    lowest = low.min(axis=1)
    together = apart < TOGETHER * size
    both = (np.ptp(low, axis=1) < LEVEL * size) & together
    outside = _distances(body)
    bears = (low - lowest[:, None] < NEAR * size) & (outside[:, ::-1] > BEYOND * size)
    swings = bears[:, ::-1] & ~bears & ~together[:, None]  # all the weight is on the other one
    stands = np.asarray(both[:, None] | ((low == lowest[:, None]) & ~swings) | bears)
    fast = apart > FAST * TOGETHER * size
    stands[fast] = (outside == outside.min(axis=1, keepdims=True))[fast]
    stands[lowest > np.median(lowest) + LIFTED] = False
    for side in Side:
        _drop_short(stands[:, side], max(1, round(SHORTEST / dt)))
    return stands


def _distances(body: Body) -> Array:
    """Distances (T, 2) of the ZMP from each sole, negative inside [m]."""
    wrench = body.wrench.copy()
    wrench[:, 2] = np.maximum(wrench[:, 2], 0.2 * np.median(wrench[:, 2]))
    zmp = zmp_at(wrench, body.soles[..., 2].min(axis=1))
    used = np.ones((len(zmp), 4), dtype=bool)
    return np.stack(
        [distance_outside(zmp, body.corners[:, side, :, :2], used) for side in Side], axis=1
    )


def _drop_short(mask: Bools, least: int) -> None:
    """Turn over the spans of a mask (T,) that are shorter than `least`, but for both ends."""
    for value in (False, True):
        for start, end in spans(mask):
            if mask[start] == value and end - start < least and start and end < len(mask):
                mask[start:end] = not value


def _places(stands: Bools, planar: Array) -> Array:
    """Places (T, 2, 3) of the soles while they stand, of their poses (T, 2, 3)."""
    number = np.full(stands.shape, -1)
    means: list[Array] = []
    for side in Side:
        for start, end in spans(stands[:, side]):
            if stands[start, side]:
                number[start:end, side] = len(means)
                means.append(np.median(planar[start:end, side], axis=0))
    if not means:
        return planar.copy()
    n = len(means)
    A, b = np.eye(n), np.array(means)
    pairs = np.unique(number[stands.all(axis=1)], axis=0)
    for i, j in pairs:
        together = (number[:, 0] == i) & (number[:, 1] == j)
        way = planar[together, 1] - planar[together, 0]
        way[:, 2] = wrap_angle(way[:, 2])
        weight = CHAIN * min(1.0, together.sum() / 10.0)
        mean_way = np.median(way, axis=0)
        turn = round((means[j][2] - means[i][2] - mean_way[2]) / (2 * np.pi)) * 2 * np.pi
        mean_way[2] += turn
        A[i, i] += weight
        A[j, j] += weight
        A[i, j] -= weight
        A[j, i] -= weight
        b[j] += weight * mean_way
        b[i] -= weight * mean_way
    found = np.linalg.solve(A, b)
    places = planar.copy()
    places[number >= 0] = found[number[number >= 0]]
    return places
