"""From a file or a shipped name to a gait."""

from __future__ import annotations

import importlib.resources
from pathlib import Path
from typing import Any, Literal

from pydantic import create_model

from mgs.config import build, is_file, parse_yaml, read_text, set_key
from mgs.errors import ConfigError
from mgs.gait.kinds import GAITS, BalanceGait, Gait, WalkGait


def load_gait(name_or_path: str | Path, assignments: tuple[str, ...] = ()) -> Gait:
    """Read a gait file, or a shipped gait by name such as `melson/walk_5cm`.

    Args:
        name_or_path: a path, or a name below the folder of shipped gaits.
        assignments: `dotted.key=value`, applied before validation.

    Raises:
        ConfigError: the file is missing or malformed, or a value is out of range.
    """
    path = find_gait(name_or_path)
    return parse_gait(read_text(path), path, assignments)


def parse_gait(text: str, source: str | Path, assignments: tuple[str, ...] = ()) -> Gait:
    """Gait from YAML text; raises ConfigError naming `source`."""
    tree: Any = parse_yaml(text, source)
    for assignment in assignments:
        set_key(tree, assignment)
    return build(_kind_of(tree), tree, source)


def _kind_of(tree: Any) -> type[WalkGait] | type[BalanceGait]:
    """The kind that `motion` names; else one that refuses it and checks the block that is there."""
    kind = tree.get("motion") if isinstance(tree, dict) else None
    if isinstance(kind, str) and kind in GAITS:
        return GAITS[kind]
    looks_like = "balance" if isinstance(tree, dict) and "balance" in tree else "walk"
    any_kind: Any = Literal[tuple(GAITS)]
    return create_model("GaitOfUnknownKind", __base__=GAITS[looks_like], motion=(any_kind, ...))


def find_gait(name_or_path: str | Path) -> Path:
    """Path of a gait given by path or shipped name; raises ConfigError listing what ships.

    Gaits for any robot, those of the folder `generic`, may be called by their last name alone.
    """
    path = Path(name_or_path)
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
