"""The zero-moment point (ZMP) of the whole robot against the corners of the soles in contact.

Nothing is said of samples at which another part than the soles touches the ground, soles touch at
unequal heights, or the robot may be in flight.
"""

from __future__ import annotations

import numpy as np

from mgs.judge.audit.body import Body
from mgs.judge.audit.contacts import Bools, Contacts
from mgs.judge.audit.finding import Finding, findings_where
from mgs.judge.audit.given import GivenMotion
from mgs.judge.audit.hulls import distance_outside

ZMP_LIMIT = 0.005  # [m] outside
ZMP_TIME = 0.06  # [s] that it has to stay outside, since changes of contact are found with delay


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


def _support(contacts: Contacts, k: int) -> str:
    left, right = contacts.soles[k]
    return "double support" if left and right else f"{'left' if left else 'right'} support"
