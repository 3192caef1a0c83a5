"""Reference pages of the command line, made from the commands themselves."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator

import click

from mgs.cli import main

INDENT = "  "


def command_names() -> list[str]:
    """Names of the commands that have a page of their own."""
    return main.list_commands(click.Context(main))


def overview_page() -> str:
    """Markdown page that lists all commands."""
    context = click.Context(main, info_name="mgs")
    lines = ["# Command line", "", *_help_text(main), "", "| command | purpose |", "| --- | --- |"]
    for name in command_names():
        command = _child(main, context, name)
        lines.append(f"| [`mgs {name}`](commands/{name}.md) | {command.get_short_help_str(200)} |")
    return "\n".join([*lines, "", *_options(main, context)])


def command_page(name: str) -> str:
    """Markdown page of one command and its subcommands."""
    root = click.Context(main, info_name="mgs")
    return "\n".join(_sections(_child(main, root, name), root, name, 1))


def _sections(command: click.Command, above: click.Context, name: str, level: int) -> Iterator[str]:
    context = click.Context(command, info_name=name, parent=above)
    yield f"{'#' * level} `{context.command_path}`"
    yield ""
    yield from _help_text(command)
    usage = " ".join([context.command_path, *command.collect_usage_pieces(context)])
    yield from ("", "```text", usage, "```", "")
    yield from _options(command, context)
    if isinstance(command, click.Group):
        for child in command.list_commands(context):
            yield from _sections(_child(command, context, child), context, child, level + 1)


def _child(group: click.Group, context: click.Context, name: str) -> click.Command:
    command = group.get_command(context, name)
    assert command is not None
    return command


def _help_text(command: click.Command) -> Iterator[str]:
    r"""Help of a command; what stands behind `\b` keeps its lines and becomes a block of code."""
    for paragraph in re.split(r"\n\s*\n", inspect.cleandoc(command.help or "")):
        if not paragraph.startswith("\b"):
            yield from (_safe(paragraph), "")
            continue
        lines = paragraph.splitlines()[1:]
        code = [line for line in lines if line.startswith(INDENT)]
        yield from (_safe(line) for line in lines if not line.startswith(INDENT))
        yield from ("", "```sh", *(line.removeprefix(INDENT) for line in code), "```", "")


def _options(command: click.Command, context: click.Context) -> Iterator[str]:
    rows = []
    for parameter in command.get_params(context):
        record = parameter.get_help_record(context) if isinstance(parameter, click.Option) else None
        if record:
            rows.append(f"| `{record[0]}` | {_safe(record[1])} |".replace("`|`", "`\\|`"))
    if rows:
        yield from ("| option | meaning |", "| --- | --- |", *rows, "")


def _safe(text: str) -> str:
    return re.sub(r"[<*]|(?<=\s)_|\[(?=[^]]*\]\()", lambda m: "\\" + m[0], text)
