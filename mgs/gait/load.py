"""From a file or a shipped name to a gait."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from pydantic import create_model

from mgs.core.config import build, parse_yaml, read_text, set_key
from mgs.gait.find import find_gait
from mgs.gait.kinds import GAITS, Gait
from mgs.gait.names import ANY_NAME
from mgs.gait.sequence import resolve_parts, split_assignments


def load_gait(name_or_path: str | Path, assignments: tuple[str, ...] = ()) -> Gait:
    """Read a gait file, or a shipped gait by name such as `melson/walk_5cm`.

    Args:
        name_or_path: a path, or a name below the folder of shipped gaits.
        assignments: `dotted.key=value`, applied before validation.

    Raises:
        ConfigError: the file is missing or malformed, or a value is out of range.
    """
    path = find_gait(name_or_path)
    return parse_gait(read_text(path), path, assignments, path.parent)


def parse_gait(
    text: str,
    source: str | Path,
    assignments: tuple[str, ...] = (),
    folder: Path | None = None,
    *,
    any_name: bool = False,
) -> Gait:
    """Gait from YAML text; raises ConfigError naming `source`.

    A sequence may name other gait files, relative to `folder`; None: it has to hold everything.
    With `any_name` the solver and the generator that the gait names need not be installed here.
    """
    tree: Any = parse_yaml(text, source)
    own = assignments
    if is_sequence := isinstance(tree, dict) and tree.get("motion") == "sequence":
        own, inner = split_assignments(assignments)
    for assignment in own:
        set_key(tree, assignment)
    if is_sequence:
        resolve_parts(tree, source, folder, inner)
    return build(_kind_of(tree), tree, source, ANY_NAME if any_name else None)


def _kind_of(tree: Any) -> type[Gait]:
    """The kind that `motion` names; else one that refuses it and checks the block that is there."""
    kind = tree.get("motion") if isinstance(tree, dict) else None
    if isinstance(kind, str) and kind in GAITS:
        return GAITS[kind]
    there = tree if isinstance(tree, dict) else {}
    looks_like = next((name for name in GAITS if name in there), "walk")
    any_kind: Any = Literal[tuple(GAITS)]
    return create_model("GaitOfUnknownKind", __base__=GAITS[looks_like], motion=(any_kind, ...))
