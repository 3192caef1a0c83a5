"""Ranges, speeds and posture of coupled joints, so that every physical joint keeps its limits."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import ConfigError
from mgs.robot.coupling import Coupling, Follower, read_followers
from mgs.robot.spec import RobotSpec
from mgs.robot.urdf_bounds import parse_bounded
from mgs.robot.urdf_checks import malformed

SAME_ANGLE = 1e-6  # [rad] a follower's angle in the posture may differ from its place by this much


def followers_in(urdf: str, spec: RobotSpec, source: str | Path) -> dict[str, Follower]:
    """Followers among the joints of a URDF that are not locked.

    Raises:
        ConfigError: a follower has no leader that moves, or only one of the two is locked.
    """
    if "<mimic" not in urdf:
        return {}
    name = f"{source}: {spec.urdf}"
    root = parse_bounded(urdf, name)
    if problems := malformed(root, urdf):
        raise ConfigError(name, problems)
    joints = {j.get("name", ""): j.get("type") for j in root.findall("joint")}
    found = read_followers(root)
    for joint, follower in found.items():
        leader = follower.leader
        if leader not in joints or joints[leader] == "fixed" or leader in found:
            problems.append(
                f"joint {joint} mimics {leader}, which is no joint that moves by itself"
            )
        elif not follower.multiplier:
            problems.append(f"joint {joint} mimics {leader} with the multiplier 0; make it fixed")
        elif (joint in spec.locked) != (leader in spec.locked):
            one, other = (joint, leader) if joint in spec.locked else (leader, joint)
            problems.append(
                f"joint {joint} mimics {leader}, but only {one} is locked; lock {other}"
            )
    if problems:
        raise ConfigError(source, problems)
    return {joint: follower for joint, follower in found.items() if joint not in spec.locked}


def couple_limits(
    coupling: Coupling, lower: Array, upper: Array, speed: Array, no_load_speed: Array
) -> None:
    """Narrow the limits (n,) of leaders by those of their followers, in place.

    Followers get the limits that their leaders leave them: ranges [rad], speed limits and no-load
    speeds [rad/s].
    """
    rows = zip(
        coupling.followers, coupling.leaders, coupling.multipliers, coupling.offsets, strict=True
    )
    for follower, leader, multiplier, offset in rows:
        ends = (np.array([lower[follower], upper[follower]]) - offset) / multiplier
        lower[leader] = max(lower[leader], float(ends.min()))
        upper[leader] = min(upper[leader], float(ends.max()))
        speed[leader] = min(speed[leader], speed[follower] / abs(multiplier))
    ends = np.stack([lower, upper])
    coupling.complete(ends)
    lower[:], upper[:] = ends.min(axis=0), ends.max(axis=0)
    for figures in (speed, no_load_speed):
        figures[coupling.followers] = np.abs(coupling.multipliers) * figures[coupling.leaders]


def couple_posture(
    coupling: Coupling,
    names: tuple[str, ...],
    spec: RobotSpec,
    posture: Array,
    limits: tuple[Array, Array],
    source: str | Path,
) -> None:
    """Set the followers' angles in a posture (n,) [rad] by those of their leaders, in place.

    Raises:
        ConfigError: robot.yaml gives a follower another angle, or a leader has no range left.
    """
    given = posture.copy()
    coupling.complete(posture)
    lower, upper = limits
    problems = [
        f"posture.{names[f]}: it follows joint {names[leader]} and has to be {posture[f]:.6f} rad; "
        "leave it out"
        for f, leader in zip(coupling.followers, coupling.leaders, strict=True)
        if names[f] in spec.posture and abs(given[f] - posture[f]) > SAME_ANGLE
    ]
    problems += [
        f"joint {names[j]} and its followers have no common range: [{lower[j]:.4f}, "
        f"{upper[j]:.4f}] rad is left"
        for j in coupling.leaders
        if not lower[j] < upper[j]
    ]
    problems += [
        f"posture.{names[j]}: {posture[j]:.4f} rad is outside [{lower[j]:.4f}, {upper[j]:.4f}] "
        "rad, in which its followers keep their ranges"
        for j in coupling.leaders
        if lower[j] < upper[j] and not lower[j] <= posture[j] <= upper[j]
    ]
    if problems:
        raise ConfigError(source, problems)
