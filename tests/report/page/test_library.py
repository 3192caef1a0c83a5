"""Page of a library: what it lists, and its table, scatter and links in a browser."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mgs.library.manifest import MANIFEST, Manifest, writing
from mgs.library.query import query
from mgs.library.summary import Summary
from mgs.report.page.library import write_library_page
from tests.report.page.test_html import Elements
from tests.support.browser import OpenPage, chromium
from tests.support.commands import run

Made = tuple[Path, Summary]


@pytest.fixture(scope="module")
def page(made: Made, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "my speeds.html"
    write_library_page(made[0], path, n_pages=2)
    return path


def test_the_page_lists_every_gait_with_its_figures(made: Made, page: Path):
    text = Elements(page.read_text(encoding="utf-8")).texts["script"][0]
    data = json.loads(text)
    number, energy = data["columns"].index("number"), data["columns"].index("positive_work")
    table = query(made[0], columns=["number", "positive_work", "file"])
    assert {row[number]: row[energy] for row in data["rows"]} == {r[0]: r[1] for r in table.rows}


def test_the_fastest_passing_gaits_have_pages(made: Made, page: Path):
    best = query(made[0], "verdict == 'pass'", ["number"], "speed", reverse=True, limit=2)
    expected = {f"{number}.html" for (number,) in best.rows}
    assert {path.name for path in page.with_name("my speeds_pages").iterdir()} == expected


def test_report_writes_the_page_on_request(made: Made, tmp_path: Path):
    result = run("library", "report", made[0], "-o", tmp_path / "lib.html")
    assert result.exit_code == 0 and "open it in a web browser" in result.stdout
    assert (tmp_path / "lib.html").is_file()
    assert run("library", "report", made[0], "-o", tmp_path / "lib.html").exit_code == 1
    assert run("library", "report", made[0], "--pages", 1).exit_code == 2


def test_a_library_of_an_earlier_version_gets_the_new_column(tmp_path: Path):
    identity = {"number of gaits": "1"}
    with writing(tmp_path, identity, ()) as manifest:
        manifest.keep({"number": 0, "verdict": "pass"})
    with sqlite3.connect(tmp_path / MANIFEST) as connection:
        connection.execute("ALTER TABLE gaits DROP COLUMN positive_work")
    connection.close()
    with writing(tmp_path, identity, ()) as manifest:
        assert "positive_work" in Manifest(manifest.connection).columns
        manifest.keep({"number": 0, "verdict": "pass", "positive_work": 1.5})
    assert query(tmp_path, columns=["positive_work"]).rows == [(1.5,)]


@pytest.fixture(scope="module")
def opened(page: Path) -> Iterator[OpenPage]:
    with chromium() as browser:
        tab = OpenPage(browser, page, 1200, 900)
        tab.wait("window.mgsLibrary")
        yield tab
        tab.close()


def cells(opened: OpenPage, column: str) -> list[Any]:
    """Column of the table as it is shown."""
    at = opened.ask(f"mgsLibrary.index({column!r})")
    script = "[...document.querySelectorAll('tbody tr')].map((row) => row.children[%d].textContent)"
    return list(opened.ask(script % at))


@pytest.mark.filterwarnings("default")
def test_the_table_sorts_and_filters(opened: OpenPage, made: Made):
    n = len(query(made[0]).rows)
    header = opened.tab.get_by_role("button", name="zmp_margin [m]")
    for order in (1, -1):
        header.click()
        shown = [float(text) for text in cells(opened, "zmp_margin") if text[-1:].isdigit()]
        assert shown == sorted(shown, reverse=order < 0) and len(shown) > 4
    assert len(cells(opened, "number")) == n
    opened.tab.get_by_label("Verdict").select_option("infeasible")
    assert set(cells(opened, "verdict")) == {"infeasible"}
    opened.tab.get_by_label("Verdict").select_option("all verdicts")
    opened.tab.get_by_label("Filter by text").fill("IkError")
    assert set(cells(opened, "reason")) == {"IkError"}
    opened.tab.get_by_label("Filter by text").fill("")


@pytest.mark.filterwarnings("default")
def test_a_point_of_the_scatter_names_its_gait_and_links_to_its_page(opened: OpenPage, page: Path):
    opened.ask("scrollTo(0, 0)")
    opened.wait("mgsLibrary.scatter.drawn")
    # Several gaits have pages and the table may be sorted: link and place have to be of one point.
    link, x, y = opened.ask(
        "(() => { const s = mgsLibrary.scatter;"
        "const p = s.drawn.find(({ row }) => row.at(-1));"
        "return [p.row.at(-1), s.xOf(p.x), s.yOf(p.y)]; })()"
    )
    opened.tab.locator(".plot canvas").click(position={"x": x, "y": y})
    anchor = opened.tab.locator("p a")
    assert anchor.get_attribute("href") == link
    anchor.click()
    opened.wait("window.mgsFirstFrame")
    assert opened.complaints == []
    assert {url.partition("my%20speeds")[1] for url in opened.requests} == {"my%20speeds"}
    assert np.isfinite(opened.ask("mgsPage.clock.duration"))
