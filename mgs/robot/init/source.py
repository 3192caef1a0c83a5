"""Reading of a third-party URDF as one tree of revolute joints, which is what mgs supports.

Prismatic joints, joints that mimic another one and joints without a range are replaced by fixed
joints, with a note. A link that is the child of two joints closes a loop; such a URDF is refused,
because the joints of a loop cannot be controlled independently.
"""

from __future__ import annotations

import copy
import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from xml.etree import ElementTree

from mgs.core.arrays import Array
from mgs.core.errors import ConfigError
from mgs.core.input_files import read_bytes
from mgs.core.limits import MAX_URDF
from mgs.robot.coupling import Follower, read_followers
from mgs.robot.init.mjcf import Drive, read_mjcf
from mgs.robot.urdf_bounds import parse_counted, refuse_large
from mgs.robot.urdf_checks import PARTS, is_empty, malformed
from mgs.robot.urdf_lock import fix_joint

LEAST_RANGE = 0.05  # [rad] joints with a smaller range are fixed: they serve no motion, and the
# joint-limit gradient of the closed-loop IK, which grows with 1 / range^2, would be too stiff
WIDEST = 2.0 * math.pi  # [rad] joints with a larger limit are treated as continuous
WORLD = "world"
KNOWN_BLOCKS = ("material",)  # harmless, and in most files
TAKEN_NAMES = ("universe", "root_joint")  # joint names that Pinocchio reserves


@dataclass(frozen=True, eq=False)
class Source:
    """URDF as a tree of revolute and fixed joints below one root link; `root` is mutable."""

    path: Path
    root: ElementTree.Element
    mimics: dict[str, Follower]  # joints that mimic another one; they are fixed unless in `coupled`
    leaders: set[str]  # joints that other joints mimic
    as_given: dict[str, ElementTree.Element]  # joints of `mimics` before they were fixed
    coupled: dict[str, Follower] = field(default_factory=dict)  # joints of the legs that follow
    notes: list[str] = field(default_factory=list)
    meshes: Mapping[str, Array] = field(default_factory=dict)  # points (N, 3) of known meshes [m]
    missing: list[str] = field(default_factory=list)  # names of mesh files that were not found
    stand: Mapping[str, float] = field(default_factory=dict)  # hint of a posture: angles [rad]
    drives: Mapping[str, Drive] = field(default_factory=dict)  # what is known of motors
    apart: list[tuple[str, str]] = field(default_factory=list)  # links that never collide

    @property
    def name(self) -> str:
        """Name of the robot in the URDF, or of the file if there is none."""
        return self.root.get("name") or self.path.stem


def read_source(path: Path, package_paths: tuple[Path, ...] = ()) -> Source:
    """Read a URDF or an MJCF and convert it to a tree of revolute and fixed joints.

    Raises:
        ConfigError: the file is missing, is not a URDF, or does not contain one tree of links.
    """
    root, text = _parse(path)
    mjcf = None
    if root.tag == "mujoco":
        mjcf = read_mjcf(root, path, package_paths)
        root, text = mjcf.root, ""
    refuse_large(root, str(path))
    _refuse_loops(root, path)
    notes: list[str] = [] if mjcf is None else mjcf.notes
    _ignore_foreign(root, notes)
    _drop_empty_shapes(root, notes)
    if problems := malformed(root, text):
        raise ConfigError(path, problems)
    _refuse_weightless(root, path)
    _cut_floating_base(root, path, notes)
    _cut_world(root, notes)
    leaders = {mimic.get("joint", "") for mimic in root.iter("mimic")}
    mimics = read_followers(root)
    as_given = {
        joint.get("name", ""): copy.deepcopy(joint)
        for joint in root.findall("joint")
        if joint.get("name") in mimics
    }
    source = Source(path, root, mimics, leaders, as_given, notes=notes)
    if mjcf is not None:
        source = replace(
            source,
            meshes=mjcf.meshes,
            missing=mjcf.missing,
            stand=mjcf.posture,
            drives=mjcf.drives,
            apart=mjcf.apart,
        )
    for joint in root.findall("joint"):
        _bring_into_shape(joint, source)
    return source


def _parse(path: Path) -> tuple[ElementTree.Element, str]:
    """Root element and text of a file."""
    content = read_bytes(path, MAX_URDF, "a URDF")
    root = parse_counted(content, str(path), "cannot read it as a URDF or an MJCF")
    if root.tag == "mujoco":
        return root, ""
    if root.tag == "sdf":
        raise ConfigError(path, _why_not_sdf(root))
    if root.tag != "robot":
        raise ConfigError(
            path,
            f"cannot read it as a URDF or an MJCF: its root is <{root.tag}>, not <robot> or "
            "<mujoco>",
        )
    parts = [*root.findall("link"), *root.findall("joint")]
    if any("xacro" in element.tag for element in (parts or [root]) for element in element.iter()):
        raise ConfigError(
            path, "contains xacro macros; expand them first with xacro FILE > robot.urdf"
        )
    if not root.findall("link"):
        raise ConfigError(path, "has no links")
    return root, content.decode("utf-8", "replace")


