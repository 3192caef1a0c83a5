"""Contacts found from the motion: which corners of the soles touch, and which sole bears how much.

A corner is in contact from when it comes within `NEAR` of the ground until it is farther than
`AWAY` from it, however deep it is. A swing foot skims the ground before it lands and after it has
lifted off, and bears nothing then: a sole has to bear only if the zero-moment point (ZMP) is not
inside the other one. How much it bears follows from where the ZMP is between both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import GRAVITY
from mgs.core.contact import Side
from mgs.core.short_repr import short_repr
from mgs.judge.audit.body import Body
from mgs.judge.audit.given import GivenMotion
from mgs.judge.audit.hulls import distance_outside
from mgs.motion.dynamics import zmp_at

Bools = NDArray[np.bool_]

NEAR, AWAY = 0.004, 0.006  # [m] above the ground
CLEARLY = 0.003  # [m] outside the other sole
WEIGHTLESS = 0.3  # of the weight, below which the robot may be in flight


@dataclass(frozen=True, eq=False)
class Contacts:
    """What touches the ground at every sample."""

    corners: Bools  # (T, 2, 4) corners of the soles in contact
    others: Bools  # (T,) whether a part other than the feet touches the ground
    lowest: Array  # (T,) height of the lowest point of the robot above the ground [m]
    supported: Bools  # (T,) whether the ground has to bear a good part of the weight
    zmp: Array  # (T, 2) at the height of the contacts [m]
    load: Array  # (T, 2) shares of the load on both soles, zero where neither touches
    bearing: Bools  # (T, 2) whether a sole has to bear a part of the weight: see below
    level: Bools  # (T,) whether all corners in contact are at about the same height

    __repr__ = short_repr

    @property
    def soles(self) -> Bools:
        """Whether each sole (T, 2) touches the ground."""
        return np.asarray(self.corners.any(axis=2))


def find_contacts(given: GivenMotion, body: Body) -> Contacts:
    """Contacts of a motion along its ground."""
    robot = given.robot
    corners = hysteresis(body.clearance < NEAR, body.clearance < AWAY)
    feet = {robot.model.frames[robot.sole_frames[side]].parentJoint for side in Side}
    other = [g for g, o in enumerate(robot.geometry.geometryObjects) if o.parentJoint not in feet]
    rest = body.heights[:, other]
    lowest_rest = rest.min(axis=1) if other else np.full(given.n_samples, np.inf)
    lowest_sole = body.clearance.min(axis=(1, 2))
    # the shank of a robot that is too low is no knee on the floor: its soles are far lower
    is_low = lowest_rest < lowest_sole + AWAY
    others = hysteresis(is_low & (lowest_rest < NEAR), is_low & (lowest_rest < AWAY))
    lowest = np.minimum(lowest_sole, lowest_rest)
    weight = GRAVITY * robot.mass
    supported = body.wrench[:, 2] > WEIGHTLESS * weight
    soles = np.asarray(corners.any(axis=2))
    bottoms = np.where(corners, body.corners[..., 2], np.nan)
    height = np.nan_to_num(_mean_of(bottoms.reshape(len(bottoms), -1)))
    # below, the ZMP of a robot in flight is never used; its division must not warn
    wrench = body.wrench.copy()
    wrench[:, 2] = np.maximum(wrench[:, 2], 0.1 * weight)
    zmp = zmp_at(wrench, height)
    spread = np.where(corners, body.corners[..., 2], height[:, None, None])
    level = np.ptp(spread.reshape(len(spread), -1), axis=1) < AWAY
    load = _loads(body, zmp, soles)
    bearing = soles & _beyond_the_other(body, corners, zmp) & (supported & ~others)[:, None]
    return Contacts(corners, others, lowest, supported, zmp, load, bearing, level)


def hysteresis(on: Bools, stays: Bools) -> Bools:
    """Where (T, ...) something holds that begins with `on` and lasts as long as `stays`.

    A span of `stays` counts wholly if `on` is true anywhere in it.
    """
    flat_on, flat_stays = on.reshape(len(on), -1), stays.reshape(len(on), -1)
    held: Bools = np.zeros_like(flat_on)
    for column in np.flatnonzero(flat_on.any(axis=0)):
        keeps = flat_stays[:, column]
        label = np.cumsum(np.diff(keeps, prepend=False) & keeps) * keeps
        touched = np.unique(label[flat_on[:, column]])
        held[:, column] = np.isin(label, touched[touched > 0])
    return held.reshape(on.shape)


def _mean_of(values: Array) -> Array:
    """Means (T,) of the numbers in rows (T, m), NaN left out; NaN where there are none."""
    known = ~np.isnan(values)
    total = np.where(known, values, 0.0).sum(axis=1)
    return np.asarray(total / np.where(known.any(axis=1), known.sum(axis=1), np.nan))


def _beyond_the_other(body: Body, corners: Bools, zmp: Array) -> Bools:
    """Whether the ZMP is clearly outside the corners of the other sole that touch, (T, 2)."""
    flat = body.corners[..., :2]
    outside = [distance_outside(zmp, flat[:, 1 - side], corners[:, 1 - side]) for side in Side]
    alone = ~np.asarray(corners.any(axis=2))[:, ::-1]
    return np.asarray((np.stack(outside, axis=1) > CLEARLY) | alone)


def _loads(body: Body, zmp: Array, soles: Bools) -> Array:
    """Shares (T, 2): by the place of the ZMP between both soles, all on one that touches alone."""
    left, right = body.soles[:, 0, :2], body.soles[:, 1, :2]
    way = left - right
    part = np.sum((zmp - right) * way, axis=1) / np.maximum(np.sum(way**2, axis=1), 1e-9)
    part = np.clip(part, 0.0, 1.0)
    share = np.stack([part, 1.0 - part], axis=1)
    share[soles[:, 0] & ~soles[:, 1]] = [1.0, 0.0]
    share[soles[:, 1] & ~soles[:, 0]] = [0.0, 1.0]
    share[~soles.any(axis=1)] = 0.0
    return share
