"""Search for gait files: by path, or by the name of a shipped gait."""

from __future__ import annotations

from pathlib import Path

from mgs.core.config import is_file
from mgs.core.errors import ConfigError
from mgs.core.shipped import shipped_folder


def find_gait(name_or_path: str | Path, folder: Path | None = None) -> Path:
    """Path of a gait given by path or by name; raises ConfigError with all shipped names.

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
    names = ", ".join(list_gaits())
    raise ConfigError(name_or_path, f"no such file and no gait of that name; shipped: {names}")


def list_gaits() -> list[str]:
    """Names of the shipped gaits."""
    root = shipped_folder("gaits")
    return sorted(p.relative_to(root).with_suffix("").as_posix() for p in root.rglob("*.yaml"))
