"""The command `mgs`: thin, one file per group; heavy imports happen inside the commands."""

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
    """An error of ours as click shows it."""

    def __init__(self, error: MgsError) -> None:
        super().__init__(str(error))
        self.exit_code = error.exit_code  # type: ignore[misc]


class ErrorsAsMessages(click.Group):
    """Turns every error of ours into one message on stderr and its exit code."""

    def invoke(self, ctx: click.Context) -> object:
        """Run the command."""
        try:
            return super().invoke(ctx)
        except MgsError as error:
            raise _Message(error) from error
        except BrokenPipeError:
            raise  # the reader of our output has gone; click ends quietly
        except OSError as error:
            what = f"{error.filename}: {error.strerror}" if error.filename else str(error)
            raise click.ClickException(what) from error
        except MemoryError as error:
            raise click.ClickException("there is not enough memory for this") from error


@click.group(cls=ErrorsAsMessages, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="mgs")
def main() -> None:
    """Offline motion generation for position-controlled humanoid robots.

    A gait file (YAML) becomes a joint trajectory (MCAP) that the robot plays back open loop, and a
    verdict on it from static checks and physics.

    \b
    Example:
      mgs generate melson/walk_5cm -o walk.mcap
      mgs validate walk.mcap
      mgs plot walk.mcap -o plots

    Exit codes: 0 done (and passed), 1 the motion fails or the work could not be done, 2 malformed
    input or wrong usage.
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
