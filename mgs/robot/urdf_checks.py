"""Checks of the numbers and names in a URDF, before any other parser sees it.

Pinocchio's parser, urdfdom, leaves out what it cannot read: a link whose mass is the expression
`${m}` loses its whole inertial element without a word. So every number that belongs to a link or a
joint is read here first, both when `mgs robot init` reads a source and when a robot is built.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from xml.etree import ElementTree

from mgs.robot.urdf_form import misshapen, own_elements

# number of values and, if it is a size, that all of them have to be positive
NUMBERS = {
    ("origin", "xyz"): (3, False),
    ("origin", "rpy"): (3, False),
    ("axis", "xyz"): (3, False),
    ("box", "size"): (3, True),
    ("sphere", "radius"): (1, True),
    ("cylinder", "radius"): (1, True),
    ("cylinder", "length"): (1, True),
    ("capsule", "radius"): (1, True),
    ("capsule", "length"): (1, True),
    ("mesh", "scale"): (3, False),
    ("mass", "value"): (1, False),
    **{("inertia", f"i{a}"): (1, False) for a in ("xx", "xy", "xz", "yy", "yz", "zz")},
    **{("limit", key): (1, False) for key in ("lower", "upper", "effort", "velocity")},
    ("mimic", "multiplier"): (1, False),
    ("mimic", "offset"): (1, False),
}
PARTS = ("link", "joint")
MOST_PROBLEMS = 100  # each search for a line reads the text once
MOST_SHOWN = 60  # characters of a value in a message


def malformed(root: ElementTree.Element, text: str) -> list[str]:
    """Problems of the numbers and names of links and joints, one sentence each.

    Args:
        root: root element of the URDF.
        text: text of the URDF, from which messages take the line of a value.
    """
    problems: list[str] = []
    for part in (*root.findall("link"), *root.findall("joint")):
        if len(problems) >= MOST_PROBLEMS:
            break
        name = part.get("name", "")
        if not name.strip():
            problems.append(f"a {part.tag} has an empty name; give every link and joint a name")
        for element, key, value in _values(part):
            problem = _problem(element.tag, key, value)
            if problem:
                where = _line(text, name, value)
                problems.append(
                    f"{part.tag} {name}{where}: {element.tag} {key} = {value[:MOST_SHOWN]!r} "
                    f"{problem}"
                )
        problems += misshapen(part)
        if part.tag == "joint":
            problems += _of_joint(part)
    return problems


def is_empty(shape: ElementTree.Element) -> bool:
    """Whether a collision or visual shape has a size that is exactly 0."""
    for element, key, value in _values(shape):
        if NUMBERS[element.tag, key][1] and _problem(element.tag, key, value):
            try:
                return 0.0 in map(float, value.split())
            except ValueError:
                return False
    return False


def _values(part: ElementTree.Element) -> Iterator[tuple[ElementTree.Element, str, str]]:
    """Attributes of a link or a joint that have to be numbers: element, key, value."""
    for element in own_elements(part):
        for key, value in element.attrib.items():
            if (element.tag, key) in NUMBERS:
                yield element, key, value


def _problem(tag: str, key: str, value: str) -> str:
    """What is wrong with a value; empty if it is fine."""
    count, is_size = NUMBERS[tag, key]
    try:
        numbers = [float(word) for word in value.split()]
    except ValueError:
        numbers = []
    amount = "a number" if count == 1 else "three numbers"
    if len(numbers) != count or any(map(math.isnan, numbers)):
        hint = "; expand the expression first" if "${" in value else ""
        return f"is not {amount}{hint}"
    if tag != "limit" and not all(map(math.isfinite, numbers)):
        return "is not finite"
    if is_size and not min(numbers) > 0.0:
        return "has to be above 0"
    if (tag, key) == ("mass", "value") and numbers[0] < 0.0:
        return "has to be 0 kg or more"
    return ""


def _of_joint(joint: ElementTree.Element) -> list[str]:
    axis = joint.find("axis")
    text = "" if axis is None else axis.get("xyz", "")
    if joint.get("type") == "fixed" or _problem("axis", "xyz", text or "1 0 0"):
        return []
    if text and not any(float(word) for word in text.split()):
        return [f"joint {joint.get('name')}: axis xyz = {text!r} has no direction"]
    return []


def _line(text: str, name: str, value: str) -> str:
    """Line of a value of a link or a joint, as ` (line 12)`; empty if it is not found."""
    at = text.find(f'"{name}"')
    at = text.find(value, max(at, 0)) if value else -1
    return "" if at < 0 else f" (line {text.count(chr(10), 0, at) + 1})"
