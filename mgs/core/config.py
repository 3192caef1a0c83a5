"""The border to files that people write: safe YAML, strict models, messages that help."""

from __future__ import annotations

import re
from collections.abc import Hashable
from pathlib import Path
from typing import Annotated, Any, Literal, NoReturn, TypeVar

import pydantic
import yaml

from mgs.core.errors import ConfigError
from mgs.core.explain import explain
from mgs.core.short_text import clipped, shown

MAX_BYTES = 1_000_000  # no gait or robot file comes near it; keeps a wrong file from filling memory
MAX_DEPTH = 30  # nesting of any file that we read is below 6


class Model(pydantic.BaseModel):
    """Base of all file models: frozen, strict, no unknown keys, no NaN or infinity.

    A model is built when it first validates something, so that a command pays for the kind of file
    that it reads alone. For the same reason nested defaults are factories, not instances.
    """

    model_config = pydantic.ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        validate_default=True,
        defer_build=True,
    )


M = TypeVar("M", bound=Model)


def _refuse_true(value: object) -> object:
    """To Python True and 1.0 equal 1, so that a Literal[1] takes them."""
    if type(value) is not int:
        raise ValueError(f"input should be 1, found {shown(value)}")
    return value


FormatVersion = Annotated[Literal[1], pydantic.BeforeValidator(_refuse_true)]


class _Loader(yaml.SafeLoader):
    """Safe loader: 1e-6 is a number; no repeated keys, aliases, tags or deep nesting."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        loader: Any = self  # PyYAML's type stubs differ from one version to the next
        event = loader.peek_event()
        depth = getattr(self, "depth", 0)
        if isinstance(event, yaml.AliasEvent):
            self._refuse(event, "YAML aliases (*name) are not allowed")
        if event.tag is not None:  # `!!int ""` and its like make PyYAML raise almost anything
            self._refuse(event, "YAML tags (!name) are not allowed")
        if depth > MAX_DEPTH:
            self._refuse(event, f"nested deeper than {MAX_DEPTH} levels")
        self.depth = depth + 1
        node = super().compose_node(parent, index)
        self.depth = depth
        return node

    def _refuse(self, event: Any, problem: str) -> NoReturn:
        raise yaml.composer.ComposerError(None, None, problem, event.start_mark)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[Any] = set()
        for key_node, _ in node.value:
            key = (key_node.tag, getattr(key_node, "value", None))
            if isinstance(key_node, yaml.ScalarNode):
                if key in seen:
                    raise yaml.constructor.ConstructorError(
                        None,
                        None,
                        f"key {shown(key_node.value)} appears twice",
                        key_node.start_mark,
                    )
                seen.add(key)
        return super().construct_mapping(node, deep)


# YAML 1.1 wants a dot in every float, so that PyYAML reads 1e-6 as text.
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?[0-9][0-9_]*(?:\.[0-9_]*)?[eE][-+]?[0-9]+$"),
    list("-+0123456789"),
)


def parse_yaml(text: str, source: str | Path) -> Any:
    """Content of a YAML text; raises ConfigError naming `source`, line and column."""
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise ConfigError(source, f"{place}{error.problem or error.context}") from error
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        raise ConfigError(source, f"not valid YAML: {shown(error)}") from error


def read_text(path: Path) -> str:
    """Text of a file; raises ConfigError when it is missing, too large or not UTF-8."""
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        if len(data) > MAX_BYTES:
            raise ConfigError(
                path, f"larger than {MAX_BYTES // 1000} kB, cannot be one of our files"
            )
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ConfigError(path, f"not a text file (byte {error.start} is not UTF-8)") from error
    except OSError as error:
        raise ConfigError(path, (error.strerror or str(error)).lower()) from error
    except ValueError as error:  # a zero byte in the name
        raise ConfigError(path, str(error)) from error


def is_file(path: Path) -> bool:
    """Whether there is such a file; no where the system takes the name for too long to look."""
    try:
        return path.is_file()
    except OSError:
        return False


def read_assignment(text: str, source: str = "--set") -> tuple[str, Any]:
    """Key of `dotted.key=value` and its value, read as YAML.

    Raises:
        ConfigError: the text is of another form; the message names `source`.
    """
    key, equals, value = text.partition("=")
    if not equals or not all(key.strip().split(".")):
        raise ConfigError(source, f"{shown(text)} is not of the form key.sub=value")
    return key.strip(), parse_yaml(value, f"{source} {key.strip()}")


def set_value(tree: Any, key: str, value: object, source: str) -> None:
    """Put a value at a dotted key of nested dictionaries in place; groups are made as needed."""
    path = key.split(".")
    if not all(path) or len(path) > MAX_DEPTH:
        raise ConfigError(source, f"{shown(key)} is not of the form key.sub")
    node = tree
    for part in path[:-1]:
        node = node.setdefault(part, {}) if isinstance(node, dict) else None
    if not isinstance(node, dict):
        raise ConfigError(source, f"{clipped(key, 100)!r}: there is no such group in the file")
    node[path[-1]] = value


def build(
    model: type[M], tree: Any, source: str | Path, context: dict[str, object] | None = None
) -> M:
    """Validate a tree; raises one ConfigError with each bad key, its value and what is allowed.

    Validators of the model find `context` in their `ValidationInfo`.
    """
    if not isinstance(tree, dict):
        found = "nothing" if tree is None else f"a {type(tree).__name__}"
        raise ConfigError(source, f"expected keys and values at the top level, found {found}")
    try:
        return model.model_validate(tree, context=context)
    except pydantic.ValidationError as error:
        items = error.errors(include_url=False)
        problems = [explain(model, item) for item in items[: ConfigError.MOST_TOLD]]
        raise ConfigError(source, problems, len(items)) from error
    except RecursionError as error:
        raise ConfigError(source, "nested too deeply") from error
