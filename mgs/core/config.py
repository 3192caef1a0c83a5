"""Reading of files that people write: safe YAML, strict models and clear error messages.

How files are opened is in `input_files`, how YAML is read in `yaml_text`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import pydantic

from mgs.core.errors import ConfigError
from mgs.core.limits import MAX_NESTING
from mgs.core.short_text import clipped, shown
from mgs.core.yaml_text import parse_yaml


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


def _whole(value: object) -> object:
    """The whole number that a number such as 3.0 is; everything else as it is."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


Whole = Annotated[int, pydantic.BeforeValidator(_whole)]
"""Type of a key that holds a whole number, which people also write as 3.0."""


FormatVersion = Annotated[Literal[1], pydantic.BeforeValidator(_refuse_true)]


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
    if not all(path) or len(path) > MAX_NESTING:
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
