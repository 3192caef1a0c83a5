"""A URDF of somebody else's, brought to what mgs moves: one tree of revolute joints.

What it has besides is made fixed and noted: prismatic joints, joints that mimic another, joints
without a range. A link that two joints end at closes a loop, which no tree of position-controlled
joints can follow; that is refused.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

from mgs.core.errors import ConfigError
from mgs.robot.urdf_lock import fix_joint

MAX_BYTES = 20_000_000
LEAST_RANGE = 1e-3  # [rad] below which a joint is taken as fixed
WIDEST = 2.0 * math.pi  # [rad] beyond: a joint that turns without end
TAKEN_NAMES = ("universe", "root_joint")  # by Pinocchio


@dataclass(frozen=True, eq=False)
class Source:
    """A URDF as a tree of revolute and fixed joints under one root link; `root` may be changed."""

    path: Path
    root: ElementTree.Element
    mimics: dict[str, str]  # joints that follow another, and which; they are fixed now
    leaders: set[str]  # joints that others follow
    notes: list[str] = field(default_factory=list)

    @property
    def name(self) -> str:
        """Name that the file gives the robot."""
        return self.root.get("name") or self.path.stem


def read_source(path: Path) -> Source:
    """Read a URDF and bring it into shape.

    Raises:
        ConfigError: it is missing, no URDF, or no tree of links that a floating base can carry.
    """
    root = _parse(path)
    _refuse_loops(root, path)
    notes: list[str] = []
    _cut_floating_base(root, path, notes)
    leaders = {mimic.get("joint", "") for mimic in root.iter("mimic")}
    source = Source(path, root, _mimics(root), leaders, notes=notes)
    _refuse_malformed(source)
    for joint in root.findall("joint"):
        _bring_into_shape(joint, source)
    return source


def _parse(path: Path) -> ElementTree.Element:
    try:
        if path.stat().st_size > MAX_BYTES:
            raise ConfigError(path, f"larger than {MAX_BYTES // 10**6} MB, cannot be a URDF")
        root = ElementTree.fromstring(path.read_bytes())
    except OSError as error:
        raise ConfigError(path, (error.strerror or str(error)).lower()) from error
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise ConfigError(path, f"cannot read it as a URDF: no XML: {error}") from error
    if root.tag == "sdf":
        raise ConfigError(path, _why_not_sdf(root))
    if root.tag != "robot":
        raise ConfigError(path, f"cannot read it as a URDF: its root is <{root.tag}>, not <robot>")
    if any("xacro" in element.tag for element in root.iter() if isinstance(element.tag, str)):
        raise ConfigError(path, "holds xacro macros; expand them first: xacro FILE > robot.urdf")
    if not root.findall("link"):
        raise ConfigError(path, "has no links")
    return root


def _why_not_sdf(root: ElementTree.Element) -> str:
    ends = _ends([j for j in root.iter("joint") if j.find("child") is not None])
    loops = [f"{link} ({' and '.join(names)})" for link, names in ends.items() if len(names) > 1]
    if loops:
        return (
            f"an SDF with closed loops, at the links {', '.join(sorted(loops))}; mgs moves trees "
            "of independent joints only"
        )
    return "an SDF, not a URDF; convert it first"


def _ends(joints: list[ElementTree.Element]) -> dict[str, list[str]]:
    """Joints that end at each link."""
    ends: dict[str, list[str]] = {}
    for joint in joints:
        child = joint.find("child")
        if child is not None:
            link = child.get("link") or (child.text or "").strip()
            ends.setdefault(link, []).append(joint.get("name", ""))
    return ends


def _refuse_loops(root: ElementTree.Element, path: Path) -> None:
    """Raise ConfigError unless the joints make one tree of all links."""
    joints = root.findall("joint")
    links = [link.get("name", "") for link in root.findall("link")]
    problems = []
    for joint in joints:
        for tag in ("parent", "child"):
            end = joint.find(tag)
            if end is None or end.get("link") not in links:
                problems.append(f"joint {joint.get('name')}: its {tag} is no link of the file")
    for kind, names in (("link", links), ("joint", [joint.get("name", "") for joint in joints])):
        twice = sorted({name for name in names if names.count(name) > 1})
        problems += [f"{kind} {name!r} appears twice" for name in twice]
    if problems:
        raise ConfigError(path, problems)
    hidden = [joint for block in root.findall("gazebo") for joint in block.iter("joint")]
    ends = _ends([*joints, *hidden, *root.findall("loop_joint")])
    for link, names in ends.items():
        if len(names) > 1:
            problems.append(
                f"closed loop: link {link} hangs on {' and '.join(names)}; mgs moves trees of "
                "independent joints only"
            )
    problems += [f"closed loop: loop_joint {j.get('name')}" for j in root.findall("loop_joint")]
    roots = sorted(set(links) - set(ends))
    if not problems and len(roots) != 1:
        problems.append(f"{len(roots)} root links ({', '.join(roots[:5])}), one is needed")
    if problems:
        raise ConfigError(path, problems)


def _refuse_malformed(source: Source) -> None:
    """Raise ConfigError for places and axes that are not three numbers, which no parser names."""
    problems = []
    for part in (*source.root.findall("joint"), *source.root.findall("link")):
        for element in part.iter():
            for key in ("xyz", "rpy"):
                text = element.get(key)
                if text is not None and not _is_triple(text):
                    problems.append(
                        f"{part.tag} {part.get('name')}: {element.tag} {key} = {text!r} is not "
                        "three numbers"
                    )
    if problems:
        raise ConfigError(source.path, problems)


def _is_triple(text: str) -> bool:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return False
    return len(values) == 3 and all(math.isfinite(value) for value in values)


def _cut_floating_base(root: ElementTree.Element, path: Path, notes: list[str]) -> None:
    """Drop a floating joint and the world above it: mgs has a floating base of its own."""
    for joint in root.findall("joint"):
        kind = joint.get("type")
        if kind not in ("floating", "planar"):
            continue
        parent = _end(joint, "parent")
        others = [other for other in root.findall("joint") if other is not joint]
        if any(parent in (_end(other, "child"), _end(other, "parent")) for other in others):
            raise ConfigError(
                path, f"joint {joint.get('name')}: a {kind} joint inside the robot cannot be moved"
            )
        root.remove(joint)
        root.remove(next(link for link in root.findall("link") if link.get("name") == parent))
        name = joint.get("name")
        notes.append(f"{kind} joint {name} and link {parent} left out: the base floats anyway")


def _end(joint: ElementTree.Element, tag: str) -> str:
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")


def _mimics(root: ElementTree.Element) -> dict[str, str]:
    found = {}
    for joint in root.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None and joint.get("type") != "fixed":
            found[joint.get("name", "")] = mimic.get("joint", "")
    return found


def _bring_into_shape(joint: ElementTree.Element, source: Source) -> None:
    """Make a joint fixed or revolute with limits, in place."""
    name, kind = joint.get("name", ""), joint.get("type")
    if name in TAKEN_NAMES:
        joint.set("name", f"{name}_")
        source.notes.append(f"joint {name} renamed {name}_: Pinocchio uses the name itself")
    if kind == "fixed":
        return
    if kind == "prismatic":
        fix_joint(joint, 0.0)
        source.notes.append(f"prismatic joint {name} fixed at 0")
    elif name in source.mimics:
        mimic = joint.find("mimic")
        offset, leader = _number(source, joint, mimic, "offset"), source.mimics[name]
        fix_joint(joint, offset)
        source.notes.append(f"joint {name}, which mimics {leader}, fixed at {offset:g}")
    elif kind in ("revolute", "continuous"):
        _limit(joint, source)
    else:
        raise ConfigError(source.path, f"joint {name}: type {kind!r} is unknown")


def _limit(joint: ElementTree.Element, source: Source) -> None:
    name, limit = joint.get("name", ""), joint.find("limit")
    if limit is None:
        limit = ElementTree.SubElement(joint, "limit")
    lower, upper = (_number(source, joint, limit, key) for key in ("lower", "upper"))
    unlimited = limit.get("lower") is None and limit.get("upper") is None
    endless = joint.get("type") == "continuous" or unlimited
    if lower > upper:
        lower, upper = upper, lower
        source.notes.append(f"joint {name}: limits [{upper:g}, {lower:g}] are reversed; swapped")
    if endless or max(-lower, upper) > WIDEST:
        lower, upper = -math.pi, math.pi
        source.notes.append(f"joint {name} turns without end; its range is cut to half a turn")
    elif upper - lower < LEAST_RANGE:
        fix_joint(joint, 0.5 * (lower + upper))
        source.notes.append(f"joint {name} fixed: its range [{lower:g}, {upper:g}] rad is empty")
        return
    joint.set("type", "revolute")
    limit.set("lower", repr(lower))
    limit.set("upper", repr(upper))
    for key in ("effort", "velocity"):  # what is missing or no number is guessed later
        value = _number(source, joint, limit, key)
        limit.set(key, repr(value if math.isfinite(value) else 0.0))
    for tag in ("mimic", "safety_controller", "calibration", "dynamics"):
        for element in joint.findall(tag):
            joint.remove(element)


def _number(
    source: Source, joint: ElementTree.Element, element: ElementTree.Element | None, key: str
) -> float:
    """An attribute of a joint's element; 0 where it is missing."""
    text = "0" if element is None else element.get(key, "0")
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if math.isnan(value):
        name = joint.get("name", "")
        raise ConfigError(source.path, f"joint {name}: {key} = {text!r} is no number")
    return value


def turn(source: Source, yaw: float) -> None:
    """Put a new root link above the old one, turned about the vertical, in place.

    Its x axis points where `yaw` [rad] points in the old root.
    """
    links = {link.get("name", "") for link in source.root.findall("link")}
    old = next(iter(links - {_end(joint, "child") for joint in source.root.findall("joint")}))
    name = "base_forward"
    while name in links:
        name += "_"
    ElementTree.SubElement(source.root, "link", name=name)
    joint = ElementTree.SubElement(source.root, "joint", name=f"{name}_joint", type="fixed")
    ElementTree.SubElement(joint, "parent", link=name)
    ElementTree.SubElement(joint, "child", link=old)
    ElementTree.SubElement(joint, "origin", xyz="0 0 0", rpy=f"0 0 {-yaw!r}")
    source.notes.append(
        f"root link {name} added: the robot looks along {math.degrees(yaw):.0f} deg of {old}"
    )
