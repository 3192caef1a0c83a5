"""Bounds on a URDF text, checked before any parser of another language sees it.

Pinocchio, PyBullet and MuJoCo descend a chain of links by recursion, so that a long one overflows
their stack, and take a time that grows with the square of the number of links or shapes. Here the
text is read by Python's own parser, which counts while it reads.
"""

from __future__ import annotations

from collections import Counter
from xml.etree import ElementTree

from mgs.core.errors import ConfigError
from mgs.core.limits import (
    MAX_CHAIN,
    MAX_LINKS,
    MAX_SHAPES,
    MAX_URDF,
    MAX_XML_ELEMENTS,
    MAX_XML_NESTING,
)
from mgs.core.short_text import shown

NOT_READ = "cannot read it as a URDF"
PIECE = 1 << 16  # [characters] that the parser is given at a time


class _Counted(ElementTree.TreeBuilder):
    """Builder of a tree that gives up where the tree becomes too large."""

    def __init__(self, source: str, unread: str) -> None:
        super().__init__()
        self.source, self.unread, self.depth, self.n_elements = source, unread, 0, 0

    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:
        """Refuse a document type, whose entities could grow without limit."""
        raise ConfigError(
            self.source, f"{self.unread}: it declares a document type; remove <!DOCTYPE>"
        )

    def start(self, tag: str, attrs: dict[str, str]) -> ElementTree.Element:
        """Begin an element."""
        self.depth += 1
        self.n_elements += 1
        if self.depth > MAX_XML_NESTING:
            self._refuse(f"nested too deeply, more than {MAX_XML_NESTING} levels")
        if self.n_elements > MAX_XML_ELEMENTS:
            self._refuse(f"it has more than {MAX_XML_ELEMENTS} elements")
        return super().start(tag, attrs)

    def end(self, tag: str) -> ElementTree.Element:
        """End an element."""
        self.depth -= 1
        return super().end(tag)

    def _refuse(self, problem: str) -> None:
        raise ConfigError(self.source, f"{self.unread}: {problem}")


def parse_bounded(text: str | bytes, source: str) -> ElementTree.Element:
    """Root element of a URDF that is small enough for every parser.

    Args:
        text: text of the URDF.
        source: what messages call it.

    Raises:
        ConfigError: the text is not XML, or has too many elements, links, joints or links in a row.
    """
    root = parse_counted(text, source)
    refuse_large(root, source)
    return root


def parse_counted(text: str | bytes, source: str, unread: str = NOT_READ) -> ElementTree.Element:
    """Root element of an XML text of limited size, depth and number of elements.

    Args:
        text: the text.
        source: what messages call it.
        unread: how messages say that it cannot be read.

    Raises:
        ConfigError: the text is not XML, or too large.
    """
    if len(text) > MAX_URDF:
        raise ConfigError(source, f"{unread}: it is larger than {MAX_URDF // 10**6} MB")
    parser = ElementTree.XMLParser(target=_Counted(source, unread))
    try:
        for begin in range(0, len(text), PIECE):
            parser.feed(text[begin : begin + PIECE])
        root = parser.close()
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise ConfigError(source, f"{unread}: not valid XML: {error}") from error
    assert isinstance(root, ElementTree.Element)
    return root


def refuse_large(root: ElementTree.Element, source: str) -> None:
    """Raise ConfigError where a URDF has too many links, joints or links in a row."""
    for tag in ("link", "joint"):
        if (n := len(root.findall(tag))) > MAX_LINKS:
            _refuse(source, f"{n} elements <{tag}>, at most {MAX_LINKS} are allowed")
    _refuse_long_chain(root, source)


def refuse_unfit(root: ElementTree.Element, source: str) -> None:
    """Raise ConfigError for what no URDF of a robot folder or a motion file may hold.

    A mesh is another file, and a URDF inside a motion file could name any file of this computer. A
    link below two joints is visited twice by parsers that descend from the root, and so are, twice
    as often, the links below it.
    """
    ends = [_end(joint, "child") for joint in root.findall("joint")]
    if (twice := next((link for link, n in Counter(ends).items() if n > 1), None)) is not None:
        raise ConfigError(
            source, f"link {shown(twice)} is the child of two joints, which is a loop"
        )
    n_shapes = 0
    for link in root.findall("link"):
        shapes = link.findall("collision")
        n_shapes += len(shapes)
        for mesh in link.findall("collision/geometry/mesh"):
            raise ConfigError(
                source,
                f"link {shown(link.get('name'))}: the mesh {shown(mesh.get('filename'))} is a "
                "collision shape, and only mgs robot init reads meshes; use boxes, spheres and "
                "cylinders, which that command makes of meshes",
            )
    if n_shapes > MAX_SHAPES:
        raise ConfigError(source, f"{n_shapes} collision shapes, at most {MAX_SHAPES} are allowed")


def _refuse_long_chain(root: ElementTree.Element, source: str) -> None:
    """Raise ConfigError where a link is too many joints away from the root link."""
    children: dict[str, list[str]] = {}
    below = set()
    for joint in root.findall("joint"):
        parent, child = (_end(joint, tag) for tag in ("parent", "child"))
        children.setdefault(parent, []).append(child)
        below.add(child)
    level = [link for link in children if link not in below]
    seen = set(level)
    for _ in range(MAX_CHAIN + 1):
        level = [child for link in level for child in children.get(link, ()) if child not in seen]
        seen.update(level)
        if not level:
            return
    _refuse(
        source,
        f"link {shown(level[0])} is more than {MAX_CHAIN} joints away from the root link, which is "
        "too long a chain",
    )


def _end(joint: ElementTree.Element, tag: str) -> str:
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")


def _refuse(source: str, problem: str) -> None:
    raise ConfigError(source, f"{NOT_READ}: {problem}")
