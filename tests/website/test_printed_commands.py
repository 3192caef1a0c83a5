"""Every command of mgs that a page or a help text prints is one that mgs understands."""

from __future__ import annotations

import inspect
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from mgs.cli import main
from tests.support.page_commands import ROOT, shell_blocks
from tests.test_plain_english import COMMANDS

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
INLINE = re.compile(r"`(mgs [a-z][^`]*)`", re.DOTALL)
COMMAND = re.compile(r"^(?:\$ )?(mgs [a-z].*)$", re.MULTILINE)


def printed(text: str) -> Iterator[str]:
    """Commands in blocks and in inline code, each on one line, without what a shell adds."""
    for block in shell_blocks(text):
        yield from COMMAND.findall("\n".join(block))
    for code in INLINE.findall(re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.M)):
        yield " ".join(code.split())


def words_of(line: str) -> list[str]:
    """Words of a command without pipes, redirections and comments."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars="|>;&")
    lexer.whitespace_split = True
    words = list(lexer)
    end = next((k for k, word in enumerate(words) if word[:1] in tuple("|>;&")), len(words))
    return [word for word in words[:end] if word != "..."]


def problem(line: str) -> str | None:
    """What mgs would say of the words of a command; None if it understands them."""
    words = words_of(line)[1:]
    context, command = click.Context(main, info_name="mgs", **main.context_settings), main
    try:
        while isinstance(command, click.Group) and words:
            name, found, words = command.resolve_command(context, words)
            assert found is not None
            context, command = click.Context(found, info_name=name, parent=context), found
        options, _, _ = command.make_parser(context).parse_args(list(words))
        for option in command.params:
            if isinstance(option.type, click.Choice) and not option.multiple:
                value = options.get(option.name)
                if isinstance(value, str) and value.islower():  # capitals stand for any value
                    option.type.convert(value, option, context)
    except click.UsageError as error:
        if isinstance(error, click.BadOptionUsage) and line.endswith(error.option_name):
            return None  # a sentence about an option leaves its value out
        return str(error.format_message())
    return None


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_every_command_on_a_page_is_understood(page: Path):
    lines = list(printed(page.read_text(encoding="utf-8")))
    assert {line: told for line in lines if (told := problem(line))} == {}


@pytest.mark.parametrize("path", COMMANDS, ids=lambda path: " ".join(("mgs", *path)))
def test_every_command_in_a_help_text_is_understood(path: tuple[str, ...]):
    text = inspect.cleandoc(COMMANDS[path].help or "")
    lines = re.findall(r"^  (mgs [a-z].*)$", text, re.MULTILINE)
    assert {line: told for line in lines if (told := problem(line))} == {}


def test_commands_are_found_and_wrong_ones_are_noticed():
    text = "`mgs info a.mcap`\n\n    mgs plot a.mcap  # draw\n\n"
    text += "```\n$ mgs tune g | cat\nmgs x\n```\n"
    assert [words_of(line)[1:] for line in printed(text)] == [
        ["plot", "a.mcap"], ["tune", "g"], ["x"], ["info", "a.mcap"],
    ]  # fmt: skip
    assert sum(len(list(printed(page.read_text(encoding="utf-8")))) for page in PAGES) > 150
    assert problem("mgs info a.mcap --json") is None
    assert "no such" in (problem("mgs info a.mcap --colour") or "").lower()
    assert "no such" in (problem("mgs inform a.mcap") or "").lower()
    assert problem("mgs schema gate") is not None
