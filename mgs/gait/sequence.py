"""From a sequence as written to one that holds everything: named gaits read, changes applied."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mgs.core.config import parse_yaml, read_text, set_key, set_value
from mgs.core.errors import ConfigError
from mgs.gait.find import find_gait
from mgs.gait.kinds import SequenceGait

SHARED = ("robot", "dt")  # keys that a sequence and its parts have to agree on


def split_assignments(assignments: tuple[str, ...]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Assignments for the sequence itself and for each of its parts; `SHARED` ones are for both."""
    keys = [assignment.partition("=")[0].strip().split(".")[0] for assignment in assignments]
    own, inner = [], []
    for key, assignment in zip(keys, assignments, strict=True):
        if key in SequenceGait.model_fields or not key:
            own.append(assignment)
        if key in SHARED or key not in SequenceGait.model_fields:
            inner.append(assignment)
    return tuple(own), tuple(inner)


def resolve_parts(
    tree: Any, source: str | Path, folder: Path | None, assignments: tuple[str, ...]
) -> None:
    """Put gaits in the place of their names, in place; what is malformed is left for validation.

    Args:
        tree: content of a gait file with `motion: sequence`.
        source: of the tree, for messages.
        folder: that paths of gaits are relative to; None: no other file may be read.
        assignments: `dotted.key=value` for the gait of each part.

    Raises:
        ConfigError: a gait is not found or not YAML, or is a sequence itself.
    """
    block = tree.get("sequence")
    parts = block.get("parts") if isinstance(block, dict) else None
    for i, part in enumerate(parts if isinstance(parts, list) else []):
        if isinstance(part, dict):
            try:
                _resolve(part, tree, folder, assignments)
            except ConfigError as error:
                problems = [f"sequence.parts.{i}: {line}" for line in str(error).splitlines()]
                raise ConfigError(source, problems) from error


def _resolve(
    part: dict[Any, Any], tree: dict[Any, Any], folder: Path | None, assignments: tuple[str, ...]
) -> None:
    gait = part.get("gait")
    if isinstance(gait, str):
        if folder is None:
            raise ConfigError("gait", f"{gait!r} is another file; write the gait itself here")
        path = find_gait(gait, folder)
        part.setdefault("name", gait)
        gait = part["gait"] = parse_yaml(read_text(path), path)
    elif isinstance(gait, dict):
        for key in SHARED:
            if tree.get(key) is not None:
                gait.setdefault(key, tree[key])
    if not isinstance(gait, dict):
        return
    if gait.get("motion") == "sequence":
        raise ConfigError("gait", "a sequence has no sequence among its parts; write its parts out")
    changes = part.pop("set", {})
    if not isinstance(changes, dict):
        raise ConfigError("set", "should be keys and values, such as {walk.n_steps: 4}")
    for key, value in changes.items():
        set_value(gait, str(key), value, "set")
    for assignment in assignments:
        set_key(gait, assignment)
