"""The command-line program `mgs`: one file per command group; heavy imports inside the commands."""

from __future__ import annotations

import click

from mgs import __version__
from mgs.cli.batch import batch
from mgs.cli.envelope import envelope
from mgs.cli.experiment import experiment
from mgs.cli.export import export
from mgs.cli.generate import generate
from mgs.cli.inspect import info, plot
from mgs.cli.judge import replay, validate
from mgs.cli.library import library
from mgs.cli.refine import refine
from mgs.cli.robot import robot
from mgs.cli.schema import schema
from mgs.core.errors import MgsError


class _Message(click.ClickException):
    """An MgsError as an exception that click prints."""

    def __init__(self, error: MgsError) -> None:
        super().__init__(str(error))
        self.exit_code = error.exit_code  # type: ignore[misc]


class ErrorsAsMessages(click.Group):
    """Command group that prints an MgsError as one message on stderr and sets its exit code."""

    def invoke(self, ctx: click.Context) -> object:
        """Run the command."""
        try:
            return super().invoke(ctx)
        except MgsError as error:
            raise _Message(error) from error
        except BrokenPipeError:
            raise  # the reader of stdout has closed the pipe; click exits without a message
        except OSError as error:
            what = f"{error.filename}: {error.strerror}" if error.filename else str(error)
            raise click.ClickException(what) from error
        except MemoryError as error:
            raise click.ClickException("not enough memory for this command") from error


@click.group(cls=ErrorsAsMessages, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="mgs")
def main() -> None:
    """Generate motions for position-controlled humanoid robots offline.

    mgs generate turns a gait file (YAML) into a motion file (MCAP): a joint trajectory that the
    robot executes open loop. mgs validate judges a motion file by static checks and by replays in
    physics engines.

    \b
    Example:
      mgs generate melson/walk_5cm -o walk.mcap
      mgs validate walk.mcap
      mgs plot walk.mcap -o plots

    Exit codes: 0 success; 1 the motion fails or the work could not be done; 2 malformed input or
    wrong usage.
    """  # noqa: D301


for command in (
    generate,
    info,
    plot,
    validate,
    replay,
    envelope,
    refine,
    export,
    batch,
    library,
    robot,
    experiment,
    schema,
):
    main.add_command(command)
