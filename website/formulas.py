"""Formulas as MathML, which browsers draw without any script.

The extension pymdownx.arithmatex marks what stands between dollar signs; here the TeX in these
marks becomes MathML.
"""

from __future__ import annotations

import html
import re

from latex2mathml.converter import convert

MARK = re.compile(
    r'<(?P<tag>span|div) class="arithmatex">\\(?P<open>[(\[])(?P<tex>.*?)\\[)\]]</(?P=tag)>',
    re.DOTALL,
)


def with_formulas(page: str) -> str:
    """HTML of a page in which every formula is MathML."""

    def converted(match: re.Match[str]) -> str:
        display = "block" if match["open"] == "[" else "inline"
        formula = convert(html.unescape(match["tex"]).strip(), display=display)
        return f'<div class="formula">{formula}</div>' if display == "block" else formula

    return MARK.sub(converted, page)
