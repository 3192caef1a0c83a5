"""Loading of gaits: from a file, a shipped name or a text."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import create_model

from mgs.core.config import build
from mgs.core.errors import ConfigError
from mgs.core.foreign import told_as
from mgs.core.input_files import read_text
from mgs.core.wrong_type import wrong_type
from mgs.core.yaml_text import dump_yaml, parse_yaml
from mgs.gait.changes import apply, changes_of
from mgs.gait.find import find_gait
from mgs.gait.gait_file import GaitFile
from mgs.gait.kinds import GAITS, Gait
from mgs.gait.names import ANY_NAME
from mgs.gait.recorded import RecordedGait
from mgs.gait.sequence import resolve_parts, split_changes


def load_gait(
    gait: Gait | str | Path, assignments: tuple[str, ...] = (), **settings: object
) -> Gait:
    """Read a gait file, or a shipped gait by name such as `melson/walk_5cm`.

    Args:
        gait: a path, the name of a shipped gait, or a gait to be changed.
        assignments: `dotted.key=value`, applied before validation.
        settings: values by key, applied after the assignments: `walk__n_steps=6`,
            `walk={"n_steps": 6}` or `**{"walk.n_steps": 6}`.

    Raises:
        ConfigError: the file is missing or malformed, or a value is out of range.
        TypeError: `gait` is of another type.
    """
    if isinstance(gait, GaitFile):
        if not assignments and not settings:
            return gait
        source = f"{gait.motion} gait"
        # what the gait leaves out stays left out, since `sizes: robot` derives only that
        stated = dump_yaml(gait.model_dump(exclude_unset=True))
        return parse_gait(stated, source, assignments, settings=settings)
    if not isinstance(gait, str | Path):
        raise wrong_type("the gait", "a Gait, the name of a shipped gait or a file", gait)
    path = find_gait(gait)
    with told_as(lambda what: ConfigError(path, f"no gait can be made of this file: {what}")):
        return parse_gait(read_text(path), path, assignments, path.parent, settings=settings)


def parse_gait(
    text: str,
    source: str | Path,
    assignments: tuple[str, ...] = (),
    folder: Path | None = None,
    *,
    settings: Mapping[str, object] | None = None,
    any_name: bool = False,
) -> Gait:
    """Gait from YAML text; raises ConfigError with `source` in its message.

    A sequence may name other gait files, relative to `folder`; None: the text must contain all
    gaits. Assignments and settings are those of `load_gait`. With `any_name` the solver and the
    generator that the gait names need not be installed, and the motion may be a recorded one:
    so are the gaits of motion files.
    """
    tree: Any = parse_yaml(text, source)
    changes = changes_of(assignments, settings)
    if isinstance(tree, dict) and tree.get("motion") == "sequence":
        own, inner = split_changes(changes)
        apply(own, tree)
        resolve_parts(tree, source, folder, inner)
    else:
        apply(changes, tree)
    return build(_kind_of(tree, any_name), tree, source, ANY_NAME if any_name else None)


def _kind_of(tree: Any, in_motion_file: bool) -> type[Gait]:
    """Model of the kind of `motion`; for an unknown kind, of the block that the file contains.

    The second one reports the unknown kind together with all other errors. A recorded motion is
    known in motion files alone, since nothing can be planned for it.
    """
    kind = tree.get("motion") if isinstance(tree, dict) else None
    if kind == "recorded" and in_motion_file:
        return RecordedGait
    if isinstance(kind, str) and kind in GAITS:
        return GAITS[kind]
    there = tree if isinstance(tree, dict) else {}
    looks_like = next((name for name in GAITS if name in there), "walk")
    any_kind: Any = Literal[tuple(GAITS)]
    return create_model("GaitOfUnknownKind", __base__=GAITS[looks_like], motion=(any_kind, ...))
