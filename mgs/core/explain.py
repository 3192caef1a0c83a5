"""Messages about values that the model of a file refuses: key, value, allowed range and unit."""

from __future__ import annotations

import difflib
import re
import types
import typing
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BaseModel

from mgs.core.short_text import clipped, shown

UNIT = re.compile(r"\[[^][,]+\]")  # in the description of a key, such as [m]
RANGES = {"greater_than", "greater_than_equal", "less_than", "less_than_equal"}


@dataclass(frozen=True)
class Place:
    """A place in a file."""

    keys: list[Any]
    models: list[type[BaseModel]]  # the ones that a value there may have; none for plain values
    unit: str  # of a number there, in brackets; empty if it has none


def explain(model: type[BaseModel], item: Any) -> str:
    """One line about one entry of pydantic's `ValidationError.errors()`."""
    place = _place(model, item["loc"])
    keys = place.keys
    if keys[1:] and keys[-1] == "[key]" and item["input"] == keys[-2]:  # the key itself is wrong
        keys.pop()
    location = clipped(".".join(str(key) for key in keys) or "file", 100)
    kind, message, found = item["type"], item["msg"], item["input"]
    if kind == "extra_forbidden":
        return f"{location}: unknown key; {_known_keys(place)}"
    if kind == "missing":
        return f"{location}: missing, it has no default"
    if kind == "value_error":  # our own validators, which name keys and values themselves
        message = message.removeprefix("Value error, ")
        return message if location == "file" else f"{location}: {message}"
    if kind.startswith("union_tag"):
        return f"{location}.{_wrong_tag(place, item)}"
    if kind == "model_attributes_type":
        message = "input should be a valid dictionary"
    if kind in RANGES and place.unit:
        message = f"{message} {place.unit}"
    return f"{location}: {message[0].lower()}{message[1:]}, found {shown(found)}"


def _known_keys(place: Place) -> str:
    known = list(place.models[0].model_fields) if len(place.models) == 1 else []
    close = difflib.get_close_matches(str(place.keys[-1])[:40], known, n=1)
    return f"did you mean {close[0]!r}?" if close else f"known here: {', '.join(sorted(known))}"


def _wrong_tag(place: Place, item: Any) -> str:
    """The key that chooses among several models is missing or has an unknown value."""
    tag, found = item["ctx"]["discriminator"].strip("'"), item["input"]
    allowed = ", ".join(repr(value) for model in place.models for value in _literals(model, tag))
    if tag not in found:
        return f"{tag}: missing, should be one of {allowed}"
    return f"{tag}: input should be one of {allowed}, found {shown(found[tag])}"


def _place(model: type[BaseModel], loc: Iterable[Any]) -> Place:
    """The place in the file that a location of pydantic means.

    For an unknown key its models are those that may hold the key. A tagged union adds its tag to
    the location, although the file has no key of that name.
    """
    keys: list[Any] = []
    annotation: Any = model
    unit = ""
    for part in loc:
        if typing.get_origin(annotation) is Annotated:
            annotation = typing.get_args(annotation)[0]
        models = _models(annotation)
        if len(models) > 1:
            annotation = next(
                m for m in models if any(part in _literals(m, k) for k in m.model_fields)
            )
            continue
        keys.append(part)
        field = models[0].model_fields.get(part) if models else None
        if field is not None:
            annotation = field.annotation
            unit = " or ".join(dict.fromkeys(UNIT.findall(field.description or "")))
        elif not models:  # an item of a list, or a key that people choose: the name of a servo
            annotation = next(iter(reversed(typing.get_args(annotation))), None)
    return Place(keys, _models(annotation), unit)


def _models(annotation: Any) -> list[type[BaseModel]]:
    """Models that a value of this type may have; none for numbers, lists and so on."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if typing.get_origin(annotation) in (Annotated, typing.Union, types.UnionType):
        return [model for part in typing.get_args(annotation) for model in _models(part)]
    return []


def _literals(model: type[BaseModel], key: str) -> tuple[Any, ...]:
    """Values that a key may have, where they are listed."""
    annotation = model.model_fields[key].annotation
    return typing.get_args(annotation) if typing.get_origin(annotation) is Literal else ()
