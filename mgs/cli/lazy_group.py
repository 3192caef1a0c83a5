"""A command group that imports the module of a command when that command is called."""

from __future__ import annotations

import importlib
import keyword
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import click


@dataclass(frozen=True)
class LazyCommand:
    """A command of the same name in a module, and the line that the help of its group prints.

    A name that Python reserves has an underscore behind it there: `import_`.
    """

    module: str
    short_help: str


class LazyGroup(click.Group):
    """Command group that prints its help from `table` alone, without importing any command.

    Importing all command modules takes as long as starting Python and importing click together.
    """

    def __init__(self, *args: Any, table: Mapping[str, LazyCommand], **settings: Any) -> None:
        super().__init__(*args, **settings)
        self._table = table

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of all commands, sorted."""
        return sorted(self._table)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of a name, imported now; None where there is none."""
        if cmd_name not in self._table:
            return None
        module = importlib.import_module(self._table[cmd_name].module)
        name = f"{cmd_name}_" if keyword.iskeyword(cmd_name) else cmd_name
        command = getattr(module, name)
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the section `Commands` of the help."""
        rows = [(name, self._table[name].short_help) for name in self.list_commands(ctx)]
        with formatter.section("Commands"):
            formatter.write_dl(rows)
