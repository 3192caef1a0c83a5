"""Findings on the ground: parts below it, a robot above it, soles that slide on it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.judge.audit.body import Body
from mgs.judge.audit.contacts import Contacts
from mgs.judge.audit.finding import Finding, findings_where
from mgs.judge.audit.given import GivenMotion

PENETRATION_LIMIT = 0.002  # [m]
FLOAT_LIMIT = 0.005  # [m]
FLOAT_TIME = 0.04  # [s] that a robot may be borne by nothing, between two samples of 30 a second
SLIP_LIMIT = 0.01  # [m/s]
SLIP_TIME = 0.1  # [s] over which the speed of a sole is taken


def ground_findings(given: GivenMotion, body: Body, contacts: Contacts) -> list[Finding]:
    """Penetration, float and slip."""
    return [
        *_penetration(given, body),
        *_float(given, contacts),
        *(found for side in Side for found in _slip(given, body, contacts, side)),
    ]


def _penetration(given: GivenMotion, body: Body) -> list[Finding]:
    """Soles below the ground, or other links below the floor."""
    robot = given.robot
    objects = robot.geometry.geometryObjects
    feet = [robot.model.frames[frame].parentJoint for frame in robot.sole_frames]
    names = [f"{side.label} sole" for side in Side]
    depths = [-body.clearance[:, side].min(axis=1) for side in Side]
    for g, item in enumerate(objects):
        if item.parentJoint not in feet:
            names.append(robot.model.frames[item.parentFrame].name)
            depths.append(-body.heights[:, g])
    depth = np.stack(depths, axis=1)
    worst = depth.argmax(axis=1)
    return findings_where(
        "penetration",
        depth.max(axis=1),
        PENETRATION_LIMIT,
        given.dt,
        "m",
        lambda k: names[worst[k]],
    )


def _float(given: GivenMotion, contacts: Contacts) -> list[Finding]:
    """Samples at which the ground has to bear the robot, but nothing is near it."""
    bad = contacts.supported & (contacts.lowest > FLOAT_LIMIT)
    return findings_where(
        "float", contacts.lowest, FLOAT_LIMIT, given.dt, "m", "", bad, least_time=FLOAT_TIME
    )


def _slip(given: GivenMotion, body: Body, contacts: Contacts, side: Side) -> list[Finding]:
    """Speed of a bearing sole over `SLIP_TIME`."""
    width = max(1, round(SLIP_TIME / given.dt))
    if given.n_samples <= width:
        return []
    speed = sole_speed(body, contacts, side, width, given.dt)
    whole = throughout(contacts.bearing[:, side], width)
    amount = np.zeros(given.n_samples)
    half = width // 2
    amount[half : half + len(speed)] = np.where(whole, speed, 0.0)
    return findings_where("slip", amount, SLIP_LIMIT, given.dt, "m/s", f"{side.label} sole")


def sole_speed(body: Body, contacts: Contacts, side: Side, width: int, dt: float) -> Array:
    """Speeds (T - width,) of a sole along the ground over `width` periods [m/s].

    Mean over those corners that touch at both ends, so that a foot may roll; zero without any.
    """
    corners, touch = body.corners[:, side, :, :2], contacts.corners[:, side]
    both = touch[width:] & touch[:-width]
    way = np.linalg.norm(corners[width:] - corners[:-width], axis=-1)
    count = np.maximum(both.sum(axis=1), 1)
    return np.asarray((way * both).sum(axis=1) / (count * width * dt))


def throughout(mask: NDArray[np.bool_], width: int) -> NDArray[np.bool_]:
    """Whether (T - width,) a mask (T,) is true for all samples from each one to `width` later."""
    total = np.concatenate([[0], np.cumsum(mask)])
    return np.asarray(total[width + 1 :] - total[: -width - 1] == width + 1)
