"""Completion of sequences: named gaits are read, and changes are applied."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from mgs.core.errors import ConfigError
from mgs.core.input_files import read_text
from mgs.core.short_text import shown
from mgs.core.yaml_text import parse_yaml
from mgs.gait.changes import Change, apply
from mgs.gait.find import find_gait
from mgs.gait.kinds import SequenceGait

SHARED = ("robot", "dt")  # keys with the same value in a sequence and in all its parts


def split_changes(changes: Iterable[Change]) -> tuple[list[Change], list[Change]]:
    """Changes of the sequence itself and of each of its parts; `SHARED` keys apply to both."""
    own, inner = [], []
    for change in changes:
        if change.block in SequenceGait.model_fields:
            own.append(change)
        if change.block in SHARED or change.block not in SequenceGait.model_fields:
            inner.append(change)
    return own, inner


def resolve_parts(
    tree: Any, source: str | Path, folder: Path | None, changes: Sequence[Change]
) -> None:
    """Replace names of gaits by the gaits, in place; malformed parts are left to validation.

    Args:
        tree: content of a gait file with `motion: sequence`.
        source: file or name of the tree, for messages.
        folder: folder to which paths of gaits are relative; None: no other file may be read.
        changes: changes of the gait of each part.

    Raises:
        ConfigError: a gait is not found, is not valid YAML, or is a sequence itself.
    """
    block = tree.get("sequence")
    parts = block.get("parts") if isinstance(block, dict) else None
    for i, part in enumerate(parts if isinstance(parts, list) else []):
        if isinstance(part, dict):
            try:
                _resolve(part, tree, folder, changes)
            except ConfigError as error:
                problems = [f"sequence.parts.{i}: {line}" for line in str(error).splitlines()]
                raise ConfigError(source, problems) from error


def _resolve(
    part: dict[Any, Any], tree: dict[Any, Any], folder: Path | None, changes: Sequence[Change]
) -> None:
    gait = part.get("gait")
    if isinstance(gait, str):
        if folder is None:
            raise ConfigError(
                "gait", f"{gait!r} is another file, which cannot be read here; write out its keys"
            )
        path = find_gait(gait, folder)
        part.setdefault("name", gait)
        gait = part["gait"] = parse_yaml(read_text(path), path)
        if not isinstance(gait, dict) or "motion" not in gait:  # its content is not shown
            raise ConfigError("gait", f"{shown(str(path))} is no gait file: it has no key motion")
    elif isinstance(gait, dict):
        for key in SHARED:
            if tree.get(key) is not None:
                gait.setdefault(key, tree[key])
    if not isinstance(gait, dict):
        return
    if gait.get("motion") == "sequence":
        raise ConfigError("gait", "a sequence cannot be part of a sequence; list its parts instead")
    written = part.pop("set", {})
    if not isinstance(written, dict):
        raise ConfigError("set", "input should be keys and values, such as {walk.n_steps: 4}")
    apply((Change(str(key), value, "set") for key, value in written.items()), gait)
    apply(changes, gait)
