"""Reading of files that people write: safe YAML, strict models and clear error messages."""

from __future__ import annotations

import re
from collections.abc import Hashable
from pathlib import Path
from typing import Annotated, Any, Literal, NoReturn, TypeVar

import pydantic
import yaml

from mgs.core.errors import ConfigError
from mgs.core.short_text import clipped, shown

MAX_BYTES = 1_000_000  # of a file; far above any gait or robot file, and small against memory
MAX_DEPTH = 30  # of nested lists and dictionaries; files of mgs stay below 6


class Model(pydantic.BaseModel):
    """Base of all file models: frozen, strict, no unknown keys, no NaN or infinity.

    Validators are built when a model is first used, so that a command builds only those of the kind
    of file that it reads. For the same reason defaults that are models are given as factories.
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
    """Refuse True and 1.0, which a Literal[1] accepts because Python takes them as equal to 1."""
    if type(value) is not int:
        raise ValueError(f"input should be 1, found {shown(value)}")
    return value


FormatVersion = Annotated[Literal[1], pydantic.BeforeValidator(_refuse_true)]


class _Loader(yaml.SafeLoader):
    """Safe loader that reads 1e-6 as a number and refuses repeated keys, aliases and tags."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        loader: Any = self  # the type stubs of PyYAML differ between versions
        event = loader.peek_event()
        depth = getattr(self, "depth", 0)
        if isinstance(event, yaml.AliasEvent):
            self._refuse(event, "YAML aliases (*name) are not allowed")
        if event.tag is not None:  # with tags such as `!!int ""` PyYAML raises arbitrary exceptions
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


# YAML 1.1 requires a dot in every float, so that PyYAML would read 1e-6 as text.
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?[0-9][0-9_]*(?:\.[0-9_]*)?[eE][-+]?[0-9]+$"),
    list("-+0123456789"),
)


def parse_yaml(text: str, source: str | Path) -> Any:
    """Content of a YAML text; raises ConfigError with `source`, line and column."""
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise ConfigError(source, f"{place}{error.problem or error.context}") from error
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        raise ConfigError(source, f"not valid YAML: {shown(error)}") from error


def read_text(path: Path) -> str:
    """Text of a file; raises ConfigError if it is missing, too large or not UTF-8."""
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        if len(data) > MAX_BYTES:
            raise ConfigError(
                path, f"larger than {MAX_BYTES // 1000} kB, too large for a gait or robot file"
            )
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ConfigError(path, f"not a text file (byte {error.start} is not UTF-8)") from error
    except OSError as error:
        raise ConfigError(path, (error.strerror or str(error)).lower()) from error
    except ValueError as error:  # the name contains a zero byte
        raise ConfigError(path, str(error)) from error


def is_file(path: Path) -> bool:
    """Whether a file exists at a path; False also for a name that is too long for the system."""
    try:
        return path.is_file()
    except OSError:
        return False


def read_assignment(text: str, source: str = "--set") -> tuple[str, Any]:
    """Key and value of an assignment `dotted.key=value`; the value is read as YAML.

    Raises:
        ConfigError: the text is not of this form; the message contains `source`.
    """
    key, equals, value = text.partition("=")
    if not equals or not all(key.strip().split(".")):
        raise ConfigError(source, f"{shown(text)} is not of the form key.sub=value")
    return key.strip(), parse_yaml(value, f"{source} {key.strip()}")


def set_value(tree: Any, key: str, value: object, source: str) -> None:
    """Set the value at a dotted key of nested dictionaries, in place; adds missing dictionaries.

    Raises:
        ConfigError: the key is malformed or leads through a value that is no dictionary.
    """
    path = key.split(".")
    if not all(path) or len(path) > MAX_DEPTH:
        raise ConfigError(source, f"{shown(key)} is not of the form key.sub")
    node = tree
    for part in path[:-1]:
        node = node.setdefault(part, {}) if isinstance(node, dict) else None
    if not isinstance(node, dict):
        raise ConfigError(
            source, f"{clipped(key, 100)!r}: there is no such group of keys in the file"
        )
    node[path[-1]] = value


def build(
    model: type[M], tree: Any, source: str | Path, context: dict[str, object] | None = None
) -> M:
    """Model of nested dictionaries that were read from a file.

    Validators of the model find `context` in their `ValidationInfo`.

    Raises:
        ConfigError: a key is missing or unknown, or a value is not allowed; one line for each.
    """
    if not isinstance(tree, dict):
        found = "nothing" if tree is None else f"a {type(tree).__name__}"
        raise ConfigError(source, f"expected keys and values at the top level, found {found}")
    try:
        return model.model_validate(tree, context=context)
    except pydantic.ValidationError as error:
        from mgs.core.explain import explain  # needed for errors only

        items = error.errors(include_url=False)
        problems = [explain(model, item) for item in items[: ConfigError.MOST_TOLD]]
        raise ConfigError(source, problems, len(items)) from error
    except RecursionError as error:
        raise ConfigError(source, "nested too deeply") from error
