"""Orders in which other programs count the links and the joints of a robot.

Depth first is MuJoCo's order and that of lists of joints in most data sets: a link, then everything
beyond its first child, then everything beyond its second one. Breadth first is the order of PhysX
and so of Isaac Lab: the root, then all its children, then all theirs. In both, the children of a
link stand in the order of their joints in the URDF. Pinocchio, whose order `Robot.joint_names` has,
goes depth first too, but sorts children by the names of their joints.

A link that is fixed to another one moves with it. Where such links are merged, as MuJoCo and the
URDF importer of Isaac Lab do by default, a root and one link per moving joint remain, and what
hangs on a merged link hangs on the link it is merged into.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mgs.core.arrays import Array
from mgs.robot.robot import Robot
from mgs.robot.urdf_bounds import parse_bounded

Order = Literal["depth-first", "breadth-first"]
Links = Literal["moving", "all"]


@dataclass(frozen=True)
class RobotOrder:
    """Links, and the moving joints, in the order in which a program counts them."""

    links: tuple[str, ...]  # the root link first
    joints: tuple[str, ...]  # moving ones only


@dataclass(frozen=True)
class _Child:
    """A joint of the URDF and the link that hangs on it."""

    joint: str
    link: str
    moves: bool


def robot_order(robot: Robot, order: Order, links: Links = "moving") -> RobotOrder:
    """Order of a robot's links and joints.

    Args:
        robot: the robot; its locked joints are fixed.
        order: which way through the tree.
        links: "all" links of the URDF, or "moving" ones, into which the others are merged.
    """
    root, children = _tree(robot)
    found: list[_Child] = []
    waiting = deque(_children(root, children, links))
    while waiting:
        found.append(waiting.popleft())
        beyond = _children(found[-1].link, children, links)
        if order == "depth-first":
            waiting.extendleft(reversed(beyond))
        else:
            waiting.extend(beyond)
    return RobotOrder(
        links=(root, *(child.link for child in found)),
        joints=tuple(child.joint for child in found if child.moves),
    )


def _tree(robot: Robot) -> tuple[str, dict[str, list[_Child]]]:
    """Root link, and what hangs on each link."""
    moving = set(robot.joint_names)
    children: dict[str, list[_Child]] = {}
    hanging = set()
    xml = parse_bounded(robot.urdf, robot.source)
    for joint in xml.findall("joint"):
        names = [joint.find(end) for end in ("parent", "child")]
        parent, link = (end.get("link", "") for end in names if end is not None)
        name = joint.get("name", "")
        children.setdefault(parent, []).append(_Child(name, link, name in moving))
        hanging.add(link)
    root = next(
        name for link in xml.findall("link") if (name := link.get("name", "")) not in hanging
    )
    return root, children


def _children(link: str, children: dict[str, list[_Child]], links: Links) -> list[_Child]:
    """What hangs on a link, or on a link that is merged into it."""
    found: list[_Child] = []
    stack = list(reversed(children.get(link, [])))
    while stack:
        child = stack.pop()
        if child.moves or links == "all":
            found.append(child)
        else:
            stack += reversed(children.get(child.link, []))
    return found


def joint_axes(robot: Robot, names: Sequence[str]) -> Array:
    """Axes (J, 3) of joints in the frames of their links, unit vectors."""
    xml = parse_bounded(robot.urdf, robot.source)
    found = {joint.get("name", ""): joint.find("axis") for joint in xml.findall("joint")}
    rows = []
    for name in names:
        axis = found[name]
        text = "1 0 0" if axis is None else axis.get("xyz", "1 0 0")  # the default of URDF
        rows.append([float(part) for part in text.split()])
    axes = np.array(rows, dtype=np.float64).reshape(-1, 3)
    return np.asarray(axes / np.linalg.norm(axes, axis=1, keepdims=True))
