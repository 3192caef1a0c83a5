"""What the commands share: JSON on stdout, progress on a terminal, common options."""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

SHOW_AFTER = 1.0  # [s] of work before a progress bar appears

json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object to stdout and nothing else."
)
force_option = click.option("--force", is_flag=True, help="Replace existing files.")
motion_argument = click.argument(
    "file", metavar="FILE.mcap", type=click.Path(exists=True, dir_okay=False, path_type=Path)
)


class FiniteRange(click.FloatRange):
    """A range that NaN is outside of; click itself lets it through."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Number of a text; ends the command as a usage error unless it lies in the range."""
        number: float = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value!r} is not a finite number.", param, ctx)
        return number


def print_json(content: object) -> None:
    """One JSON object on stdout."""
    click.echo(json.dumps(content, indent=2, default=str, allow_nan=False))


class ProgressBar:
    """Callable with (done, total); draws on stderr when it is a terminal and the work is long.

    `detail` gives a text to show behind the bar.
    """

    def __init__(self, label: str, detail: Callable[[], str] | None = None) -> None:
        self._detail = detail
        self._label, self._started, self._done = label, time.monotonic(), 0
        self._bar: Any = None
        self._on_terminal = sys.stderr.isatty()

    def __call__(self, done: int, total: int) -> None:
        """Report progress."""
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
        """Leave the line."""
        if self._bar is not None:
            self._bar.render_finish()


def with_progress(label: str, work: Callable[[ProgressBar], Any]) -> Any:
    """Result of `work`, which is given a progress bar."""
    bar = ProgressBar(label)
    try:
        return work(bar)
    finally:
        bar.close()
