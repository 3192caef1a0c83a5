"""Tests of the wording that people read: help pages, descriptions of keys, docstrings.

They check what a program can check: that a text exists, is a phrase of its own and names its unit.
"""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
import pytest

import mgs
from mgs.cli import main
from tests.support.commands import run

PACKAGE = Path(mgs.__file__).parent
KINDS = ("gait", "robot", "sweep", "motors", "unit")
FRAGMENT = re.compile(r"(Of|At most|As|Whether it|The same|That of|Times|Not)\b")
UNIT_ONLY = re.compile(r"\[[^]]*\]\.?")
UNIT = re.compile(r"\[[^]]+\]|\bunit of the key\b")
LEAST_WORDS = 3
HELP_WIDTH = 80
# Real numbers without a physical dimension: weights, gains and parts of a whole.
DIMENSIONLESS = {
    "gait: FarajiParameters.damping",
    "gait: FarajiParameters.gamma",
    "gait: FarajiParameters.soft",
    "gait: IkParameters.gamma_momentum",
    "gait: PrioritizedParameters.feedback",
    "gait: TrajectoryParameters.tolerance",
    "gait: TrajectoryParameters.weight_joint",
    "gait: TrajectoryParameters.weight_limit",
    "gait: WalkParameters.arm_swing",
    "gait: WalkParameters.landing",
    "gait: WholeBodyIkParameters.gamma_momentum",
}


def problem(text: str) -> str | None:
    """Reason why a text cannot be understood by itself; None if no reason is found."""
    first = text.strip().partition("\n")[0]
    if FRAGMENT.match(first):
        return f"starts with {first.split()[0]!r}"
    if UNIT_ONLY.fullmatch(first):
        return "is a unit only"
    if len(first.split()) < LEAST_WORDS:
        return f"has fewer than {LEAST_WORDS} words"
    return None


def commands(
    command: click.Command, path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], click.Command]]:
    """A command and all its subcommands, with their paths."""
    yield path, command
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            child = command.get_command(context, name)
            assert child is not None
            yield from commands(child, (*path, name))


COMMANDS = dict(commands(main))
GROUPS = [path for path, command in COMMANDS.items() if isinstance(command, click.Group)]


def fields() -> dict[str, tuple[dict[str, Any], dict[str, Any]]]:
    """Schema of every key of every kind of file, with the schema of the whole file."""
    found = {}
    for kind in KINDS:
        schema: dict[str, Any] = json.loads(run("schema", kind).stdout)
        models = {schema.get("title", kind): schema, **schema.get("$defs", {})}
        for model, content in models.items():
            for key, field in content.get("properties", {}).items():
                found[f"{kind}: {model}.{key}"] = field, schema
    return found


FIELDS = fields()


def description(field: dict[str, Any], schema: dict[str, Any]) -> str:
    """Description of a key, or of the model that its value has."""
    if "description" in field:
        return str(field["description"])
    for part in (field, *field.get("anyOf", []), *field.get("oneOf", []), *field.get("allOf", [])):
        if "$ref" in part:
            target = schema["$defs"][part["$ref"].rpartition("/")[2]]
            return str(target.get("description", ""))
    return ""


def has_real_numbers(field: dict[str, Any]) -> bool:
    """True if the values are real numbers, or lists or mappings of them."""
    inside = [field.get(key) for key in ("items", "additionalProperties")]
    parts = [*field.get("anyOf", []), *field.get("prefixItems", [])]
    parts += [part for part in inside if isinstance(part, dict)]
    return field.get("type") == "number" or any(has_real_numbers(part) for part in parts)


def docstrings() -> Iterator[tuple[str, str]]:
    """Docstrings of all modules, classes and functions of mgs, with their places."""
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
                text = ast.get_docstring(node)
                if text:
                    name = getattr(node, "name", "module")
                    yield f"{path.relative_to(PACKAGE).as_posix()}: {name}", text


def test_every_command_and_every_option_has_a_help_text():
    for path, command in COMMANDS.items():
        name = " ".join(("mgs", *path))
        assert problem(command.help or "") is None, name
        for option in command.params:
            if isinstance(option, click.Option):
                assert problem(option.help or "") is None, f"{name} {option.opts[-1]}"


@pytest.mark.parametrize("path", GROUPS, ids=lambda path: " ".join(("mgs", *path)))
def test_every_subcommand_has_a_short_help_on_one_whole_line(path: tuple[str, ...]):
    lines = run(*path, "--help").stdout.split("Commands:\n")[1].splitlines()
    names = [child[-1] for child in COMMANDS if child[:-1] == path and child]
    assert [line.split()[0] for line in lines] == sorted(names)  # no line is wrapped
    for line in lines:
        text = line.split(maxsplit=1)[1]
        assert len(line) <= HELP_WIDTH
        assert text.endswith(".") and not text.endswith("..."), line
        assert problem(text) is None, line


def test_the_schemas_have_keys_and_the_package_has_docstrings():
    """The tests below must not pass for want of texts."""
    assert len(FIELDS) > 150
    assert len(list(docstrings())) > 1000
    assert {name.partition(":")[0] for name in FIELDS} == set(KINDS)
    assert sum(has_real_numbers(field) for field, _ in FIELDS.values()) > 80


def unclear_descriptions() -> dict[str, str]:
    """Keys without a description that can be understood by itself, with the reasons."""
    found = {}
    for name, (field, schema) in FIELDS.items():
        text = description(field, schema)
        reason = problem(text)
        if reason is None and has_real_numbers(field) and name not in DIMENSIONLESS:
            reason = None if UNIT.search(text) else "names no unit in square brackets"
        if reason is not None:
            found[name] = f"{reason}: {text!r}"
    return found


def unclear_docstrings() -> dict[str, str]:
    """Docstrings whose first line cannot be understood by itself, with the reasons."""
    reasons = ((place, problem(text)) for place, text in docstrings())
    return {place: reason for place, reason in reasons if reason is not None}


def test_every_key_has_a_description_with_its_unit():
    assert unclear_descriptions() == {}


def test_every_docstring_begins_with_a_phrase_of_its_own():
    assert unclear_docstrings() == {}


def test_no_dimensionless_key_is_missing_or_has_a_unit():
    for name in DIMENSIONLESS:
        field, schema = FIELDS[name]
        assert has_real_numbers(field), name
        assert not UNIT.search(description(field, schema)), name


@pytest.mark.parametrize(
    "text",
    ["Of the gear [N m].", "At most.", "[N m]", "As above, but longer.", "Times it is done.", "P."],
)
def test_a_fragment_is_recognized(text: str):
    assert problem(text) is not None


@pytest.mark.parametrize(
    "text", ["Number of repetitions.", "Offset of the ZMP [m].", "Assembly of a motion."]
)
def test_a_phrase_is_accepted(text: str):
    assert problem(text) is None
