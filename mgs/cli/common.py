"""Shared parts of the commands: common options, JSON output, progress bars."""

from __future__ import annotations

import json
import math
import re
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from mgs.core.short_text import printable

JSON_VERSION = 1  # of what --json prints; a key that is removed or changes its meaning raises it
MOST_DIGITS = 4000  # of an integer in JSON output
COLOUR = re.compile("(\x1b\\[[0-9;]*m)")
SHOW_AFTER = 1.0  # [s] of work before a progress bar appears

json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print the result as one JSON object on stdout."
)
force_option = click.option("--force", is_flag=True, help="Replace existing files.")
motion_argument = click.argument(
    "file", metavar="FILE.mcap", type=click.Path(exists=True, dir_okay=False, path_type=Path)
)


class FiniteFloat(click.types.FloatParamType):
    """Any finite number; the type of click accepts NaN and infinity."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Convert a text to a number; report a usage error if it is not finite."""
        number: float = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value!r} is not a finite number.", param, ctx)
        return number


class FiniteRange(click.FloatRange):
    """Range of finite numbers; the range type of click accepts NaN."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Convert a text to a number; report a usage error if it is outside the range."""
        number: float = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value!r} is not a finite number.", param, ctx)
        return number


def say(text: object, *, nl: bool = True, err: bool = False) -> None:
    """Print a text, and the end of the line if `nl` is set, its control characters escaped.

    Names and messages may come from files of others, whose escape sequences must not reach the
    terminal; those that only choose a colour may.
    """
    parts = (
        part if COLOUR.fullmatch(part) else printable(part) for part in COLOUR.split(str(text))
    )
    click.echo("".join(parts), nl=nl, err=err)


def print_json(content: object, versioned: bool = True) -> None:
    """Print one JSON object on stdout, the version of its form first; see `json_text`."""
    if versioned and isinstance(content, dict):
        content = {"json_version": JSON_VERSION, **content}
    click.echo(json_text(content))


def json_text(content: object) -> str:
    """JSON of a content; numbers that are not finite, which JSON lacks, are null."""
    return json.dumps(_as_json(content), indent=2, default=str, allow_nan=False)


def _as_json(content: Any) -> Any:
    """Content with null for numbers that are not finite, and without halves of characters."""
    if isinstance(content, dict):
        return {_as_json(str(key)): _as_json(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_as_json(entry) for entry in content]
    if isinstance(content, float):
        return content if math.isfinite(content) else None
    if isinstance(content, str):
        return content.encode("utf-8", "backslashreplace").decode()
    if isinstance(content, int) and abs(content) >= 10**MOST_DIGITS:
        return None  # Python writes no longer numbers
    return content


class ProgressBar:
    """Callable with (done, total) that draws a progress bar on stderr.

    The bar appears only if stderr is a terminal and the work takes longer than SHOW_AFTER.
    `detail` returns a text that is shown behind the bar.
    """

    def __init__(self, label: str, detail: Callable[[], str] | None = None) -> None:
        self._detail = detail
        self._label, self._started, self._done = label, time.monotonic(), 0
        self._bar: Any = None
        self._on_terminal = sys.stderr.isatty()

    def __call__(self, done: int, total: int) -> None:
        """Report the progress of the work."""
        if not self._on_terminal or time.monotonic() - self._started < SHOW_AFTER:
            return
        if self._bar is None:
            detail = self._detail
            self._bar = click.progressbar(
                length=total,
                label=self._label,
                file=sys.stderr,
                show_pos=detail is not None,
                item_show_func=None if detail is None else lambda _: detail(),
            )
            self._bar.render_progress()
        self._bar.update(done - self._done)
        self._done = done

    def close(self) -> None:
        """End the line of the bar."""
        if self._bar is not None:
            self._bar.render_finish()


def with_progress(label: str, work: Callable[[ProgressBar], Any]) -> Any:
    """Call `work` with a progress bar and return its result."""
    bar = ProgressBar(label)
    try:
        return work(bar)
    finally:
        bar.close()


@contextmanager
def progress_bars() -> Iterator[Callable[[str, int, int], None]]:
    """One bar after another: what this gives is called with the bar's label, done and total."""
    shown: dict[str, ProgressBar] = {}  # at most one

    def tell(label: str, done: int, total: int) -> None:
        if label not in shown:
            close()
            shown[label] = ProgressBar(label)
        shown[label](done, total)

    def close() -> None:
        while shown:
            shown.popitem()[1].close()

    try:
        yield tell
    finally:
        close()
