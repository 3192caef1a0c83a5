"""Changes of single values of a gait, as texts of the command line or as settings in Python."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

from mgs.core.config import read_assignment, set_value


class Change(NamedTuple):
    """A new value of one key of a gait file."""

    key: str  # dotted, such as walk.n_steps
    value: Any  # numbers, texts, lists and dictionaries, as a YAML file holds them
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
        settings: values by key. A key is dotted or, since no Python argument may hold a dot,
            has two underscores in the place of each dot. A dictionary changes the keys that it
            holds and leaves the others of its block as they are.

    Raises:
        ConfigError: an assignment has another form.
    """
    written = (Change(*read_assignment(text), "--set") for text in assignments)
    return (*written, *_from_settings(settings or {}))


def apply(changes: Iterable[Change], tree: Any) -> None:
    """Change nested dictionaries in place; raises ConfigError where a key leads nowhere."""
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
    """Tuples as lists, numbers and arrays of NumPy as Python's, as a YAML file would give them."""
    if isinstance(value, Mapping):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    return value.tolist() if hasattr(value, "tolist") else value
