"""What MkDocs asks while it builds the site: pages made from the code, links, charts, formulas.

`mkdocs build --strict` writes the site to the folder `site`, and `mkdocs serve` shows it in a
browser, and again after each change.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))  # the sources next to this file, whatever else is installed

from command_pages import command_names, command_page, overview_page  # noqa: E402
from flow_chart import with_charts  # noqa: E402
from formulas import with_formulas  # noqa: E402
from links import TEXTS, page_of, site_links  # noqa: E402
from module_pages import front_door_page, room_page, rooms  # noqa: E402
from schema_pages import INTRODUCTIONS, schema_page  # noqa: E402


def generated_pages() -> dict[str, str]:
    """Markdown of every page that is not a file in docs/, by its address in the site."""
    pages = {f"reference/{kind}.md": schema_page(kind) for kind in INTRODUCTIONS}
    pages["reference/commands.md"] = overview_page()
    pages |= {f"reference/commands/{name}.md": command_page(name) for name in command_names()}
    pages["reference/python.md"] = front_door_page()
    pages |= {f"reference/python/{room}.md": room_page(room) for room in rooms()}
    robots = [f"robots/{path.parent.name}/README.md" for path in ROOT.glob("robots/*/README.md")]
    for source in [*TEXTS, *sorted(robots)]:
        page = page_of(source)
        assert page is not None
        text = (ROOT / source).read_text(encoding="utf-8")
        pages[page] = site_links(text, source, page)
    notebook = "notebooks/first_walk.ipynb"
    pages["first_walk.md"] = site_links(notebook_page(ROOT / notebook), notebook, "first_walk.md")
    return pages


def notebook_page(path: Path) -> str:
    """Markdown page of the texts and the code of a notebook."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    texts = [("".join(cell["source"]), cell["cell_type"] == "code") for cell in cells]
    return "\n\n".join(f"```python\n{text}\n```" if code else text for text, code in texts)


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Put the texts in docs/ that the navigation does not name at the end of the guides."""
    assert config.nav is not None
    named = str(config.nav)
    (guides,) = (part["Guides"] for part in config.nav if "Guides" in part)
    for path in sorted(Path(config.docs_dir).glob("*.md")):
        if f"'{path.name}'" not in named:
            guides.append(path.name)
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made from the code."""
    for address, text in generated_pages().items():
        files.append(File.generated(config, address, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Lead links to pages of the site, and draw the charts."""
    address = page.file.src_uri
    if page.file.generated_by is None:
        markdown = site_links(markdown, f"docs/{address}", address)
    return with_charts(markdown)


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Draw the formulas."""
    return with_formulas(html)
