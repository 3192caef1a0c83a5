"""The option --layout of commands that write formats of other programs, and lists of these."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

import click

from mgs.cli.common import say


class Described(Protocol):
    """Format or table with a line and a page about it."""

    @property
    def summary(self) -> str:
        """One line about it."""

    @property
    def layout(self) -> str:
        """Description of its files."""


def listing(title: str, known: Mapping[str, Described]) -> str:
    """Names and summaries for the end of a help page."""
    width = max(len(name) for name in known) + 2
    lines = "\n".join(f"  {name:<{width}}{found.summary}" for name, found in known.items())
    return f"\b\n{title}:\n{lines}"


def layout_option(known: Mapping[str, Described]) -> Callable[[Any], Any]:
    """Option that prints the description of a format and ends the command."""

    def show(ctx: click.Context, _: click.Parameter, name: str | None) -> None:
        if name is not None and not ctx.resilient_parsing:
            say(known[name].layout)
            ctx.exit()

    return click.option(
        "--layout", type=click.Choice(list(known)), metavar="NAME", is_eager=True,
        expose_value=False, callback=show,
        help="Print the layout of the files of a format and exit.",
    )  # fmt: skip
