"""The command-line program `mgs`: one file per command group, imported when called."""

from __future__ import annotations

import traceback

import click

from mgs import __version__
from mgs.cli.lazy_group import LazyCommand, LazyGroup
from mgs.cli.process import prepare_process
from mgs.core.errors import MgsError
from mgs.core.foreign import described
from mgs.core.short_text import printable

COMMANDS = {
    "generate": LazyCommand("mgs.cli.generate", "Make a motion file from a gait file."),
    "info": LazyCommand("mgs.cli.inspect", "Print the contents and the origin of a motion file."),
    "plot": LazyCommand(
        "mgs.cli.inspect", "Plot footsteps, balance and joint trajectories of a motion."
    ),
    "report": LazyCommand(
        "mgs.cli.report", "Write a page that shows a motion, its verdict and plots."
    ),
    "validate": LazyCommand(
        "mgs.cli.judge", "Judge a motion by static checks and replays in physics."
    ),
    "replay": LazyCommand("mgs.cli.judge", "Execute a motion open loop in one physics engine."),
    "import": LazyCommand("mgs.cli.import_", "Make a motion file of somebody else's motion."),
    "audit": LazyCommand("mgs.cli.audit", "Find what is wrong with a motion, whoever made it."),
    "repair": LazyCommand(
        "mgs.cli.repair", "Make the nearest motion that holds of one that does not."
    ),
    "envelope": LazyCommand(
        "mgs.cli.envelope", "Find the longest step and the fastest walk of a robot."
    ),
    "optimize": LazyCommand("mgs.cli.optimize", "Lower the torques of a finished motion."),
    "refine": LazyCommand(
        "mgs.cli.refine", "Correct a motion by the deviations that its replays show."
    ),
    "tune": LazyCommand(
        "mgs.cli.tune", "Search for parameters that make a walk robust, fast or efficient."
    ),
    "export": LazyCommand(
        "mgs.cli.export", "Write a motion for another program: trainer, servos, spreadsheet."
    ),
    "play": LazyCommand("mgs.cli.play", "Stream a motion to Dynamixel servos."),
    "compare": LazyCommand(
        "mgs.cli.compare", "Compare a motion with a log of the robot that executed it."
    ),
    "batch": LazyCommand("mgs.cli.batch", "Make a gait library: many variations of one gait."),
    "library": LazyCommand(
        "mgs.cli.library", "Query, export and summarize a gait library; tables by velocity."
    ),
    "robot": LazyCommand("mgs.cli.robot", "List, show, check and create robot descriptions."),
    "gait": LazyCommand("mgs.cli.gait", "List and show the shipped gait files."),
    "experiment": LazyCommand(
        "mgs.cli.experiment", "Repeat the experiments of a paper and test its claims."
    ),
    "schema": LazyCommand("mgs.cli.schema", "Print the JSON schema of gait, robot or sweep files."),
}


class _Message(click.ClickException):
    """An error as an exception that click prints, control characters escaped."""

    def __init__(self, message: str, exit_code: int = 1) -> None:
        super().__init__(printable(message))
        self.exit_code = exit_code  # type: ignore[misc]


class ErrorsAsMessages(LazyGroup):
    """Command group that prints every error as one message on stderr and sets the exit code."""

    def invoke(self, ctx: click.Context) -> object:
        """Run the command."""
        try:
            return super().invoke(ctx)
        except (click.exceptions.Exit, click.Abort, click.ClickException):
            raise
        except Exception as error:
            if ctx.params.get("debug"):
                traceback.print_exception(error)
            raise self._told(error) from error

    def _told(self, error: Exception) -> Exception:
        """The message that an exception becomes; the exception itself if click deals with it."""
        match error:
            case MgsError():
                return _Message(str(error), error.exit_code)
            case BrokenPipeError():
                return error  # the reader of stdout has closed the pipe; there is no message
            case OSError():
                return _Message(
                    f"{error.filename}: {error.strerror}" if error.filename else str(error)
                )
            case MemoryError():
                return _Message("not enough memory for this command")
        return _Message(
            f"unforeseen error in mgs: {described(error)}; mgs --debug COMMAND shows where it "
            "happened, please report it"
        )


@click.group(
    cls=ErrorsAsMessages,
    table=COMMANDS,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(__version__, prog_name="mgs")
@click.option("--debug", is_flag=True, help="Show the traceback of an error.")
def main(debug: bool) -> None:
    """Generate motions for position-controlled humanoid robots offline.

    mgs generate turns a gait file (YAML) into a motion file (MCAP): a joint trajectory that the
    robot executes open loop. mgs validate judges a motion file by static checks and by replays in
    physics engines.

    \b
    Example:
      mgs generate melson/walk_5cm -o walk.mcap
      mgs validate walk.mcap
      mgs plot walk.mcap -o plots
      mgs report walk.mcap

    Exit codes: 0 success; 1 the motion fails or the work could not be done; 2 malformed input or
    wrong usage.
    """  # noqa: D301
    del debug  # ErrorsAsMessages looks at it
    prepare_process()
