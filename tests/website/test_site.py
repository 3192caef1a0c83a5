"""The documentation site: it builds without a warning, and its pages need no other host."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

from mgs.gait import gait_schema
from tests.support.browser import OpenPage, chromium
from tests.support.page_commands import ROOT

LOADED = re.compile(r'<(?:script|img|link|iframe|source|video)\b[^>]*?(?:src|href)="([^"]+)"')
MOST_SECONDS = 300


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built as a contributor does, but with every warning as an error."""
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)],
        cwd=ROOT, env={**os.environ, "NO_MKDOCS_2_WARNING": "1"}, capture_output=True, text=True,
        timeout=MOST_SECONDS, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return folder


def html(site: Path) -> dict[str, str]:
    return {
        path.relative_to(site).as_posix(): path.read_text(encoding="utf-8")
        for path in site.rglob("*.html")
    }


def test_every_text_is_a_page_and_nothing_in_it_is_loaded_from_another_host(site: Path):
    pages = html(site)
    texts = {path.relative_to(ROOT / "docs") for path in (ROOT / "docs").rglob("*.md")}
    assert {text.with_suffix(".html").as_posix() for text in texts} <= pages.keys()
    foreign = {name: [u for u in LOADED.findall(text) if "//" in u] for name, text in pages.items()}
    assert {name: urls for name, urls in foreign.items() if urls} == {}


def test_every_key_of_a_gait_file_is_on_the_page_of_gait_files(site: Path):
    page = (site / "reference" / "gait.html").read_text(encoding="utf-8")
    for name, model in gait_schema()["$defs"].items():
        assert f'id="{name.lower()}"' in page
        for key, field in model.get("properties", {}).items():
            assert f"<code>{key}</code>" in page
            words = re.split(r"[`<>&'\"]", field.get("description", ""))[0].split()
            assert " ".join(words[:6]) in " ".join(page.split()), f"{name}.{key}"


def test_every_command_has_a_page_with_its_options(site: Path):
    from mgs.cli import COMMANDS

    for name in COMMANDS:
        page = (site / "reference" / "commands" / f"{name}.html").read_text(encoding="utf-8")
        assert f"<code>mgs {name}</code>" in page and "--help" in page


def test_formulas_and_charts_are_drawn_without_scripts(site: Path):
    pages = html(site)
    assert pages["theory/com-generator.html"].count("<math xmlns") >= 10
    drawn = [name for name, text in pages.items() if "arithmatex" in text or "mermaid" in text]
    assert drawn == [], "left for a script that the site does not have"
    chart = pages["architecture.html"].partition('<svg class="flow-chart"')[2]
    rooms = re.findall(r'<text class="node"[^>]*>(\w+)</text>', chart.partition("</svg>")[0])
    assert {"gait", "motion_planner", "ik_solver", "cli"} <= set(rooms)


def test_the_search_knows_the_keys_of_files_and_the_words_of_texts(site: Path):
    index = json.loads((site / "search" / "search_index.json").read_text(encoding="utf-8"))
    for word, place in (("gamma_grav", "reference/gait.html"), ("cart-table", "theory/")):
        found = [entry["location"] for entry in index["docs"] if word in entry["text"]]
        assert any(location.startswith(place) for location in found)


@pytest.mark.filterwarnings("default")  # those of Playwright itself
def test_pages_open_from_disk_search_and_ask_no_other_host(site: Path):
    with chromium() as browser:
        for name in ("index", "theory/priorities", "reference/commands", "architecture"):
            page = OpenPage(browser, site / f"{name}.html", 1300, 900)
            page.tab.wait_for_timeout(300)
            assert page.complaints == []
            assert [url for url in page.requests if not url.startswith(("file:", "data:"))] == []
            page.tab.close()
        page = OpenPage(browser, site / "index.html", 1300, 900)
        page.tab.click(".md-search__input")
        page.tab.keyboard.type("gamma_grav", delay=20)
        page.wait("document.querySelectorAll('.md-search-result__item').length > 0")
        assert "Keys of gait files" in page.tab.inner_text(".md-search-result__list")


def test_moving_pictures_move_and_stay_small():
    pictures = sorted((ROOT / "docs" / "gallery").glob("*.gif"))
    assert len(pictures) >= 10
    for path in pictures:
        assert path.stat().st_size < 300_000, path.name
        with Image.open(path) as picture:
            shown = [frame.convert("RGB") for frame in ImageSequence.Iterator(picture)]
            assert len(shown) * picture.info["duration"] >= 4000  # [ms]
        middle = np.asarray(shown[len(shown) // 2], dtype=np.int16)
        assert (np.abs(middle - np.asarray(shown[0])).max(axis=2) > 30).mean() > 0.01, path.name
