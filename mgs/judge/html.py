"""A verdict as the table that a notebook shows."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from mgs.judge.motion_checks import Check

HEAD = ("", "check", "value", "limit", "unit", "time [s]", "where")
MARKS = {True: "\N{CHECK MARK}", False: "\N{BALLOT X}"}


def verdict_table(title: str, checks: Iterable[Check]) -> str:
    """HTML table with one row for each check, those that fail in bold type."""
    rows = "".join(_row(check) for check in checks)
    head = "".join(f"<th>{escape(word)}</th>" for word in HEAD)
    return f"<table><caption>{escape(title)}</caption><tr>{head}</tr>{rows}</table>"


def _row(check: Check) -> str:
    time = "" if check.time is None else f"{check.time:.2f}"
    figures = (f"{check.value:.4g}", f"{check.limit:.4g}", check.unit, time, check.where)
    cells = "".join(f"<td>{escape(text)}</td>" for text in (MARKS[check.ok], check.name, *figures))
    return f"<tr>{cells}</tr>" if check.ok else f'<tr style="font-weight: bold">{cells}</tr>'
