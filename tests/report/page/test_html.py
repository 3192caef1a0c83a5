"""A page is one file that holds hostile texts safely and asks for nothing else."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.errors import ConfigError, OutputExistsError
from mgs.motion import Motion
from mgs.report.page import PageOptions, write_page
from mgs.report.page.html import MOTION_SCRIPTS, asset, json_text, page_html
from mgs.report.page.write import collision_step
from tests.report.page.conftest import HOSTILE


class Elements(HTMLParser):
    """Start tags with their attributes, the texts of scripts, and the title."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: dict[str, list[str]] = {}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        if self.tags and data.strip():
            self.texts.setdefault(self.tags[-1][0], []).append(data)


@given(st.text())
def test_any_text_comes_back_from_the_page(text: str):
    page = Elements(page_html(text, {"name": text, text: [text]}, scripts=("clock.js",)))
    assert [tag for tag, _ in page.tags if tag in ("img", "script", "style")] == [
        "style", "script", "script",
    ]  # fmt: skip
    data = json.loads("".join(page.texts["script"]).partition("// The one clock")[0])
    assert data == {"name": text, text: [text]}


@given(st.recursive(st.text() | st.booleans() | st.none(), st.lists))
def test_json_has_no_character_that_ends_its_element(data: object):
    text = json_text(data)
    assert json.loads(text) == data
    assert not re.search(r"[<>&\u2028\u2029]", text)


def test_numbers_that_are_not_finite_are_refused():
    with pytest.raises(ValueError, match="not JSON compliant"):
        page_html("", {"value": float("nan")})


def test_only_our_scripts_may_run(walk: Motion, broken: Motion, tmp_path: Path):
    path = tmp_path / "page.html"
    write_page([walk, broken], path)
    text = path.read_text(encoding="utf-8")
    page = Elements(text)
    policy = next(a["content"] for t, a in page.tags if a.get("http-equiv"))
    assert policy is not None and policy.startswith("default-src 'none'")
    assert "unsafe" not in policy and "http" not in policy
    scripts = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    assert len(scripts) == len(MOTION_SCRIPTS)
    for script in scripts:
        digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in policy
    assert not [a for _, a in page.tags if {"src", "href", "onerror"} & set(a)]
    assert text.count(HOSTILE) == 0


def test_a_page_overwrites_nothing_unasked(walk: Motion, tmp_path: Path):
    path = tmp_path / "page.html"
    path.write_text("mine")
    with pytest.raises(OutputExistsError):
        write_page([walk], path)
    assert path.read_text() == "mine"


@pytest.mark.parametrize("n", [0, 7])
def test_too_few_or_too_many_motions_are_refused(walk: Motion, tmp_path: Path, n: int):
    with pytest.raises(ConfigError, match="1 to 6"):
        write_page([walk] * n, tmp_path / "page.html")


def test_a_folder_of_meshes_that_is_missing_is_refused(walk: Motion, tmp_path: Path):
    with pytest.raises(ConfigError, match="not a folder"):
        write_page([walk], tmp_path / "page.html", PageOptions(meshes=tmp_path / "none"))


def test_the_same_motion_gives_the_same_page(walk: Motion, tmp_path: Path):
    for name in ("a.html", "b.html"):
        write_page([walk], tmp_path / name)
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()


def test_the_licence_of_the_viewer_is_in_the_page():
    licence = asset("LICENSE.three")
    assert "three.js authors" in licence
    assert licence in page_html("", {})


@pytest.mark.parametrize(("n", "step"), [(1200, 1), (10_000, 1), (10_001, 2), (160_401, 17)])
def test_collisions_of_a_long_motion_are_looked_for_at_every_kth_sample(n: int, step: int):
    assert collision_step(n) == step
