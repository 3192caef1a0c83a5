"""Text of a gait file that explains its values: what differs from the defaults, with comments."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import yaml

from mgs.gait.kinds import SingleGait

WIDTH = 10_000  # of a line of YAML, so that every value stays on the line of its key


def commented_yaml(
    gait: SingleGait, comments: Mapping[str, str], heading: Iterable[str] = ()
) -> str:
    """Text of a gait file without the values that are defaults.

    Args:
        gait: the gait.
        comments: text behind the value of each key, such as `walk.step_height`; these keys are
            written even if their values are defaults.
        heading: lines of comments at the top of the file.
    """
    whole = gait.model_dump(mode="json")
    tree: dict[str, Any] = gait.model_dump(mode="json", exclude_defaults=True)
    for key in ("mgs", "robot", "motion"):
        tree[key] = whole[key]
    for key in comments:
        block, *names = key.split(".")
        if names:
            tree.setdefault(block, {})[names[0]] = whole[block][names[0]]
        else:
            tree[block] = whole[block]
    ordered = {key: _in_order(tree[key], whole[key]) for key in whole if key in tree}
    lines = [f"# {text}" for text in heading]
    return "\n".join([*lines, *_lines(ordered, comments)]) + "\n"


def _in_order(value: Any, like: Any) -> Any:
    """Dictionary whose keys are in the order of another one; any other value unchanged."""
    if not isinstance(value, dict) or not isinstance(like, dict):
        return value
    return {key: value[key] for key in like if key in value}


def _lines(tree: dict[str, Any], comments: Mapping[str, str], block: str = "") -> Iterator[str]:
    for name, value in tree.items():
        key = f"{block}{name}"
        indent = "  " if block else ""
        if isinstance(value, dict) and not block:
            yield f"{name}:"
            yield from _lines(value, comments, f"{name}.")
            continue
        text = yaml.safe_dump(value, default_flow_style=True, width=WIDTH, sort_keys=False)
        text = text.removesuffix("\n...\n").strip()
        comment = f"  # {comments[key]}" if key in comments else ""
        yield f"{indent}{name}: {text}{comment}"
