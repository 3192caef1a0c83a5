"""Search for gait files: by path, or by the name of a shipped gait."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from itertools import takewhile
from pathlib import Path

from mgs.core.errors import ConfigError
from mgs.core.input_files import is_file, is_inside
from mgs.core.shipped import shipped_folder

SENTENCE_END = r"(?<=[a-z0-9)]{2})\. "  # not the full stop after an initial


def find_gait(name_or_path: str | Path, folder: Path | None = None) -> Path:
    """Path of a gait given by path or by name; raises ConfigError with the names nearest to it.

    A path is relative to `folder`; None: to the working directory. Gaits in the shipped folder
    `generic`, which suit any robot, may be named without their folder. A file that names another
    one gives its own folder as `folder` and may then not lead out of it, except into the working
    directory: a file from somebody else could otherwise have any file of this computer read.
    """
    path = (folder or Path()) / name_or_path
    shipped = shipped_folder("gaits")
    if folder is not None:
        refuse_outside(path, (folder, Path(), shipped), name_or_path)
    if is_file(path):
        return path
    for named in (shipped / f"{name_or_path}.yaml", shipped / "generic" / f"{name_or_path}.yaml"):
        if is_file(named) and shipped in named.resolve().parents:
            return named
    close = difflib.get_close_matches(str(name_or_path)[:60], list_gaits(), n=3, cutoff=0.5)
    hint = f"did you mean {' or '.join(close)}? " if close else ""
    raise ConfigError(
        name_or_path,
        f"no such file and no gait of that name; {hint}mgs gait list shows the shipped gaits",
    )


def about(name: str) -> str:
    """What a shipped gait is for: the first sentence of the comment at the top of its file."""
    text = find_gait(name).read_text(encoding="utf-8")
    comment = [line[1:].strip() for line in takewhile(_is_comment, text.splitlines())]
    return re.split(SENTENCE_END, " ".join(comment))[0].rstrip(".")


def _is_comment(line: str) -> bool:
    """Whether a line of YAML is a comment."""
    return line.startswith("#")


def refuse_outside(path: Path, folders: Iterable[Path], name: str | Path) -> None:
    """Raise ConfigError with `name` unless a path, its links followed, is in one of the folders."""
    if not is_inside(path, folders):
        raise ConfigError(
            name,
            "leads out of the folder of the file that names it; put the file there, or run mgs in "
            "a folder that holds both",
        )


def list_gaits() -> list[str]:
    """Names of the shipped gaits."""
    root = shipped_folder("gaits")
    return sorted(p.relative_to(root).with_suffix("").as_posix() for p in root.rglob("*.yaml"))
