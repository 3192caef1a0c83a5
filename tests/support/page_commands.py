"""Commands that a page of the documentation prints, run as a reader would type them."""

from __future__ import annotations

import itertools
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import mgs

ROOT = Path(mgs.__file__).parent.parent
FENCE = re.compile(r"^```(\w+)([^\n]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
TITLE = re.compile(r'title="([^"]+)"')
ATTACHED = re.compile(r"\]\(([\w-]+\.(?:urdf|yaml|csv))\)")
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
COMPUTING_TIME = re.compile(r"^ *time .* ms$|computing time [\d.]+ s")
LEFT_OUT = "..."
SHELLS = (None, "", "console", "sh", "bash")  # None: an indented block
RELATIVE = 0.05  # by which a printed figure may differ: other machines, other versions of libraries
TIMEOUT = 300  # [s]


@dataclass
class Step:
    """A file that the reader saves, or a command with what the page says that it prints."""

    command: str = ""
    printed: list[str] = field(default_factory=list)
    compared: bool = False
    exit_code: int = 0
    file: str = ""
    content: str = ""


def steps_of(page: Path) -> list[Step]:
    """Steps of a page: its blocks `console` and `sh`, and blocks with a title, which are files.

    In a block `console` commands follow a dollar sign, and what they print follows them. The
    command `echo $?` states the exit code of the command before it; without one, 0 is expected.
    """
    steps: list[Step] = []
    for language, info, body in FENCE.findall(page.read_text(encoding="utf-8")):
        if title := TITLE.search(info):
            steps.append(Step(file=title[1], content=body))
        elif language == "console":
            steps += _console(body)
        elif language == "sh":
            lines = [line.partition("  #")[0].strip() for line in body.splitlines()]
            steps += [Step(line) for line in lines if line and not line.startswith("#")]
    return steps


def _console(body: str) -> list[Step]:
    steps: list[Step] = []
    for line in body.splitlines():
        if line.startswith("$ "):
            steps.append(Step(line[2:], compared=True))
        else:
            assert steps, f"output before any command: {line}"
            steps[-1].printed.append(line)
    for before, step in itertools.pairwise(steps):
        if step.command == "echo $?":
            before.exit_code = int(step.printed[0])
    return [step for step in steps if step.command != "echo $?"]


def shell_blocks(text: str) -> Iterator[list[str]]:
    """Lines of the blocks of a page that may hold shell commands, with continued lines joined.

    These are fenced blocks without a language or with that of a shell, and indented blocks.
    """
    fence: str | None = None
    block: list[str] = []
    for line in [*text.splitlines(), ""]:
        opens = line.startswith("```")
        if fence is None and not opens and line.startswith("    ") and line.strip():
            block.append(line[4:])
        elif fence is not None and not opens:
            block.append(line)
        else:
            if block and fence in SHELLS:
                yield "\n".join(block).replace("\\\n", " ").splitlines()
            block = []
            if opens:
                fence = None if fence is not None else line[3:].partition(" ")[0]


def follow(page: Path, folder: Path) -> list[Step]:
    """Do what a page says, in a folder that has the files to which it links; returns the steps."""
    for name in ATTACHED.findall(page.read_text(encoding="utf-8")):
        shutil.copy(page.parent / name, folder / name)
    steps = steps_of(page)
    for step in steps:
        if step.file:
            (folder / step.file).write_text(step.content, encoding="utf-8")
            continue
        done = subprocess.run(
            ["bash", "-c", step.command],
            cwd=folder, env=environment(folder.parent), capture_output=True, text=True,
            timeout=TIMEOUT, check=False,
        )  # fmt: skip
        told = f"{page.name}: {step.command}\n{done.stdout}{done.stderr}"
        assert done.returncode == step.exit_code, told
        if step.compared:
            printed = done.stdout + (done.stderr if step.exit_code else "")
            missing = first_difference(step.printed, printed.splitlines())
            assert missing is None, f"{told}\nnot printed like this: {missing}"
    return steps


def environment(folder: Path) -> dict[str, str]:
    """The environment with the programs `mgs` and `python` of this interpreter on the path."""
    programs = folder / "programs"
    programs.mkdir(exist_ok=True)
    for name, arguments in (("mgs", "-m mgs "), ("python", "")):
        program = programs / name
        program.write_text(f'#!/bin/sh\nexec "{sys.executable}" {arguments}"$@"\n')
        program.chmod(0o755)
    inherited = {**os.environ, "PYTHONPATH": str(ROOT), "NO_COLOR": "1"}
    return {**inherited, "PATH": f"{programs}:{os.environ['PATH']}"}


def first_difference(expected: list[str], printed: list[str]) -> str | None:
    """First line of a page that was not printed; None if there is none.

    A line `...` stands for any number of lines, and at the end of a line for the rest of it.
    """
    at, gap = 0, False
    for line in expected:
        if line == LEFT_OUT:
            gap = True
            continue
        places = range(at, len(printed)) if gap else range(at, min(at + 1, len(printed)))
        found = next((place for place in places if agrees(line, printed[place])), None)
        if found is None:
            return line
        at, gap = found + 1, False
    return None if gap or at == len(printed) or not expected else f"(more lines: {printed[at]})"


def agrees(expected: str, printed: str) -> bool:
    """True if two lines have the same words and their numbers agree up to the last digits."""
    if expected.endswith(LEFT_OUT):
        expected = expected[: -len(LEFT_OUT)]
        words = len(expected.split())
        printed = " ".join(printed.split()[:words])
    expected, printed = (COMPUTING_TIME.sub("time", text) for text in (expected, printed))
    parts = [" ".join(NUMBER.sub("0", text).split()) for text in (expected, printed)]
    if parts[0] != parts[1]:
        return False
    pairs = zip(NUMBER.findall(expected), NUMBER.findall(printed), strict=True)
    return all(_close(first, second) for first, second in pairs)


def _close(expected: str, printed: str) -> bool:
    first, second = float(expected), float(printed)
    digits = len(expected.partition(".")[2]) if "e" not in expected else 12
    last = 10.0**-digits if "." in expected else 0.0
    return abs(first - second) <= RELATIVE * abs(first) + last
