"""Malformed URDFs and robot folders, and what of them must not be dropped without a word.

The oracle reads the text with a parser and a few lines of its own: the masses of all links are
added, and the joints that move are listed. A robot that mgs accepts has this mass and these
joints, or a note names what is missing.
"""

from __future__ import annotations

import copy
import json
import math
import random
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.dom import minidom
from xml.etree import ElementTree

import yaml

from tests.fuzz.case import Case
from tests.fuzz.changes import changed_bytes, changed_text, changed_yaml, shipped
from tests.support.mjcf_biped import CUBE
from tests.support.mjcf_biped import mjcf as sound_mjcf

ROBOTS = ("melson", "coman")
NUMBERS = ["0", "-1", "1e308", "1e-320", "nan", "inf", "nan nan nan", "0 0 0", "1 2", "", "${a}"]
NAMES = ["world", "base", "root_joint", "universe", "\x85", "a" * 3000, "ÿ", " ", "$x^{$", "a b"]
RAW = [*NUMBERS, *NAMES, "&#27;[31m", "&#xd7ff;", "&lt;", "&a;"]  # in the text of an attribute
KINDS_OF_JOINT = ["fixed", "revolute", "continuous", "prismatic", "floating", "planar", "screw"]
KEY = f'<keyframe><key name="home" qpos="0 0 0.9 1 0 0 0 {"0 " * 19}"/></keyframe>'
EQUALITIES = ["", '<joint joint1="left_knee" joint2="right_knee"/>']
MOVING = {"revolute", "continuous", "prismatic", "floating", "planar"}
RAISED = re.compile("raised from ([^ ]+) kg to ([^ ]+) kg")
SAME_MASS = 1e-6  # largest relative difference: sums in another order


def urdf(rng: random.Random) -> Case:
    """A URDF, of which a robot is to be made."""
    text = changed_urdf(shipped("robots", f"{rng.choice(ROBOTS)}/robot.urdf"), rng)
    command = ("robot", "init", "a.urdf", "-o", "out", "--json")
    return Case("urdf", {"a.urdf": text.encode("utf-8", "replace")}, command)


def mjcf(rng: random.Random) -> Case:
    """An MJCF, or a mesh that belongs to it, of which a robot is to be made."""
    text, mesh = sound_mjcf(KEY, rng.choice(EQUALITIES)), CUBE.encode()
    if rng.random() < 0.1:
        mesh = changed_bytes(mesh, rng)
    else:
        text = changed_urdf(text, rng)
    files = {"a.xml": text.encode("utf-8", "replace"), "foot.obj": mesh}
    return Case("mjcf", files, ("robot", "init", "a.xml", "-o", "out", "--json"))


def robot(rng: random.Random) -> Case:
    """A robot folder, to be shown, checked or used."""
    name = rng.choice(ROBOTS)
    spec, text = (shipped("robots", f"{name}/robot.{end}") for end in ("yaml", "urdf"))
    data = spec.encode()
    if rng.random() < 0.5:
        data = changed_yaml(yaml.safe_load(spec), rng)
    else:
        text = changed_urdf(text, rng)
    files = {"r/robot.yaml": data, "r/robot.urdf": text.encode("utf-8", "replace")}
    command = rng.choice([
        ("robot", "show", "r", "--json"), ("robot", "show", "r", "--json"),
        ("robot", "check", "r", "--json"),
        ("generate", f"{name}/bow", "--robot", "r", "--set", "dt=0.1", "-o", "out/a.mcap"),
    ])  # fmt: skip
    return Case("robot", files, command)


def changed_urdf(text: str, rng: random.Random) -> str:
    """URDF whose elements or whose text are changed."""
    change = _changed_tree if rng.random() < 0.6 else _changed_lines
    return change(text, rng)


def _changed_lines(text: str, rng: random.Random) -> str:
    """URDF with values of attributes replaced, lines repeated, or its text changed."""
    lines = text.splitlines(keepends=True)
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(lines))
        match rng.randrange(4):
            case 0:
                del lines[at]
            case 1:
                lines.insert(at, lines[rng.randrange(len(lines))] * rng.choice([1, 2, 200]))
            case 2:
                lines[at] = changed_text(lines[at], rng)
            case _:
                head, quote, rest = lines[at].partition('="')
                if quote:
                    after = rest.partition('"')[2]
                    lines[at] = f'{head}="{rng.choice(RAW)}"{after}'
        if not lines:
            break
    return "".join(lines)


def _changed_tree(text: str, rng: random.Random) -> str:
    """URDF that is XML still, with elements or attributes changed, removed, repeated or moved."""
    root = ElementTree.fromstring(text)
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        places = [(above, element) for above in root.iter() for element in above]
        if not places:
            break
        tag = rng.choice(sorted({element.tag for _, element in places}))  # rare ones as often
        above, element = rng.choice([place for place in places if place[1].tag == tag])
        rng.choice(TREE_CHANGES)(root, above, element, rng)
    return ElementTree.tostring(root, encoding="unicode")


