"""Where gait files are: at a path, or among those that ship."""

from __future__ import annotations

import importlib.resources
from pathlib import Path
from typing import Literal

from mgs.config import is_file
from mgs.errors import ConfigError


def find_gait(name_or_path: str | Path, folder: Path | None = None) -> Path:
    """Path of a gait given by path or shipped name; raises ConfigError listing what ships.

    A path is relative to `folder`; None: to the working directory. Gaits for any robot, those of
    the shipped folder `generic`, may be called by their last name alone.
    """
    path = (folder or Path()) / name_or_path
    if is_file(path):
        return path
    shipped = shipped_folder("gaits")
    for named in (shipped / f"{name_or_path}.yaml", shipped / "generic" / f"{name_or_path}.yaml"):
        if is_file(named) and shipped in named.resolve().parents:
            return named
    names = ", ".join(list_gaits())
    raise ConfigError(name_or_path, f"no such file and no gait of that name; shipped: {names}")


def list_gaits() -> list[str]:
    """Names of the shipped gaits."""
    root = shipped_folder("gaits")
    return sorted(p.relative_to(root).with_suffix("").as_posix() for p in root.rglob("*.yaml"))


def shipped_folder(kind: Literal["gaits", "robots"]) -> Path:
    """Folder of shipped gaits or robots: inside an installed wheel, else beside the package."""
    package = Path(str(importlib.resources.files("mgs")))
    inside = package / "data" / kind
    return (inside if inside.is_dir() else package.parent / kind).resolve()
