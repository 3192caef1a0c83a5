"""Colours, shell completion, and the version of JSON output."""

from __future__ import annotations

import json
import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete

from mgs.cli import main
from mgs.core.plugins import IK_SOLVERS
from mgs.gait import list_gaits
from mgs.robot import list_robots
from tests.support.commands import run, run_process

SCRIPT = "from mgs.cli import main; main(prog_name='mgs')"


def words(*line: str) -> list[str]:
    """Words that the shell is offered for the last word of a line."""
    complete = ShellComplete(main, {}, "mgs", "_MGS_COMPLETE")
    return [item.value for item in complete.get_completions(list(line[:-1]), line[-1])]


def on_terminal(file: Path, **environment: str) -> bytes:
    """Output of mgs validate on a pseudo-terminal."""
    own, other = pty.openpty()
    command = [sys.executable, "-c", SCRIPT, "validate", str(file), "--physics", "none"]
    process = subprocess.Popen(
        command, stdout=other, stderr=other, env={**os.environ, "TERM": "xterm", **environment}
    )
    os.close(other)
    output = b""
    while True:
        try:
            part = os.read(own, 4096)
        except OSError:  # the program has closed the terminal
            break
        if not part:
            break
        output += part
    process.wait(timeout=60)
    os.close(own)
    return output


def test_a_verdict_is_coloured_on_a_terminal_only(walk_file: Path):
    assert b"\x1b[32mPASS" in on_terminal(walk_file, NO_COLOR="")
    assert b"\x1b[3" not in on_terminal(walk_file, NO_COLOR="1")
    assert b"\x1b[" not in run_process("validate", walk_file, "--physics", "none").stdout


def test_gaits_robots_and_solvers_are_completed():
    assert set(words("generate", "melson/walk")) >= {
        name for name in list_gaits() if name.startswith("melson/walk")
    }
    assert set(words("generate", "melson/kick", "--robot", "")) >= set(list_robots())
    assert words("generate", "melson/kick", "--ik", "prio") == [
        name for name in sorted(IK_SOLVERS.own) if name.startswith("prio")
    ]
    assert "report" in words("re")


def test_keys_of_the_named_gait_are_completed():
    found = words("generate", "melson/walk_5cm", "--set", "walk.step_l")
    assert found == ["walk.step_length="]
    assert words("generate", "no_such_gait", "--set", "walk.") == []


@pytest.mark.parametrize("command", [["robot", "list"], ["robot", "show", "melson"]])
def test_json_output_states_the_version_of_its_form(command: list[str]):
    assert json.loads(run(*command, "--json").stdout)["json_version"] == 1


def test_a_schema_is_no_output_of_this_kind():
    assert "json_version" not in json.loads(run("schema", "gait").stdout)
