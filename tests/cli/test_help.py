"""Tests of the help pages: every command has one, with an example and without heavy imports."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

import mgs.cli
from mgs.cli import COMMANDS, main
from tests.support.commands import run

HEAVY = [
    *("numpy", "scipy", "pinocchio", "control", "matplotlib", "pybullet", "mujoco", "mcap"),
    *("pydantic", "yaml", "dask", "distributed"),
]


def child(group: click.Group, name: str) -> click.Command:
    """Subcommand of a group, imported now."""
    command = group.get_command(click.Context(group), name)
    assert command is not None
    return command


def commands(command: click.Command, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Paths of a command and of its subcommands, such as ("robot", "list")."""
    yield path
    if isinstance(command, click.Group):
        for name in command.list_commands(click.Context(command)):
            yield from commands(child(command, name), (*path, name))


ALL = list(commands(main))


def test_the_commands_of_the_design_are_there():
    expected = {"generate", "info", "plot", "validate", "replay", "experiment", "export", "schema"}
    expected |= {"batch", "library"}
    assert {path[0] for path in ALL if len(path) == 1} >= expected
    assert {path[1] for path in ALL if path[:1] == ("robot",) and path[1:]} >= {
        "list",
        "show",
        "check",
    }


@pytest.mark.parametrize("path", ALL, ids=" ".join)
@pytest.mark.parametrize("option", ["--help", "-h"])
def test_every_command_explains_itself_with_an_example(path: tuple[str, ...], option: str):
    result = run(*path, option)
    assert result.exit_code == 0
    assert result.stderr == ""
    lines = result.stdout.splitlines()
    start = next(i for i, line in enumerate(lines) if line in ("  Example:", "  Examples:"))
    assert lines[start + 1].startswith("    " + " ".join(("mgs", *path)))  # on a line of its own
    assert "\\b" not in result.stdout
    assert "\b" not in result.stdout


def test_every_command_of_the_source_is_listed():
    """The table of lazy commands forgets none: the source folder is searched for decorators."""
    folder = Path(mgs.cli.__file__).parent
    found = {
        name.rstrip("_")  # of import_, which Python reserves
        for path in folder.glob("*.py")
        for name in re.findall(
            r"^@click\.(?:command|group)\(.*?^def (\w+)\(",
            path.read_text(),
            re.DOTALL | re.MULTILINE,
        )
    }
    elsewhere = {"main", "lookup"}  # the program, and a command of the group library
    assert found - elsewhere == {path[0] for path in ALL if len(path) == 1}


def test_the_list_of_commands_is_what_click_prints_of_imported_ones():
    eager = click.Group("mgs", commands={path[0]: child(main, path[0]) for path in ALL[1:]})
    for command in eager.commands.values():
        command.short_help = COMMANDS[str(command.name)].short_help

    def section(group: click.Group) -> str:
        formatter = click.HelpFormatter(width=80)
        group.format_commands(click.Context(group), formatter)
        return formatter.getvalue()

    assert section(main) == section(eager)
    assert "..." not in section(main)  # no line is cut


def leaves(path: tuple[str, ...]) -> bool:
    return not any(other[: len(path)] == path and other != path for other in ALL)


@pytest.mark.parametrize("path", [path for path in ALL if leaves(path)], ids=" ".join)
def test_every_example_parses(path: tuple[str, ...]):
    """Each example uses options that its command has; the examples are not executed."""
    command: click.Command = main
    for name in path:
        assert isinstance(command, click.Group)
        command = child(command, name)
    lines = (line.strip().partition(" > ")[0].split() for line in (command.help or "").split("\n"))
    examples = [line[1 + len(path) :] for line in lines if line[:1] == ["mgs"]]
    assert examples
    known = {o for p in command.params for o in (*p.opts, *p.secondary_opts)}
    for example in examples:
        assert {word for word in example if word.startswith("-")} <= known


@pytest.mark.parametrize("arguments", [["--help"], ["generate", "--help"], ["--version"], []])
def test_help_imports_nothing_heavy(arguments: list[str]):
    """A new interpreter lists its modules; a time limit would fail on a busy machine."""
    script = f"""
import sys
from mgs.cli import main
try:
    main({arguments!r}, prog_name="mgs")
except SystemExit:
    pass
loaded = {{name.partition(".")[0] for name in sys.modules}}
print("LOADED", *sorted(loaded & set({HEAVY!r})))
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == "LOADED"


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [(["--help"], set()), (["info", "--help"], {"inspect"}), (["robot", "list"], {"robot"})],
)
def test_only_the_module_of_the_command_that_is_called_is_imported(
    arguments: list[str], expected: set[str]
):
    script = f"""
import sys
from mgs.cli import main
try:
    main({arguments!r}, prog_name="mgs")
except SystemExit:
    pass
print("LOADED", *(name for name in sys.modules if name.startswith("mgs.cli.")))
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    loaded = {name.removeprefix("mgs.cli.") for name in done.stdout.split("LOADED")[1].split()}
    assert loaded - {"lazy_group", "process", "common"} == expected


def test_the_version_is_the_version_of_the_package():
    assert run("--version").stdout == f"mgs, version {mgs.__version__}\n"


@pytest.mark.parametrize(
    "arguments",
    [
        ["fly"],
        ["robot", "fly"],
        ["generate"],
        ["--fly"],
        ["generate", "melson/walk_5cm", "--fly"],
        ["generate", "melson/walk_5cm", "melson/walk_arc"],
        ["generate", "melson/walk_5cm", "--set"],
        ["schema", "motion"],
        ["experiment", "fly"],
        ["robot", "show"],
    ],
    ids=" ".join,
)
def test_wrong_usage_is_reported_on_stderr_with_exit_code_two(arguments: list[str]):
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "Error: " in result.stderr
