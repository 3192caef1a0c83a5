"""The files of an MJCF model: what it includes, and its meshes.

MuJoCo opens no file itself: included elements are put in place here, and meshes are handed over by
their content. Files lie in the folder of the model, or in folders that the user names, and nowhere
else. A file that is included is looked for beside the model and beside the file that includes it.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from xml.etree import ElementTree

from mgs.core.errors import ConfigError
from mgs.core.input_files import is_file, is_inside, read_bytes
from mgs.core.limits import MAX_INCLUDES, MAX_MESH, MAX_URDF, MAX_XML_ELEMENTS, MAX_XML_NESTING
from mgs.core.short_text import shown
from mgs.robot.urdf_bounds import parse_counted

NOT_READ = "cannot read it as an MJCF"


def with_includes(
    root: ElementTree.Element, path: Path, folders: tuple[Path, ...]
) -> ElementTree.Element:
    """The root element of a model with the content of all included files in place.

    Args:
        root: root element of the model, which is changed.
        path: path of the model.
        folders: folders besides that of the model in which files may lie.

    Raises:
        ConfigError: a file is missing, lies elsewhere, is included twice or by itself, or all of
            them together are too large.
    """
    seen = {path.resolve()}
    pending = [(root, path)]
    while pending:
        inner, file = pending.pop()
        for parent in list(inner.iter()):
            for place, element in reversed(list(enumerate(parent))):
                if element.tag != "include":
                    continue
                name = element.get("file", "")
                found = _included(name, path, file, folders)
                if found in seen:
                    raise ConfigError(path, f"{NOT_READ}: {shown(name)} is included twice")
                seen.add(found)
                if len(seen) > MAX_INCLUDES:
                    raise ConfigError(
                        path, f"{NOT_READ}: it includes more than {MAX_INCLUDES} files"
                    )
                content = read_bytes(found, MAX_URDF, "an MJCF")
                added = parse_counted(content, str(found), NOT_READ)
                parent[place : place + 1] = list(added)
                pending += [(child, found) for child in added]
                if any(child.tag == "include" for child in added):
                    pending.append((parent, found))
    _refuse_large(root, path)
    return root


def find_file(name: str, path: Path, subfolder: str, folders: Iterable[Path]) -> Path | None:
    """Path of a file that a model names; None if it is not found, or lies where it may not.

    Args:
        name: name of the file in the model.
        path: path of the model.
        subfolder: folder of the model's meshes, relative to the model.
        folders: folders besides that of the model in which files may lie.
    """
    places = (path.parent, *folders)
    for folder in places:
        for found in (folder / subfolder / name, folder / name):
            if is_file(found) and is_inside(found, places):
                return found.resolve()
    return None


def mesh_bytes(path: Path, room: int) -> bytes | None:
    """Content of a mesh file of at most `room` bytes; None if it is larger."""
    if path.stat().st_size > min(room, MAX_MESH):
        return None
    return read_bytes(path, MAX_MESH, "a mesh")


def _included(name: str, path: Path, file: Path, folders: tuple[Path, ...]) -> Path:
    found = find_file(name, path, "", (file.parent, *folders))
    if found is None or not is_inside(found, (path.parent, *folders)):
        raise ConfigError(
            path,
            f"{NOT_READ}: the included file {shown(name)} is not found in the folder of the model; "
            "put it there, or give its folder with --package-path",
        )
    return found


def _refuse_large(root: ElementTree.Element, path: Path) -> None:
    """Raise ConfigError where all files together have too many elements, or nest too deeply."""
    level, n, depth = [root], 0, 0
    while level:
        n, depth = n + len(level), depth + 1
        if n > MAX_XML_ELEMENTS:
            raise ConfigError(path, f"{NOT_READ}: it has more than {MAX_XML_ELEMENTS} elements")
        if depth > MAX_XML_NESTING:
            raise ConfigError(
                path, f"{NOT_READ}: nested too deeply, more than {MAX_XML_NESTING} levels"
            )
        level = [child for element in level for child in element]
