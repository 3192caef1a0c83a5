"""The zero-moment point (ZMP) of the whole robot against the corners of the soles in contact.

The distance of a point z from the convex hull of points p_i is, over all directions n,

    max_n [ n . z - max_i n . p_i ]

which `N_DIRECTIONS` of them give within 0.1 %. Nothing is said of samples at which another part
than the soles touches the ground, soles touch at unequal heights, or the robot may be in flight.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.judge.audit.body import Body
from mgs.judge.audit.contacts import Bools, Contacts
from mgs.judge.audit.finding import Finding, findings_where
from mgs.judge.audit.given import GivenMotion

ZMP_LIMIT = 0.005  # [m] outside
ZMP_TIME = 0.06  # [s] that it has to stay outside, since changes of contact are found with delay
N_DIRECTIONS = 72


def judged_samples(contacts: Contacts) -> Bools:
    """Samples (T,) at which the ZMP has a polygon to be in."""
    touching = contacts.soles.any(axis=1)
    return np.asarray(touching & contacts.supported & contacts.level & ~contacts.others)


def zmp_findings(given: GivenMotion, body: Body, contacts: Contacts) -> list[Finding]:
    """Spans in which the ZMP is outside the soles in contact."""
    outside = distance_outside(
        contacts.zmp,
        body.corners[..., :2].reshape(given.n_samples, -1, 2),
        contacts.corners.reshape(given.n_samples, -1),
    )
    bad = judged_samples(contacts) & (outside > ZMP_LIMIT)
    return findings_where(
        "zmp", outside, ZMP_LIMIT, given.dt, "m", lambda k: _support(contacts, k), bad, ZMP_TIME
    )


def distance_outside(points: Array, corners: Array, used: Bools) -> Array:
    """Distance (T,) of points (T, 2) from the hull of the used ones of corners (T, c, 2) [m].

    Negative inside; minus infinity where no corner is used.
    """
    turn = 2.0 * np.pi * np.arange(N_DIRECTIONS) / N_DIRECTIONS
    n = np.stack([np.cos(turn), np.sin(turn)])  # (2, d)
    reach = np.where(used[..., None], corners @ n, -np.inf).max(axis=1)
    distance = (points @ n - reach).max(axis=1)
    return np.where(used.any(axis=1), distance, -np.inf)


def _support(contacts: Contacts, k: int) -> str:
    left, right = contacts.soles[k]
    return "double support" if left and right else f"{'left' if left else 'right'} support"
