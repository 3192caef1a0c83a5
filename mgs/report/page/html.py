"""A page as one HTML text: template, style and scripts of the folder `assets`, and the data.

What comes from motion files enters the page as JSON in an element that is no program, with <, > and
& written as escapes, and as escaped text in the title. The page's content security policy lets only
the scripts of mgs run, by their hashes, and nothing be loaded from anywhere.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from functools import cache
from html import escape
from importlib.resources import files
from typing import Any

MOTION_SCRIPTS = (
    "three.min.js",
    "data.js",
    "theme.js",
    "clock.js",
    "robot.js",
    "pieces.js",
    "view.js",
    "plots.js",
    "above.js",
    "panels.js",
    "main.js",
)
LIBRARY_SCRIPTS = ("data.js", "theme.js", "plots.js", "scatter.js", "library.js")
PLACE = re.compile(r"\{\{(\w+)\}\}")


def page_html(title: str, data: dict[str, Any], scripts: tuple[str, ...] = MOTION_SCRIPTS) -> str:
    """HTML text of a page.

    Args:
        title: title of the page, any text.
        data: plain data without numbers that are not finite.
        scripts: names of script files, in the order in which they run.

    Raises:
        ValueError: the data contain a number that is not finite.
    """
    style = asset("style.css")
    texts = [_script(name) for name in scripts]
    policy = (
        "default-src 'none'; base-uri 'none'; form-action 'none'; img-src data: blob:; "
        f"script-src {' '.join(map(_hash, texts))}; style-src {_hash(style)}"
    )
    parts = {
        "TITLE": escape(title),
        "POLICY": policy,
        "STYLE": f"<style>{style}</style>",
        "DATA": f'<script type="application/json" id="data">{json_text(data)}</script>',
        "SCRIPTS": "\n".join(f"<script>{text}</script>" for text in texts),
    }
    return PLACE.sub(lambda match: parts[match[1]], asset("page.html"))


def json_text(data: Any) -> str:
    """JSON that neither ends the element that contains it nor opens another one."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))  # ASCII alone
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


@cache
def asset(name: str) -> str:
    """Text of a file of the folder `assets`."""
    return files("mgs.report.page").joinpath("assets", name).read_text(encoding="utf-8")


def _script(name: str) -> str:
    if name != "three.min.js":
        return asset(name)
    return f"/*\nthree.js\n{asset('LICENSE.three')}*/\n{asset(name)}"


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
