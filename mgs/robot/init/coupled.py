"""Coupled joints of the legs of a third-party robot, which keep moving.

`source` fixes every joint that mimics another one. Where it is on the way from the root link to a
foot, the whole robot depends on it, and it is made to follow its leader here.
"""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np

from mgs.core.errors import ConfigError
from mgs.robot.coupling import Follower
from mgs.robot.init.anatomy import standing_bodies
from mgs.robot.init.skeleton import Skeleton
from mgs.robot.init.source import Source, limit_joint


def free_leg_followers(source: Source, skeleton: Skeleton) -> bool:
    """Let joints of the legs follow their leaders, in the source; whether there are any.

    Raises:
        ConfigError: a leader is no joint of the legs, or has no range in which both can move.
    """
    if not source.mimics:
        return False
    joints = {joint.get("name", ""): joint for joint in source.root.findall("joint")}
    legs = _joints_to_feet(source, skeleton)
    found = [name for name in source.mimics if name in legs]
    problems = []
    for name in found:
        follower = source.mimics[name]
        is_free = follower.leader in legs and follower.leader not in source.mimics
        if not is_free or not follower.multiplier:
            problems.append(
                f"leg joint {name} mimics {follower.leader}, which is no joint of the legs that "
                "moves by itself"
            )
            continue
        joint = joints[name]
        joint.attrib.update(source.as_given[name].attrib)
        joint[:] = list(source.as_given[name])
        limit_joint(joint, source)
        problems += _share_limits(joints[follower.leader], joint, follower)
        source.coupled[name] = follower
    if problems:
        raise ConfigError(source.path, problems)
    gone = {f"joint {name}, which mimics {source.mimics[name].leader}, fixed" for name in found}
    source.notes[:] = [
        note for note in source.notes if not any(note.startswith(start) for start in gone)
    ]
    source.notes.extend(
        f"joint {name} follows {source.mimics[name].leader}: one motor turns both" for name in found
    )
    return bool(found)


def _joints_to_feet(source: Source, skeleton: Skeleton) -> set[str]:
    """Names of all joints, fixed ones included, between the root link and the feet."""
    above = {_end(joint, "child"): joint for joint in source.root.findall("joint")}
    names = set()
    for foot in standing_bodies(skeleton, source):
        link = skeleton.links[foot][0]
        while link in above:
            names.add(above[link].get("name", ""))
            link = _end(above[link], "parent")
    return names


def _share_limits(
    leader: ElementTree.Element, joint: ElementTree.Element, follower: Follower
) -> list[str]:
    """Narrow the limits of a leader by those of its follower, and give the follower the rest."""
    above, own = leader.find("limit"), joint.find("limit")
    name = joint.get("name")
    if above is None or own is None:
        return [f"leg joint {name} or its leader {follower.leader} has no range"]
    low, high = (float(above.get(key, "0")) for key in ("lower", "upper"))
    ends = [
        (float(own.get(key, "0")) - follower.offset) / follower.multiplier
        for key in ("lower", "upper")
    ]
    low, high = max(low, min(ends)), min(high, max(ends))
    if not low < high:
        return [f"leg joint {name} and its leader {follower.leader} have no common range"]
    above.set("lower", repr(low))
    above.set("upper", repr(high))
    lower, upper = sorted((follower.angle(low), follower.angle(high)))
    # beyond the rounded image of the leader's range, so that reading it back narrows nothing
    own.set("lower", repr(float(np.nextafter(lower, -np.inf))))
    own.set("upper", repr(float(np.nextafter(upper, np.inf))))
    speed = float(own.get("velocity", "0")) / abs(follower.multiplier)
    if 0.0 < speed < float(above.get("velocity", "0")):
        above.set("velocity", repr(speed))
    return []


def _end(joint: ElementTree.Element, tag: str) -> str:
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")