def _ignore_foreign(root: ElementTree.Element, notes: list[str]) -> None:
    """Remove what is neither a link nor a joint: blocks for simulators, leftover macros."""
    foreign = [element for element in root if element.tag not in PARTS]
    for element in foreign:
        root.remove(element)
    counts = Counter(str(element.tag).rpartition("}")[2] for element in foreign)
    shown = [f"{count} <{tag}>" for tag, count in sorted(counts.items()) if tag not in KNOWN_BLOCKS]
    if shown:
        notes.append(f"elements that are neither links nor joints ignored: {', '.join(shown)}")


def _drop_empty_shapes(root: ElementTree.Element, notes: list[str]) -> None:
    """Remove shapes with a size of 0, which no physics engine accepts."""
    for link in root.findall("link"):
        for shape in [*link.findall("collision"), *link.findall("visual")]:
            if is_empty(shape):
                link.remove(shape)
                notes.append(f"{shape.tag} shape of size 0 removed from link {link.get('name')}")


def _why_not_sdf(root: ElementTree.Element) -> str:
    ends = _ends([j for j in root.iter("joint") if j.find("child") is not None])
    loops = [f"{link} ({' and '.join(names)})" for link, names in ends.items() if len(names) > 1]
    if loops:
        return (
            f"an SDF with closed loops, at the links {', '.join(sorted(loops))}; mgs supports only "
            "trees of independent joints"
        )
    return "an SDF, not a URDF; convert it to a URDF first"


def _ends(joints: list[ElementTree.Element]) -> dict[str, list[str]]:
    """Names of the joints whose child is each link."""
    ends: dict[str, list[str]] = {}
    for joint in joints:
        child = joint.find("child")
        if child is not None:
            link = child.get("link") or (child.text or "").strip()
            ends.setdefault(link, []).append(joint.get("name", ""))
    return ends


def _refuse_loops(root: ElementTree.Element, path: Path) -> None:
    """Raise ConfigError unless the joints connect all links in one tree."""
    joints = root.findall("joint")
    links = [link.get("name", "") for link in root.findall("link")]
    problems = []
    for joint in joints:
        for tag in ("parent", "child"):
            end = joint.find(tag)
            if end is None or end.get("link") not in links:
                problems.append(f"joint {joint.get('name')}: its {tag} is not a link of the file")
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
                f"closed loop: link {link} is the child of the joints {' and '.join(names)}; mgs "
                "supports only trees of independent joints"
            )
    problems += [f"closed loop: loop_joint {j.get('name')}" for j in root.findall("loop_joint")]
    roots = sorted(set(links) - set(ends))
    if not problems and len(roots) != 1:
        problems.append(f"{len(roots)} root links ({', '.join(roots[:5])}); exactly 1 is needed")
    if problems:
        raise ConfigError(path, problems)


def _refuse_weightless(root: ElementTree.Element, path: Path) -> None:
    masses = [float(mass.get("value", "0")) for mass in root.iterfind("link/inertial/mass")]
    if not sum(masses) > 0.0:
        raise ConfigError(
            path, "no link has a mass, so that no motion can be planned; add inertial elements"
        )


def _cut_floating_base(root: ElementTree.Element, path: Path, notes: list[str]) -> None:
    """Remove a floating joint and the world link above it; mgs adds its own floating base."""
    for joint in root.findall("joint"):
        kind = joint.get("type")
        if kind not in ("floating", "planar"):
            continue
        parent = _end(joint, "parent")
        others = [other for other in root.findall("joint") if other is not joint]
        if any(parent in (_end(other, "child"), _end(other, "parent")) for other in others):
            raise ConfigError(
                path, f"joint {joint.get('name')}: {kind} joints inside the robot are not supported"
            )
        root.remove(joint)
        root.remove(next(link for link in root.findall("link") if link.get("name") == parent))
        name = joint.get("name")
        notes.append(f"{kind} joint {name} and link {parent} removed: mgs adds a floating base")


