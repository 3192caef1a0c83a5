"""What the pages of the documentation tell a reader to type works as printed."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.page_commands import ROOT, agrees, first_difference, follow, steps_of

DOCS = ROOT / "docs"


@pytest.mark.parametrize("name", ["index", "tutorials/servos", "tutorials/library", "terminal"])
@pytest.mark.slow_if("tutorials/servos", "tutorials/library")
def test_a_page_works_word_by_word(name: str, tmp_path: Path):
    folder = tmp_path / "empty"
    folder.mkdir()
    steps = follow(DOCS / f"{name}.md", folder)
    assert sum(step.compared for step in steps) >= 3


def test_what_a_page_prints_is_compared_word_by_word_and_numbers_up_to_their_last_digits():
    assert agrees("  motion    8.64 s, 865 samples", " motion 8.65 s, 866 samples")
    assert not agrees("motion 8.64 s", "motion 9.64 s")
    assert not agrees("ok joint_speed 5.0", "FAIL joint_speed 5.0")
    assert agrees("12 gaits, variations of ...", "12 gaits, variations of /home/a/walk.yaml")


def test_lines_that_are_left_out_are_marked():
    assert first_difference(["a", "...", "c"], ["a", "b", "c"]) is None
    assert first_difference(["a", "c"], ["a", "b", "c"]) == "c"
    assert first_difference(["a", "..."], ["a", "b", "c"]) is None
    assert first_difference(["a"], ["a", "b"]) == "(more lines: b)"


def test_a_page_is_read_as_files_and_commands_with_exit_codes(tmp_path: Path):
    page = tmp_path / "page.md"
    page.write_text(
        '```yaml title="a.yaml"\nmgs: 1\n```\n```console\n$ false\n$ echo $?\n1\n$ echo b\nb\n```\n'
        "```sh\n# first\nmgs info a.mcap  # look\n```\n"
    )
    file, false, echo, info = steps_of(page)
    assert (file.file, file.content) == ("a.yaml", "mgs: 1\n")
    assert (false.command, false.exit_code) == ("false", 1)
    assert (echo.printed, echo.exit_code, info.command) == (["b"], 0, "mgs info a.mcap")


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=[] if path.stem == "walk" else [pytest.mark.slow])
        for path in sorted((DOCS / "how-to").glob("*.md"))
    ],
)
def test_a_how_to_works_as_printed(path: Path, tmp_path: Path):
    folder = tmp_path / "empty"
    folder.mkdir()
    steps = follow(path, folder)
    assert any(step.file for step in steps) and any(step.compared for step in steps)
