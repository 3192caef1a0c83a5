"""A motion of mgs made of one that somebody recorded: contacts found, nothing planned.

References are what the robot does, so that no check of tracking is made. A sole is in support where
it is flat on the floor and still; where neither is, that which touches and bears most of the load.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Footstep, Side, Support
from mgs.core.geometry import yaw_from_quat_xyzw
from mgs.core.plugins import Origin
from mgs.core.spans import spans
from mgs.gait import RecordedGait
from mgs.gait.recorded import RecordedParameters
from mgs.judge.audit.body import Body, body_along
from mgs.judge.audit.contacts import Contacts, find_contacts
from mgs.judge.recorded.placed import Placed
from mgs.motion import Motion
from mgs.motion.dynamics import analyse
from mgs.motion.provenance import Provenance

STILL = 0.005  # [m/s] of a corner of a sole in support
FLAT = 1e-3  # [m] that each of its corners is above the floor at most
MOST_OF_THE_LOAD = 0.5
UNBALANCED = 0.02  # part of the time in which no sole, or something else, touches the floor


def motion_of(placed: Placed, layout: str, source: str, version: str, name: str) -> Motion:
    """Motion of mgs with the positions of a recorded one.

    Args:
        placed: the motion on its robot.
        layout: of the file that it is from.
        source: name of that file.
        version: of mgs.
        name: of the motion.
    """
    given = placed.given
    body = body_along(given)
    contacts = find_contacts(given, body)
    support = supports(body, contacts, given.dt)
    on_soles = contacts.soles.any(axis=1) & ~contacts.others
    balanced = bool(np.mean(~on_soles) <= UNBALANCED)
    whole = analyse(given.robot, given.q, given.dt, _load_left(support, contacts))
    v = whole.v.copy()
    v[[0, -1]] = 0.0  # as in every motion file: the robot rests before and after
    return Motion(
        robot=given.robot,
        gait=RecordedGait(
            mgs=1,
            robot=given.robot.spec.name,
            motion="recorded",
            dt=given.dt,
            recorded=RecordedParameters(
                source=source,
                layout=layout,
                balanced=balanced,
                base=placed.base,
                notes=list(placed.notes),
            ),
        ),
        gait_name=name,
        dt=given.dt,
        footsteps=tuple(footsteps(support, whole.soles)),
        support=support,
        q=given.q,
        v=v,
        torque=whole.torque,
        com=whole.com,
        com_ref=whole.com,
        zmp=whole.zmp,
        zmp_ref=whole.zmp,
        soles=whole.soles,
        soles_ref=whole.soles,
        hands=whole.hands,
        hands_ref=whole.hands[..., :3].copy(),
        torso=whole.torso,
        torso_ref=whole.torso[:, 3:].copy(),
        provenance=Provenance(Origin("recorded", "mgs", version)),
        scene=given.scene,
    )


def supports(body: Body, contacts: Contacts, dt: float) -> NDArray[np.int8]:
    """Values of `Support` (T,); where no sole touches, that of the sample before."""
    speed = np.linalg.norm(np.gradient(body.corners, dt, axis=0), axis=-1).max(axis=-1)
    still = (body.clearance.max(axis=-1) < FLAT) & (speed < STILL)
    most = contacts.soles & (contacts.load > MOST_OF_THE_LOAD)
    holds = np.where(still.any(axis=1)[:, None], still, most)
    left, right = holds.T
    support = np.full(len(holds), -1, dtype=np.int8)
    support[left & right] = Support.DOUBLE
    support[left & ~right] = Support.LEFT
    support[right & ~left] = Support.RIGHT
    known = np.flatnonzero(support >= 0)
    if not len(known):
        return np.zeros_like(support)
    last = np.maximum.accumulate(np.where(support >= 0, np.arange(len(support)), known[0]))
    return np.asarray(support[last])


def _load_left(support: NDArray[np.int8], contacts: Contacts) -> Array:
    shared = np.where(support == Support.DOUBLE, contacts.load[:, 0], 0.0)
    return np.where(support == Support.LEFT, 1.0, shared)


def footsteps(support: NDArray[np.int8], soles: Array) -> Iterator[Footstep]:
    """Both soles at the start, then each sole where it comes into support."""
    for side in Side:
        yield _footstep(side, soles[0, side])
    landings = []
    for side in Side:
        holds = (support == Support.DOUBLE) | (support == Support.single(side))
        landings += [(start, side) for start, _ in spans(holds) if start and holds[start]]
    for start, side in sorted(landings):
        yield _footstep(side, soles[start, side])


def _footstep(side: Side, pose: Array) -> Footstep:
    x, y, z = pose[:3].tolist()
    return Footstep(side, x, y, float(yaw_from_quat_xyzw(pose[3:])), z)
