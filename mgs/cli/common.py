"""Shared parts of the commands: common options, JSON output, progress bars."""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

JSON_VERSION = 1  # of what --json prints; a key that is removed or changes its meaning raises it
SHOW_AFTER = 1.0  # [s] of work before a progress bar appears

json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print the result as one JSON object on stdout."
)
force_option = click.option("--force", is_flag=True, help="Replace existing files.")
motion_argument = click.argument(
    "file", metavar="FILE.mcap", type=click.Path(exists=True, dir_okay=False, path_type=Path)
)


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


def print_json(content: object, versioned: bool = True) -> None:
    """Print one JSON object on stdout, the version of its form first."""
    if versioned and isinstance(content, dict):
        content = {"json_version": JSON_VERSION, **content}
    click.echo(json.dumps(content, indent=2, default=str, allow_nan=False))


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
