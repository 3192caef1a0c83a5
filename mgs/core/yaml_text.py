"""YAML as people read it: the scalars of YAML 1.2 (its core schema), none that can mean two things.

PyYAML follows YAML 1.1, which reads `010` as 8, `1:30` as 90 and `on` as true, and 1e-6 as a text.
Numbers that the two versions read differently are refused; `on`, `yes` and dates are texts.
"""

from __future__ import annotations

import re
from collections.abc import Hashable
from pathlib import Path
from typing import Any, ClassVar, NoReturn

import yaml

from mgs.core.errors import ConfigError
from mgs.core.limits import MAX_NESTING
from mgs.core.short_text import shown

TWO_WAYS = "!two-ways"  # tag of a number that YAML 1.1 and YAML 1.2 read differently
SCALARS = {  # regular expression and first characters of every plain scalar that is no text
    "tag:yaml.org,2002:null": (r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    "tag:yaml.org,2002:bool": (r"true|True|TRUE|false|False|FALSE", list("tTfF")),
    TWO_WAYS: (
        r"[-+]?0[0-9_]+|[-+]?[0-9][0-9_]*(:[0-5]?[0-9])+(\.[0-9_]*)?|[-+]?0b[01_]+"
        r"|[-+]?(0x)?[0-9a-fA-F]*[0-9]_[0-9_]*|[-+]?[0-9_]*_[0-9_]*\.[0-9_]*",
        list("-+0123456789"),
    ),
    "tag:yaml.org,2002:int": (r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+", list("-+0123456789")),
    "tag:yaml.org,2002:float": (
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)"
        r"|\.(nan|NaN|NAN)",
        list("-+.0123456789"),
    ),
}


class _Loader(yaml.SafeLoader):
    """Safe loader of YAML 1.2 that refuses repeated keys, aliases and tags."""

    yaml_implicit_resolvers: ClassVar[dict[str, Any]] = {}  # type: ignore[misc]

    def compose_node(self, parent: Any, index: Any) -> Any:
        loader: Any = self  # the type stubs of PyYAML differ between versions
        event = loader.peek_event()
        depth = getattr(self, "depth", 0)
        if isinstance(event, yaml.AliasEvent):
            self._refuse(event, "YAML aliases (*name) are not allowed")
        if event.tag is not None:  # with tags such as `!!int ""` PyYAML raises arbitrary exceptions
            self._refuse(event, "YAML tags (!name) are not allowed")
        if depth > MAX_NESTING:
            self._refuse(event, f"nested deeper than {MAX_NESTING} levels")
        self.depth = depth + 1
        node = super().compose_node(parent, index)
        self.depth = depth
        return node

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[Any] = set()
        for key_node, value_node in node.value:
            key = (key_node.tag, getattr(key_node, "value", None))
            if isinstance(key_node, yaml.ScalarNode):
                if key in seen:
                    self._refuse(key_node, f"key {shown(key_node.value)} appears twice")
                seen.add(key)
                if key_node.tag == TWO_WAYS:  # such as 05 of {step_length: 0,05}
                    key_node.tag = "tag:yaml.org,2002:str"
                if value_node.tag == TWO_WAYS:
                    self._refuse(value_node, f"{key_node.value}: {_two_ways(value_node.value)}")
        return super().construct_mapping(node, deep)

    def construct_scalar(self, node: Any) -> Any:
        value = super().construct_scalar(node)
        if any("\ud800" <= c <= "\udfff" for c in value):
            self._refuse(node, f"{shown(value)} contains half of a character")
        return value

    def construct_int(self, node: Any) -> int:
        """A whole number: decimal, or in the base that its prefix 0o or 0x tells."""
        return int(self.construct_scalar(node), 0)

    def refuse_two_ways(self, node: Any) -> NoReturn:
        """Refuse a number that has no key of its own, such as an entry of a list."""
        self._refuse(node, _two_ways(node.value))

    def _refuse(self, place: Any, problem: str) -> NoReturn:
        raise yaml.constructor.ConstructorError(None, None, problem, place.start_mark)


for _tag, (_expression, _first) in SCALARS.items():
    _Loader.add_implicit_resolver(_tag, re.compile(f"(?:{_expression})\\Z"), _first)
_Loader.add_constructor("tag:yaml.org,2002:int", _Loader.construct_int)
_Loader.add_constructor(TWO_WAYS, _Loader.refuse_two_ways)


class _Dumper(yaml.SafeDumper):
    """Safe dumper that quotes every text which YAML 1.1 or YAML 1.2 would not read as a text."""


for _tag, (_expression, _first) in SCALARS.items():
    _Dumper.add_implicit_resolver(_tag, re.compile(f"(?:{_expression})\\Z"), _first)


def _two_ways(text: str) -> str:
    if ":" in text:
        reading = f"{shown(text)} is a number to the base of 60 for some programs and a text for "
        return f"{reading}others; write one decimal number, or put a text in quotes"
    if "_" in text or "b" in text:
        return f"{shown(text)} is a number for some programs and a text for others; write it as a "\
               "decimal number without underscores, or put a text in quotes"  # fmt: skip
    plain = text.replace("_", "").lstrip("+-0") or "0"
    sign = "-" if text.startswith("-") else ""
    return (
        f"{shown(text)} begins with a zero and is octal for some programs; write "
        f"{shown(sign + plain)[1:-1]}, or put a text in quotes"
    )


def parse_yaml(text: str, source: str | Path) -> Any:
    """Content of a YAML text; raises ConfigError with `source`, line and column."""
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        problem = error.problem or error.context or ""
        hint = "; YAML is indented with spaces, not with tabs" if r"'\t'" in problem else ""
        raise ConfigError(source, f"{place}{problem}{hint}") from error
    except RecursionError as error:
        raise ConfigError(source, "nested too deeply") from error
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        raise ConfigError(source, f"not valid YAML: {shown(error)}") from error


def dump_yaml(tree: Any, *, width: float | None = None, flow: bool | None = None) -> str:
    """Text of plain data, from which `parse_yaml` makes the same data again.

    Args:
        tree: nested dictionaries, lists, texts and numbers.
        width: of a line [characters]; None: 80.
        flow: whether mappings and lists are in brackets; None: only those that hold no others.
    """
    settings: dict[str, Any] = {"sort_keys": False, "default_flow_style": flow}
    if width is not None:
        settings["width"] = width
    return str(yaml.dump(tree, Dumper=_Dumper, **settings))
