"""Tests with hundreds of malformed gait files: exit code 2, a message, no traceback, no file."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.commands import files_below, run
from tests.support.malformed import KINDS, VALID_BYTES

MOST_LINES, LONGEST_LINE = 25, 480  # a line may name all keys of the block walk
PER_KIND = 30
seen: dict[str, set[bytes]] = {}


def test_the_unchanged_file_is_valid(tmp_path: Path):
    (tmp_path / "gait.yaml").write_bytes(VALID_BYTES)
    assert run("generate", tmp_path / "gait.yaml", "-o", tmp_path / "a.mcap").exit_code == 0


@pytest.mark.parametrize("kind", KINDS)
def test_a_malformed_gait_file_is_refused(kind: str, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    gait = tmp_path / "gait.yaml"

    @settings(max_examples=PER_KIND)
    @given(st.data())
    def refused(data: st.DataObject) -> None:
        content = data.draw(KINDS[kind])
        seen.setdefault(kind, set()).add(content)
        gait.write_bytes(content)
        where = data.draw(st.sampled_from([(), ("-o", "new/walk.mcap"), ("--json",)]))
        result = run("generate", "gait.yaml", *where)
        assert result.exit_code == 2
        assert result.stdout == ""
        assert result.stderr.startswith("Error: gait.yaml: ")
        lines = result.stderr.splitlines()
        assert len(lines) <= MOST_LINES
        assert max(map(len, lines)) <= LONGEST_LINE
        assert all(line.isprintable() for line in lines)  # a terminal obeys other characters
        assert "Traceback" not in result.stderr
        assert files_below(tmp_path) == {"gait.yaml": content}
        assert list(tmp_path.iterdir()) == [gait]  # no folder either

    refused()


def test_at_least_two_hundred_different_files_were_tried():
    if seen.keys() != KINDS.keys():
        pytest.skip("only a part of the tests above was run")
    assert sum(map(len, seen.values())) >= 200
    assert len(set().union(*seen.values())) >= 200