def _cut_world(root: ElementTree.Element, notes: list[str]) -> None:
    """Remove a root link `world` and the fixed joint below it; mgs adds its own floating base."""
    joints = [joint for joint in root.findall("joint") if _end(joint, "parent") == WORLD]
    ends = [_end(joint, "child") for joint in root.findall("joint")]
    if WORLD in ends or len(joints) != 1 or joints[0].get("type") != "fixed":
        return
    (joint,) = joints
    link = next(link for link in root.findall("link") if link.get("name") == WORLD)
    origin = joint.find("origin")
    rpy = [float(word) for word in ("" if origin is None else origin.get("rpy", "")).split()]
    if any(rpy[:2]):  # the rotation tells which way is up
        assert origin is not None
        origin.set("xyz", "0 0 0")
        upright = f"{_end(joint, 'child')}_upright"
        link.set("name", upright)
        joint.find("parent").set("link", upright)  # type: ignore[union-attr]
        notes.append(f"root link {WORLD} renamed to {upright}, without its height above the robot")
        return
    root.remove(joint)
    root.remove(link)
    notes.append(
        f"root link {WORLD} and fixed joint {joint.get('name')} removed: mgs adds a floating base"
    )


def _end(joint: ElementTree.Element, tag: str) -> str:
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")


def _bring_into_shape(joint: ElementTree.Element, source: Source) -> None:
    """Change a joint in place into a fixed joint or a revolute joint with limits."""
    name, kind = joint.get("name", ""), joint.get("type")
    if name in TAKEN_NAMES:
        joint.set("name", f"{name}_")
        source.notes.append(f"joint {name} renamed to {name}_: Pinocchio reserves this name")
    if kind == "fixed":
        return
    if kind == "prismatic":
        fix_joint(joint, 0.0)
        source.notes.append(f"prismatic joint {name} fixed at 0")
    elif name in source.mimics:
        mimic = joint.find("mimic")
        offset, leader = _number(source, joint, mimic, "offset"), source.mimics[name].leader
        fix_joint(joint, offset)
        source.notes.append(f"joint {name}, which mimics {leader}, fixed at {offset:g} rad")
    elif kind in ("revolute", "continuous"):
        limit_joint(joint, source)
    else:
        raise ConfigError(
            source.path,
            f"joint {name}: unknown type {kind!r}; use fixed, revolute, continuous or prismatic",
        )


def limit_joint(joint: ElementTree.Element, source: Source) -> None:
    """Give a joint the limits of a revolute joint, in place; one without a range is fixed."""
    name, limit = joint.get("name", ""), joint.find("limit")
    if limit is None:
        limit = ElementTree.SubElement(joint, "limit")
    lower, upper = (_number(source, joint, limit, key) for key in ("lower", "upper"))
    endless = limit.get("lower") is None and limit.get("upper") is None
    if joint.get("type") == "continuous":
        endless = lower == upper
        if not endless:
            source.notes.append(
                f"joint {name} is continuous, but has limits: [{lower:g}, {upper:g}] rad hold"
            )
    if lower > upper:
        lower, upper = upper, lower
        source.notes.append(f"joint {name}: reversed limits [{upper:g}, {lower:g}] rad swapped")
    if endless or max(-lower, upper) > WIDEST:
        lower, upper = -math.pi, math.pi
        source.notes.append(f"range of continuous joint {name} limited to half a turn either way")
    elif upper - lower < LEAST_RANGE:
        fix_joint(joint, 0.5 * (lower + upper))
        source.notes.append(
            f"joint {name} fixed: its range [{lower:g}, {upper:g}] rad is narrower than "
            f"{LEAST_RANGE:g} rad"
        )
        return
    joint.set("type", "revolute")
    limit.set("lower", repr(lower))
    limit.set("upper", repr(upper))
    for key in ("effort", "velocity"):  # missing values and infinities are guessed later
        value = _number(source, joint, limit, key)
        limit.set(key, repr(value if math.isfinite(value) else 0.0))
    for tag in ("mimic", "safety_controller", "calibration", "dynamics"):
        for element in joint.findall(tag):
            joint.remove(element)


def _number(
    source: Source, joint: ElementTree.Element, element: ElementTree.Element | None, key: str
) -> float:
    """Number in an attribute of an element of a joint; 0 if it is missing."""
    text = "0" if element is None else element.get(key, "0")
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if math.isnan(value):
        name = joint.get("name", "")
        raise ConfigError(source.path, f"joint {name}: {key} = {text!r} is not a number")
    return value


def turn(source: Source, yaw: float) -> None:
    """Add a new root link above the old one, rotated about the vertical axis, in place.

    The x axis of the new root has the angle `yaw` [rad] in the frame of the old root.
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
        f"root link {name} added: forward is at {math.degrees(yaw):.0f} deg from x of {old}"
    )
