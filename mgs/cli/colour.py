"""Colours of verdicts on a terminal; none in a pipe or file, and none if NO_COLOR is set.

click leaves out colours wherever its output is no terminal. NO_COLOR: no-color.org.
"""

from __future__ import annotations

import os

import click


def good(text: str) -> str:
    """Text in green."""
    return _styled(text, "green")


def bad(text: str) -> str:
    """Text in bold red."""
    return _styled(text, "red", bold=True)


def _styled(text: str, colour: str, bold: bool = False) -> str:
    return text if os.environ.get("NO_COLOR") else click.style(text, fg=colour, bold=bold or None)
