"""Links of the texts in docs/, which lead on a code host to files and here to pages of the site.

On a code host a text may link to any file of the project. The site has pages for some files outside
docs/: modules of mgs, descriptions of robots and the texts at the top level.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import PurePosixPath

LINK = re.compile(r"(\]\()([^)\s]+)(\))")
# Texts outside docs/ that are pages of the site, by their path in the project.
TEXTS = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
# What a reader of the site looks up on another page than the source that defines it.
OTHERS = {
    "README.md": "index.md",
    "notebooks/first_walk.ipynb": "first_walk.md",
    "mgs/__init__.py": "reference/python.md",
    "mgs/cli/__init__.py": "reference/commands.md",
    "mgs/robot/spec.py": "reference/robot.md",
    "mgs/library/sweep.py": "reference/sweep.md",
}


def page_of(path: str) -> str | None:
    """Address in the site, relative to its top, of a file of the project.

    Args:
        path: path from the top of the project, with `/`.

    Returns:
        None if the site has no page for this file.
    """
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    if path in TEXTS or path in OTHERS:
        return (TEXTS | OTHERS)[path]
    parts = PurePosixPath(path).parts
    if parts[0] == "robots" and parts[-1] == "README.md":
        return f"robots/{parts[1]}.md"
    if parts[:2] == ("mgs", "gait"):
        return "reference/gait.md"
    if parts[0] == "mgs" and path.endswith(".py"):
        name = ".".join(parts).removesuffix(".py").removesuffix(".__init__")
        return f"reference/python/{parts[1]}.md#{name}"
    return None


def site_links(text: str, source: str, page: str) -> str:
    """Rewrite the links of a text so that they lead to pages of the site.

    Args:
        text: Markdown.
        source: path of the text from the top of the project, from which its links are relative.
        page: address of its page from the top of the site.
    """

    def replaced(match: re.Match[str]) -> str:
        target, _, anchor = match[2].partition("#")
        if not target or "://" in target or target.startswith("mailto:"):
            return match[0]
        path = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
        address = page_of(path)
        if address is None:
            return match[0]
        address = f"{address}#{anchor}" if anchor else address
        return match[1] + posixpath.relpath(address, posixpath.dirname(page) or ".") + match[3]

    return LINK.sub(replaced, text)
