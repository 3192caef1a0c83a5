"""The part of an MJCF model that describes the robot, as a text for MuJoCo's compiler.

What makes no difference to the robot, such as textures, cameras, sensors and tendons, is left out,
and so is all that could let a small text cost much: generated meshes, copies, composites. Meshes
are numbered and handed over by their content.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree

from mgs.core.errors import ConfigError
from mgs.core.limits import MAX_LINKS, MAX_MESH
from mgs.robot.init.mjcf.sources import NOT_READ, find_file, mesh_bytes

# Sections and elements that do not describe the robot.
DROPPED = {
    "visual", "statistic", "sensor", "custom", "size", "extension", "deformable", "tendon",
    "option", "texture", "material", "hfield", "skin", "model", "camera", "light", "plugin",
}  # fmt: skip
# Elements that make many bodies out of one, or come with a library of their own.
REFUSED = ("composite", "flexcomp", "flex", "replicate", "attach")
ATTRIBUTES = ("material", "hfield", "user")  # that refer to what is dropped
COMPILER = ("meshdir", "texturedir", "assetdir", "strippath", "discardvisual", "fusestatic")
JOINT_DRIVES = ("joint", "jointinparent")  # attributes of actuators that act on one joint
LOOPS = ("connect", "weld")
PLACEHOLDER = "0 0 0  0.01 0 0  0 0.01 0  0 0 0.01"  # [m] vertices in place of a missing mesh
KEYS = ("home", "stand", "knees_bent")  # names of keyframes that may show a posture to stand in


@dataclass(eq=False)
class ModelText:
    """A text that MuJoCo compiles without any other file."""

    root: ElementTree.Element
    meshes: dict[str, bytes] = field(default_factory=dict)  # content by the name in the text
    missing: dict[str, str] = field(default_factory=dict)  # files not found, by mesh
    paired: set[str] = field(default_factory=set)  # shapes that touch others by an explicit pair
    notes: list[str] = field(default_factory=list)

    @property
    def xml(self) -> str:
        """The text that MuJoCo gets."""
        return ElementTree.tostring(self.root, encoding="unicode")


def robot_text(root: ElementTree.Element, path: Path, folders: tuple[Path, ...]) -> ModelText:
    """Text of the robot in a model whose included files are in place; `root` is changed.

    Raises:
        ConfigError: the model holds what mgs does not read, or has too many bodies or joints.
    """
    for tag in REFUSED:
        if root.find(f".//{tag}") is not None:
            raise ConfigError(
                path,
                f"{NOT_READ}: it has elements <{tag}>; save the compiled model as one MJCF first",
            )
    for tag in ("body", "joint", "freejoint"):
        if (n := sum(1 for _ in root.iter(tag))) > MAX_LINKS:
            raise ConfigError(
                path, f"{NOT_READ}: {n} elements <{tag}>, at most {MAX_LINKS} are allowed"
            )
    text = ModelText(root)
    folder, is_stripped = _mesh_folder(root)
    _take_meshes(text, path, folders, folder, is_stripped)
    for parent in list(root.iter()):
        for element in list(parent):
            if element.tag in DROPPED:
                parent.remove(element)
    for element in root.iter():
        for name in ATTRIBUTES:
            element.attrib.pop(name, None)
    for compiler in root.iter("compiler"):
        for name in COMPILER:
            compiler.attrib.pop(name, None)
    _take_pairs(text)
    _drop_actuators(text)
    _drop_equalities(text)
    _keep_one_key(root)
    for element in root.iter():
        if "file" in element.attrib and element.tag != "mesh":
            raise ConfigError(
                path, f"{NOT_READ}: <{element.tag}> names a file, which mgs does not read"
            )
    return text


def _mesh_folder(root: ElementTree.Element) -> tuple[str, bool]:
    """Folder of the meshes relative to the model, and whether folders in names do not count."""
    folder, is_stripped = "", False
    for compiler in root.iter("compiler"):
        folder = compiler.get("meshdir", compiler.get("assetdir", folder))
        is_stripped = compiler.get("strippath", str(is_stripped)).lower() == "true"
    return folder, is_stripped


def _take_meshes(
    text: ModelText, path: Path, folders: tuple[Path, ...], folder: str, is_stripped: bool
) -> None:
    """Number the meshes and read them; missing ones get the shape of a small tetrahedron."""
    room = MAX_MESH
    for mesh in (m for assets in text.root.iter("asset") for m in assets.findall("mesh")):
        if mesh.get("builtin") is not None:
            raise ConfigError(path, f"{NOT_READ}: generated meshes (builtin) are not supported")
        name = mesh.get("file")
        if name is None:
            continue
        mesh.set("name", mesh.get("name", PurePosixPath(name).stem))
        short = PurePosixPath(name).name if is_stripped else name
        found = find_file(short, path, folder, folders)
        content = None if found is None else mesh_bytes(found, room)
        if found is None or content is None:
            file = name if found is None else f"{name} (too large)"
            text.missing[mesh.get("name", "")] = file
            kept = {"name": mesh.get("name", ""), "class": mesh.get("class", "")}
            mesh.attrib.clear()
            mesh.attrib.update({key: value for key, value in kept.items() if value})
            mesh.set("vertex", PLACEHOLDER)
            mesh.set("scale", "1 1 1")
            continue
        room -= len(content)
        mesh.set("file", f"{len(text.meshes)}{found.suffix.lower()}")
        text.meshes[mesh.get("file", "")] = content


def _take_pairs(text: ModelText) -> None:
    """Note the shapes that touch others by an explicit pair; the floor may be in another file."""
    for section in text.root.iter("contact"):
        for pair in section.findall("pair"):
            text.paired |= {pair.get("geom1", ""), pair.get("geom2", "")}
            section.remove(pair)


def _drop_actuators(text: ModelText) -> None:
    """Leave out actuators that act on something else than one joint."""
    dropped: Counter[str] = Counter()
    for section in text.root.iter("actuator"):
        for actuator in list(section):
            if not any(name in actuator.attrib for name in JOINT_DRIVES):
                section.remove(actuator)
                dropped[actuator.tag] += 1
    if dropped:
        kinds = ", ".join(f"{n} <{tag}>" for tag, n in sorted(dropped.items()))
        text.notes.append(f"actuators that do not act on a single joint ignored: {kinds}")


def _drop_equalities(text: ModelText) -> None:
    """Leave out equality constraints of tendons and soft bodies."""
    for section in text.root.findall("equality"):
        for equality in list(section):
            if equality.tag not in ("joint", *LOOPS):
                section.remove(equality)
                text.notes.append(f"equality constraint <{equality.tag}> ignored")


def _keep_one_key(root: ElementTree.Element) -> None:
    """Keep the joint positions of the keyframe that shows how to stand, of all keyframes."""
    keys = [key for section in root.findall("keyframe") for key in section.findall("key")]
    keys = [key for key in keys if key.get("qpos") is not None]
    ranks = [
        (rank, i)
        for i, key in enumerate(keys)
        for rank, name in enumerate(KEYS)
        if name in key.get("name", "").lower() and "hand" not in key.get("name", "").lower()
    ]
    chosen = keys[min(ranks)[1]] if ranks else None
    for section in list(root.findall("keyframe")):
        root.remove(section)
    if chosen is not None:
        name, qpos = chosen.get("name", ""), chosen.get("qpos", "")
        ElementTree.SubElement(
            ElementTree.SubElement(root, "keyframe"), "key", name=name, qpos=qpos
        )
