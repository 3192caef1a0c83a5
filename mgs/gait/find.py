"""Search for gait files: by path, or by the name of a shipped gait."""

from __future__ import annotations

import difflib
import re
from itertools import takewhile
from pathlib import Path

from mgs.core.config import is_file
from mgs.core.errors import ConfigError
from mgs.core.shipped import shipped_folder

SENTENCE_END = r"(?<=[a-z0-9)]{2})\. "  # not the full stop after an initial


def find_gait(name_or_path: str | Path, folder: Path | None = None) -> Path:
    """Path of a gait given by path or by name; raises ConfigError with the names nearest to it.

    A path is relative to `folder`; None: to the working directory. Gaits in the shipped folder
    `generic`, which suit any robot, may be named without their folder.
    """
    path = (folder or Path()) / name_or_path
    if is_file(path):
        return path
    shipped = shipped_folder("gaits")
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


def list_gaits() -> list[str]:
    """Names of the shipped gaits."""
    root = shipped_folder("gaits")
    return sorted(p.relative_to(root).with_suffix("").as_posix() for p in root.rglob("*.yaml"))