Change = Callable[[ElementTree.Element, ElementTree.Element, ElementTree.Element, Any], None]


def _remove(root: Any, above: Any, element: Any, rng: random.Random) -> None:
    del root, rng
    above.remove(element)


def _repeat(root: Any, above: Any, element: Any, rng: random.Random) -> None:
    del root
    for _ in range(rng.choice([1, 1, 2, 300])):
        above.append(copy.deepcopy(element))  # the same one would be changed everywhere


def _move(root: Any, above: Any, element: Any, rng: random.Random) -> None:
    above.remove(element)
    rng.choice(list(root.iter())).append(element)


def _misspell(root: Any, above: Any, element: Any, rng: random.Random) -> None:
    del root, above
    if element.attrib and rng.random() < 0.7:
        key = rng.choice(sorted(element.attrib))
        element.attrib[rng.choice([key[1:], key.upper(), f"{key}x"]) or "x"] = element.attrib.pop(
            key
        )
    else:
        element.tag = rng.choice([element.tag[1:], element.tag.upper(), f"{element.tag}x"])


def _replace(root: Any, above: Any, element: Any, rng: random.Random) -> None:
    """Another value; of a number often one nearby, of a name often one of the same kind."""
    del above
    if not element.attrib:
        return
    key = rng.choice(sorted(element.attrib))
    others = sorted({e.get(key) for e in root.iter(element.tag) if e.get(key) is not None})
    choices = [
        rng.choice(NUMBERS),
        rng.choice(NAMES),
        rng.choice(others),
        _near(element.get(key), rng),
    ]
    if (element.tag, key) == ("joint", "type"):
        choices = [rng.choice(KINDS_OF_JOINT)]
    element.set(key, rng.choice(choices))


def _forget(root: Any, above: Any, element: Any, rng: random.Random) -> None:
    del root, above
    if element.attrib:
        del element.attrib[rng.choice(sorted(element.attrib))]


def _near(value: str, rng: random.Random) -> str:
    """Numbers times a factor each; other texts as they are."""
    try:
        numbers = [float(word) for word in value.split()]
    except ValueError:
        return value
    factors = [0.0, -1.0, 0.5, 1.1, 2.0, 100.0, 1000.0]
    return " ".join(repr(number * rng.choice(factors)) for number in numbers)


TREE_CHANGES: list[Change] = [_remove, _repeat, _move, _misspell, _replace, _replace, _forget]


def dropped(case: Case, stdout: bytes, folder: Path) -> str:
    """What an accepted robot lacks of its text without a note; empty if nothing.

    Args:
        case: of the kinds urdf and robot.
        stdout: output of its command, which has ended with exit code 0.
        folder: where the command ran.
    """
    if case.command[:2] not in (("robot", "init"), ("robot", "show")):
        return ""
    told = json.loads(stdout)
    if case.command[1] == "init":
        text, spec = case.files["a.urdf"], (folder / "out/robot.yaml").read_text()
        notes = " ".join(told["notes"])
    else:
        text, spec = case.files["r/robot.urdf"], case.files["r/robot.yaml"].decode()
        notes = ""
    masses, joints = masses_and_joints(text)
    content = yaml.safe_load(spec)
    missing = joints - set(content["joints"]) - set(content.get("locked", {}))
    if unnamed := {joint for joint in missing if joint not in notes}:
        return f"joints dropped: {', '.join(sorted(unnamed))[:200]}"
    total = math.fsum(masses.values())
    if math.isnan(total):
        return "a mass that is no number is accepted"
    named = math.fsum(mass for link, mass in masses.items() if link in notes)
    raised = sum(float(after) - float(before) for before, after in RAISED.findall(notes))
    if abs(told["mass"] - total) > SAME_MASS * total + named + 1.1 * raised:  # of two digits
        return f"mass {told['mass']:.6g} kg, {total:.6g} kg in the text"
    return ""


def masses_and_joints(text: bytes) -> tuple[dict[str, float], set[str]]:
    """Mass of each link [kg], and names of the joints that move, by a parser of their own."""
    root = minidom.parseString(text).documentElement
    masses: dict[str, float] = {}
    for link in _children(root, "link"):
        values = [
            float(mass.getAttribute("value") or "nan")
            for inertial in _children(link, "inertial")
            for mass in _children(inertial, "mass")
        ]
        name = link.getAttribute("name")
        masses[name] = masses.get(name, 0.0) + math.fsum(values)
    joints = _children(root, "joint")
    return masses, {j.getAttribute("name") for j in joints if j.getAttribute("type") in MOVING}


def _children(node: Any, tag: str) -> list[Any]:
    return [child for child in node.childNodes if child.nodeName == tag]
