"""Commands in the guides, in sentences and in help texts are run as printed.

A reader of these places has files of his own; tests.support.guide_files makes such files.
"""

from __future__ import annotations

import inspect
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from mgs.cli import main
from tests.support.guide_files import PORTS, GuideFolder
from tests.support.page_commands import first_difference, shell_blocks
from tests.test_plain_english import COMMANDS
from tests.website.test_printed_commands import INLINE, PAGES, words_of

FOLLOWED = ("how-to", "tutorials")  # folders of pages that test_commands.py follows word by word
# 1: the motion does not hold, or nothing better was found
JUDGES = ("validate", "audit", "repair", "robot check", "batch run", "tune", "refine", "replay")
SHORTER = {  # what is run in place of hours of search and of other computers
    "--minutes 30 --workers 2": "--trials 1 --physics mujoco --draws 2 --final-draws 2 --workers 2",
    "--minutes 30": "--trials 1 --physics mujoco --draws 2 --final-draws 2",
    "--minutes 14": "--trials 1 --physics mujoco",
    "--minutes 22": "--trials 1 --final-draws 0",
    "--minutes 18": "--trials 1 --final-draws 0",
    "--objective energy --pin": "--trials 1 --draws 2 --final-draws 2 --objective energy --pin",
    "--objective energy --free": "--trials 1 --draws 2 --final-draws 2 --objective energy --free",
    "--objective speed --pin": "--trials 1 --draws 2 --final-draws 2 --objective speed --pin",
    "--robot my_robot": "--robot robots/mine",
    "~/ros/src": "./robots",
    "--monte-carlo 200": "--monte-carlo 8",
    "--servo-sweep": "--servo-sweep --physics mujoco",
    "bag_folder --hung": "bag_folder --topic /joint_states --hung",  # this bag has commands, too
    "--motors motors.yaml --resume": "--motors ./motors.yaml",  # nothing has been stopped here
}
ELSEWHERE = {  # run by other tests, with what they need
    "__A022.npz": "a file of others; tests/judge/recorded judges recorded motions",
    "--dask tcp://": "tests/library runs a batch on a cluster",
    "--ik newton": "tests/core/test_plugins.py runs these commands with the package of the guide",
    "com.generator=cart-table": "the same",
    "mgs experiment": "tests/experiments runs every experiment and compares its claims",
    "toddlerbot-zmp --where": "this library has one robot; tests/motion_file writes the format",
    "parquet": "tests/library reads the tables with pyarrow where it is installed",
}
QUICK = ("formats-robots", "formats")  # pages of make test


def in_blocks(text: str) -> Iterator[tuple[str, list[str] | None]]:
    """Commands of the blocks of a page; with what they print where a dollar sign is before them."""
    for block in shell_blocks(text):
        told: list[str] | None = None
        for line in block:
            if line.startswith("$ "):
                told = []
                yield line[2:], told
            elif told is not None:
                told.append(line)
            elif line.startswith("mgs "):
                yield line.partition("  #")[0].strip(), None


def in_sentences(text: str) -> Iterator[str]:
    """Commands in sentences and tables that are complete: with all arguments, without capitals."""
    for code in INLINE.findall(re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.M)):
        line = " ".join(code.split())
        if "..." not in line and not re.search(r"\b[A-Z]{3,}\b", line) and complete(line):
            yield line


def complete(line: str) -> bool:
    """True if a command has all arguments that it needs."""
    words = words_of(line)[1:]
    context, command = click.Context(main, info_name="mgs", **main.context_settings), main
    while isinstance(command, click.Group):
        if not words:
            return False
        name, found, words = command.resolve_command(context, words)
        assert found is not None
        context, command = click.Context(found, info_name=name, parent=context), found
    try:
        options, _, _ = command.make_parser(context).parse_args(list(words))
    except click.UsageError:
        return False
    given = {name for name, value in options.items() if isinstance(value, (str, tuple)) and value}
    return all(p.name in given for p in command.params if p.required)


def work_through(commands: list[tuple[str, list[str] | None]], folder: GuideFolder) -> None:
    """Run commands one after the other, and compare what the page says that they print."""
    for line, told in commands:
        if any(part in line for part in ELSEWHERE):
            continue
        command = line
        for long, short in SHORTER.items():
            if long in command and short not in command:
                command = command.replace(long, short)
        done = folder.run(command)
        if "exists; use --force" in done.stderr:  # the page shows alternatives
            done = folder.run(f"{command} --force")
        judges = line.split(maxsplit=1)[1].startswith(JUDGES)
        message = f"{command}\n{done.stdout}{done.stderr}"
        assert done.returncode in ((0, 1) if judges else (0,)), message
        if told is not None and command == line and not any(port in line for port in PORTS):
            missing = first_difference(told, done.stdout.splitlines())
            assert missing is None, f"{message}\nnot printed like this: {missing}"


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[GuideFolder]:
    made = GuideFolder(tmp_path / "reader")
    yield made
    made.close()


GUIDES = [
    page
    for page in PAGES
    if page.parent.name not in FOLLOWED and page.stem not in ("index", "terminal")
    if list(in_blocks(page.read_text())) or list(in_sentences(page.read_text()))
]


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, id=page.stem, marks=[] if page.stem in QUICK else [pytest.mark.slow])
        for page in GUIDES
    ],
)
def test_commands_of_a_guide_work(page: Path, folder: GuideFolder):
    text = page.read_text(encoding="utf-8")
    blocks = list(in_blocks(text))
    work_through(blocks, folder)
    typed = {line for line, _ in blocks}
    work_through([(line, None) for line in in_sentences(text) if line not in typed], folder)


EXAMPLES = {
    " ".join(path): lines
    for path, command in COMMANDS.items()
    if (lines := re.findall(r"^  (mgs [a-z].*)$", inspect.cleandoc(command.help or ""), re.M))
}


@pytest.mark.slow
@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_of_a_help_text_work(name: str, folder: GuideFolder):
    for line in EXAMPLES[name]:
        work_through([(line, None)], folder)


def test_commands_and_their_output_are_found():
    text = "    $ mgs info a.mcap\n    b\n\n```\nmgs plot a.mcap  # draw\n```\n"
    text += "`mgs gait list`, `mgs plot FILE`, `mgs plot`, `mgs info walk.mcap`\n"
    assert list(in_blocks(text)) == [("mgs info a.mcap", ["b"]), ("mgs plot a.mcap", None)]
    assert list(in_sentences(text)) == ["mgs gait list", "mgs info walk.mcap"]
    assert len(GUIDES) >= 15 and sum(map(len, EXAMPLES.values())) >= 80
    assert all(any(p in shlex.join([line]) for line in ALL) for p in (*SHORTER, *ELSEWHERE))


ALL = [line for lines in EXAMPLES.values() for line in lines] + [
    line for page in PAGES for line, _ in in_blocks(page.read_text())
]
