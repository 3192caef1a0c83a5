"""Changes of single values of a gait: texts on the command line or settings in Python."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

from mgs.core.config import read_assignment, set_value


class Change(NamedTuple):
    """A new value of one key of a gait file."""

    key: str  # dotted path, such as walk.n_steps
    value: Any  # number, text, list or dictionary, as in a YAML file
    source: str  # name of the command's option or of the function's argument, for messages

    @property
    def block(self) -> str:
        """First part of the key."""
        return self.key.partition(".")[0]


def changes_of(
    assignments: Iterable[str], settings: Mapping[str, object] | None = None
) -> tuple[Change, ...]:
    """Changes in the order in which they apply: assignments first, then settings.

    Args:
        assignments: texts of the form `dotted.key=value`, the value as YAML.
        settings: values by key. A key is a dotted path, or has two underscores instead of each
            dot, because names of Python arguments cannot contain dots. A dictionary changes only
            the keys that it contains.

    Raises:
        ConfigError: an assignment is not of this form.
    """
    written = (Change(*read_assignment(text), "--set") for text in assignments)
    return (*written, *_from_settings(settings or {}))


def apply(changes: Iterable[Change], tree: Any) -> None:
    """Change nested dictionaries in place; raises ConfigError if a key leads to no group."""
    for key, value, source in changes:
        set_value(tree, key, value, source)


def _from_settings(settings: Mapping[str, object], group: str = "") -> Iterator[Change]:
    for name, value in settings.items():
        key = group + str(name).replace("__", ".")
        if isinstance(value, Mapping):
            yield from _from_settings(value, f"{key}.")
        else:
            yield Change(key, _plain(value), "settings")


def _plain(value: Any) -> Any:
    """Value as in a YAML file: tuples become lists, NumPy values become Python values."""
    if isinstance(value, Mapping):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    return value.tolist() if hasattr(value, "tolist") else value
