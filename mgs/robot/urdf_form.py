"""Form of the links and joints of a URDF: what has to be there, what may be there only once.

Parsers pass over what they do not know, and read the first of two elements: `<mass vale="2"/>` is a
link without a mass, and so is a second mass. Elements that are foreign to URDF are left alone,
since simulators have their own; names that are nearly those of URDF are errors.
"""

from __future__ import annotations

import difflib
from collections import Counter
from collections.abc import Collection, Iterator
from xml.etree import ElementTree

from mgs.core.short_text import clipped, shown

CHILDREN = {  # elements that belong inside an element
    "link": ("inertial", "visual", "collision"),
    "joint": ("origin", "parent", "child", "axis", "limit", "mimic", "dynamics"),
    "inertial": ("origin", "mass", "inertia"),
    "visual": ("origin", "geometry"),
    "collision": ("origin", "geometry"),
    "geometry": ("box", "cylinder", "sphere", "mesh", "capsule"),
}
ATTRIBUTES = {
    "link": ("name",),
    "joint": ("name", "type"),
    "origin": ("xyz", "rpy"),
    "axis": ("xyz",),
    "limit": ("lower", "upper", "effort", "velocity"),
    "mimic": ("joint", "multiplier", "offset"),
    "parent": ("link",),
    "child": ("link",),
    "mass": ("value",),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "mesh": ("filename", "scale"),
}
MAY_LACK = {  # attributes that have a default
    *("rpy", "scale", "multiplier", "offset"),
    *(("origin", "xyz"), ("link", "name"), ("joint", "name")),
    *(("limit", key) for key in ATTRIBUTES["limit"]),
}
SEVERAL = {"visual", "collision"}
NEAR = 0.7  # least similarity of a misspelt name


def misshapen(part: ElementTree.Element) -> list[str]:
    """Problems of the form of a link or a joint, one sentence each."""
    called = f"{part.tag} {clipped(part.get('name', ''), 60)}"
    problems = []
    for element in own_elements(part):
        where = called if element is part else f"{called}: {element.tag}"
        problems += [f"{where} {problem}" for problem in _of(str(element.tag), element)]
    return problems


def own_elements(part: ElementTree.Element) -> Iterator[ElementTree.Element]:
    """A link or a joint and the elements of URDF in it, but nothing inside foreign elements.

    `<collision_checking><capsule name="shin"/></collision_checking>` means a capsule of its own.
    """
    yield part
    for child in part:
        if child.tag in CHILDREN or child.tag in ATTRIBUTES:
            yield from own_elements(child)


def _of(tag: str, element: ElementTree.Element) -> list[str]:
    """Problems of one element, without those of the elements inside it."""
    found = Counter(str(child.tag) for child in element)
    inside, keys = CHILDREN.get(tag, ()), ATTRIBUTES.get(tag, ())
    meant = _misspelt(found, inside) | _misspelt(element.attrib, keys)
    problems = [f"has {shown(n)}, which is unknown; did you mean {m!r}?" for m, n in meant.items()]
    problems += [
        f"has {found[child]} elements <{child}>; remove all but one"
        for child in inside
        if found[child] > 1 and child not in SEVERAL
    ]
    if tag == "geometry" and sum(found[shape] for shape in inside) > 1:
        problems.append("has several shapes; give each shape an element of its own")
    if tag == "inertial" and not found["mass"] and "mass" not in meant:
        problems.append("has no mass; add <mass value>")
    needed = (k for k in keys if k not in element.attrib and not {k, (tag, k)} & MAY_LACK)
    return problems + [f"has no {key}; add this attribute" for key in needed if key not in meant]


def _misspelt(names: Collection[str], known: tuple[str, ...]) -> dict[str, str]:
    """Known names that are missing, with the unknown ones that resemble them."""
    lacking = {name.lower(): name for name in known if name not in names}
    meant: dict[str, str] = {}
    for name in names:
        if name not in known and lacking:
            near = difflib.get_close_matches(name.lower()[:30], lacking, n=1, cutoff=NEAR)
            meant |= {lacking[match]: name for match in near}
    return meant
