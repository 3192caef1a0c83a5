"""Figures of a motion before and after its repair, without any limit of the audit."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.judge.audit import GivenMotion
from mgs.judge.audit.balance import judged_samples
from mgs.judge.audit.body import Body, body_along
from mgs.judge.audit.contacts import Contacts, find_contacts
from mgs.judge.audit.ground import SLIP_TIME, sole_speed, throughout
from mgs.judge.audit.hulls import distance_outside
from mgs.judge.audit.smoothness import noise
from mgs.judge.audit.tree import JointPoses, joint_poses
from mgs.robot import leg_length

LEANING = 0.1  # lengths of a leg


@dataclass(frozen=True)
class Figures:
    """What is wrong with a motion, by how much at most.

    The soles do not bear the robot where another part touches the floor and the ZMP is far outside
    the soles, or none touches.
    """

    penetration: float  # of a sole [m]
    slip: float  # fastest sole that bears the robot, over 0.1 s [m/s]
    range_excess: float  # of a joint [rad]
    speed_ratio: float  # fastest joint, in parts of its limit
    zmp_outside: float  # part of the time, of that in which soles alone bear the robot
    zmp_distance: float  # farthest outside [m]
    jitter: float  # largest noise of a joint [rad]
    judged: float  # part of the time in which the ZMP is judged
    off_soles: float  # part of the time in which the soles do not bear the robot, see below

    def to_dict(self) -> dict[str, float]:
        """The figures as plain data."""
        return asdict(self)


def figures_of(given: GivenMotion) -> Figures:
    """Figures of a motion."""
    robot, body = given.robot, body_along(given)
    contacts = find_contacts(given, body)
    outside = distance_outside(
        contacts.zmp,
        body.corners[..., :2].reshape(given.n_samples, -1, 2),
        contacts.corners.reshape(given.n_samples, -1),
    )
    judged = judged_samples(contacts)
    touching = contacts.soles.any(axis=1)
    off = contacts.others & (~touching | (outside > LEANING * leg_length(robot)))
    n_judged = max(1, int(judged.sum()))
    excess = np.maximum(robot.lower - given.joints, given.joints - robot.upper)
    speed = np.abs(np.diff(given.joints, axis=0)) / given.dt / robot.speed_limit
    trembling = noise(np.diff(given.joints, axis=0), given.dt)
    return Figures(
        penetration=max(0.0, -float(body.clearance.min())),
        slip=max(_slip(given, body, contacts, side) for side in Side),
        range_excess=max(0.0, float(excess.max())),
        speed_ratio=float(speed.max()),
        zmp_outside=float(np.count_nonzero(judged & (outside > 0.0))) / n_judged,
        zmp_distance=max(0.0, float(np.max(outside, where=judged, initial=0.0))),
        jitter=float(trembling.max(initial=0.0)),
        judged=float(judged.mean()),
        off_soles=float(off.mean()),
    )


def _slip(given: GivenMotion, body: Body, contacts: Contacts, side: Side) -> float:
    width = max(1, round(SLIP_TIME / given.dt))
    if given.n_samples <= width:
        return 0.0
    whole = throughout(contacts.bearing[:, side], width)
    speed = sole_speed(body, contacts, side, width, given.dt)
    return float(np.max(speed, where=whole, initial=0.0))


def link_distance(given: GivenMotion, other: GivenMotion) -> float:
    """Root mean square distance of all links of two motions, over all samples [m]."""
    ours, theirs = joint_poses(given.robot, given.q), joint_poses(given.robot, other.q)
    return float(np.sqrt(np.mean(_squares(ours, theirs))))


def _squares(ours: JointPoses, theirs: JointPoses) -> Array:
    return np.asarray(np.sum((ours.p[1:] - theirs.p[1:]) ** 2, axis=-1))
