"""Stated velocities and times against the positions: wrong clock, frame, point, first sample.

A file that states velocities makes it possible to check its clock: where they are c times the
derivative of the positions, c other than 1, the period is c times as long as it should be. There is
one clock: what is compared first sets c for all that follows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.geometry import rotations_from_quat_xyzw
from mgs.judge.audit.body import Body
from mgs.judge.audit.derivatives import Comparison, compare
from mgs.judge.audit.finding import Finding
from mgs.judge.audit.given import GivenMotion, StatedLinks
from mgs.judge.audit.rates import turns
from mgs.judge.audit.tree import JointPoses

CLOCK_LIMIT = 0.005  # relative
CLOCK_SHARE = 0.25  # of the mismatch, by which a clock may seem to be wrong besides
LOST_SAMPLE = 0.5  # of a period, by which one time stamp may be off
MISMATCH_LIMIT = 0.15  # of the root mean square of the velocities
FRAME_LIMIT, POINT_LIMIT = 0.05, 0.015  # from which another reading may be the right one
BETTER = 0.5  # of the mismatch as stated, to which another reading has to bring it down
ROUNDING_SHARE = 3.0  # of the rounding of positions, by which velocities may miss them besides
END_LIMIT = 0.5  # of the largest velocity elsewhere, by which the first or last one may be off
# and the acceleration over one period, since a difference at an end is one to one side
END_ACCELERATION = {"rad/s": 30.0, "m/s": 3.0}
STILL = {"rad/s": 0.05, "m/s": 0.01}  # root mean square below which nothing is said


@dataclass(frozen=True, eq=False)
class Statement:
    """Velocities that a file states, and the steps of what they are velocities of."""

    where: str
    unit: str
    stated: Array  # (T, m)
    forward: Array  # (T - 1, m) steps divided by the period, as the layout says
    positions: Array  # (T, m) whose derivative they are
    other_kind: str = ""  # kind of the finding where another reading is right
    other: tuple[Array, Array] | None = None  # forward and positions of that reading
    limit: float = FRAME_LIMIT  # of the mismatch, from which it is looked at


def velocity_findings(given: GivenMotion, body: Body) -> list[Finding]:
    """Wrong clocks, velocities at the ends, frames and points, and any other mismatch."""
    found, scale = _timestamps(given), None
    for statement in _statements(given, body):
        seen = compare(statement.stated, statement.forward, statement.positions, given.dt, scale)
        findings = _judged(given, statement, seen, scale)
        found += findings
        is_sound = all(finding.kind in ("clock", "velocity_end") for finding in findings)
        if scale is None and is_sound and seen.speed >= STILL[statement.unit]:
            scale = seen.scale
    return found


def _timestamps(given: GivenMotion) -> list[Finding]:
    """Periods of the time stamps that differ from that of the motion."""
    if given.times is None:
        return []
    off = np.abs(np.diff(given.times) / given.dt - 1.0)
    mean = float(np.mean(np.diff(given.times))) / given.dt - 1.0
    if abs(mean) <= CLOCK_LIMIT and off.max() <= LOST_SAMPLE:
        return []
    k = int(off.argmax())
    amount, limit = (
        (float(off[k]), LOST_SAMPLE) if abs(mean) <= CLOCK_LIMIT else (mean, CLOCK_LIMIT)
    )
    end = given.dt * (given.n_samples - 1)
    return [Finding("clock", 0.0, end, k * given.dt, amount, limit, "", "time stamps")]


def _statements(given: GivenMotion, body: Body) -> list[Statement]:
    """What a file states, from what tells most of the clock to what tells least."""
    dt, stated = given.dt, []
    if given.joint_velocity is not None:
        q = given.joints
        stated.append(
            Statement("joints", "rad/s", given.joint_velocity, np.diff(q, axis=0) / dt, q)
        )
    if given.base_linear is not None:
        p = given.q[:, :3]
        stated.append(Statement("base", "m/s", given.base_linear, np.diff(p, axis=0) / dt, p))
    if given.links is not None:
        stated.append(_link_statement(given, body, given.links))
    if given.base_angular is not None:
        stated.append(_turn_statement(given, given.base_angular))
    return stated


def _judged(
    given: GivenMotion, statement: Statement, seen: Comparison, scale: float | None
) -> list[Finding]:
    where, unit, dt = statement.where, statement.unit, given.dt
    rounding = ROUNDING_SHARE * seen.rounding
    end_limit = END_LIMIT * max(seen.top, 5.0 * STILL[unit]) + END_ACCELERATION[unit] * dt
    found = []
    for k in (0, given.n_samples - 1):
        if seen.errors[k] > end_limit and seen.stands_out(k):
            t, amount = k * dt, float(seen.errors[k])
            found.append(Finding("velocity_end", t, t, t, amount, end_limit, unit, where))
    if seen.speed < STILL[unit]:
        return found
    if statement.other is not None and seen.mismatch > statement.limit + rounding:
        other = compare(statement.stated, *statement.other, dt, scale)
        if other.mismatch < BETTER * seen.mismatch:
            kind, limit = statement.other_kind, statement.limit + rounding
            return [*found, _everywhere(given, kind, seen.mismatch, limit, where, seen)]
    if seen.mismatch > MISMATCH_LIMIT + rounding:
        limit = MISMATCH_LIMIT + rounding
        return [*found, _everywhere(given, "velocity", seen.mismatch, limit, where, seen)]
    limit = CLOCK_LIMIT + CLOCK_SHARE * seen.mismatch
    if scale is None and abs(seen.scale - 1.0) > limit:
        found.append(_everywhere(given, "clock", seen.scale - 1.0, limit, where, seen))
    return found


def _everywhere(
    given: GivenMotion, kind: str, amount: float, limit: float, where: str, seen: Comparison
) -> Finding:
    k = 1 + int(np.argmax(seen.errors[1:-1]))
    end = given.dt * (given.n_samples - 1)
    return Finding(kind, 0.0, end, k * given.dt, amount, limit, "", where)


def _turn_statement(given: GivenMotion, stated: Array) -> Statement:
    """Angular velocity of the base in the frame that the layout says, and in the other one."""
    R = rotations_from_quat_xyzw(given.q[:, 3:7])
    body = turns(given.q[:, 3:7]) / given.dt
    readings: Mapping[str, Array] = {
        "body": body, "world": np.einsum("tij,tj->ti", R[:-1], body)
    }  # fmt: skip
    other = "body" if given.angular_frame == "world" else "world"
    said, else_said = (
        (forward, _integral(forward, given.dt))
        for forward in (readings[given.angular_frame], readings[other])
    )
    return Statement("base rotation", "rad/s", stated, *said, "angular_frame", else_said)


def _integral(forward: Array, dt: float) -> Array:
    return np.concatenate([np.zeros((1, forward.shape[1])), np.cumsum(forward, axis=0) * dt])


def _link_statement(given: GivenMotion, body: Body, links: StatedLinks) -> Statement:
    """Velocities of links, of their origins or of their centres of mass.

    The two points of a link move much alike, so that a small mismatch tells which one it is.
    """
    origin, com = _link_points(given, body.poses, links.names)
    points = (origin, com) if links.point == "origin" else (com, origin)
    said, else_said = ((np.diff(p, axis=0) / given.dt, p) for p in points)
    stated = links.linear.reshape(given.n_samples, -1)
    return Statement("links", "m/s", stated, *said, "link_point", else_said, POINT_LIMIT)


def _link_points(
    given: GivenMotion, poses: JointPoses, names: tuple[str, ...]
) -> tuple[Array, Array]:
    """Origins and centres of mass (T, 3 B) of links in the world [m].

    What is fixed to a link is part of it, so that its centre of mass is that of its joint's body.
    """
    model = given.robot.model
    origin, com = (np.empty((given.n_samples, len(names), 3)) for _ in range(2))
    for b, name in enumerate(names):
        frame = model.frames[model.getBodyId(name)]
        R, p = poses.R[frame.parentJoint], poses.p[frame.parentJoint]
        origin[:, b] = p + R @ frame.placement.translation
        com[:, b] = p + R @ model.inertias[frame.parentJoint].lever
    return origin.reshape(given.n_samples, -1), com.reshape(given.n_samples, -1)
