"""mgs batch."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mgs.cli.common import ProgressBar, json_option, print_json
from mgs.cli.judge import engines_of, servo_option

if TYPE_CHECKING:
    from mgs.library.points import Plan
    from mgs.library.run import Summary
    from mgs.sim import ServoName

sweep_argument = click.argument(
    "sweep", metavar="SWEEP.yaml", type=click.Path(exists=True, dir_okay=False, path_type=Path)
)


@click.group()
def batch() -> None:
    """Make a gait library: many variations of one gait.

    \b
    Examples:
      mgs batch plan speeds.yaml
      mgs batch run speeds.yaml -o outputs/speeds
    """  # noqa: D301


@batch.command()
@sweep_argument
@click.option(
    "--show", metavar="N", type=click.IntRange(0), default=5, help="Gaits to show. Default: 5."
)
@json_option
def plan(sweep: Path, show: int, as_json: bool) -> None:
    """Say how many gaits a sweep has, and show the first, without making any.

    \b
    Examples:
      mgs batch plan speeds.yaml
      mgs batch plan speeds.yaml --show 20 --json
    """  # noqa: D301
    from mgs.library.points import plan_sweep

    found = plan_sweep(sweep)
    first = [_shown(found, number) for number in range(min(show, len(found.points)))]
    if as_json:
        print_json(
            {
                "sweep": str(sweep),
                "base": str(found.base),
                "gaits": len(found.points),
                "filtered": found.n_filtered,
                "keys": list(found.keys),
                "first": first,
            }
        )
        return
    filtered = f" ({found.n_filtered} more are filtered out)" if found.n_filtered else ""
    click.echo(f"{len(found.points)} gaits{filtered}, variations of {found.base}")
    for gait in first:
        click.echo(f"{gait['number']:6d}  {'  '.join(gait['set'])}")
        if gait["problem"]:
            click.echo(f"        no gait: {gait['problem']}")
    if len(first) < len(found.points):
        click.echo(f"   and {len(found.points) - len(first)} more")


def _shown(plan: Plan, number: int) -> dict[str, Any]:
    """What is set in a gait, and why it would be none."""
    from mgs.core.errors import ConfigError
    from mgs.gait import parse_gait

    assignments = plan.assignments(number)
    problem = None
    try:
        parse_gait(plan.base_text, plan.base, assignments)
    except ConfigError as error:
        problem = "; ".join(error.problems)
    return {"number": number, "set": list(assignments), "problem": problem}


@batch.command()
@sweep_argument
@click.option(
    "-o", "--output", type=click.Path(file_okay=False, path_type=Path),
    help="Folder of the library; default outputs/SWEEP.",
)  # fmt: skip
@click.option(
    "--workers", metavar="N", type=click.IntRange(1, 1024),
    help="Processes on this machine; default: one for each processor.",
)  # fmt: skip
@click.option(
    "--dask", "address", metavar="ADDRESS",
    help="Scheduler of a running Dask cluster, e.g. tcp://HOST:8786, instead of processes here.",
)  # fmt: skip
@click.option(
    "--physics", metavar="ENGINES", default="none",
    help="Replay each gait too: pybullet, mujoco, or both with a comma. Default: none.",
)  # fmt: skip
@servo_option
@click.option(
    "--resume", is_flag=True,
    help="Go on with a library: make what is missing or damaged, leave the rest.",
)  # fmt: skip
@json_option
@click.pass_context
def run(
    ctx: click.Context,
    sweep: Path,
    output: Path | None,
    workers: int | None,
    address: str | None,
    physics: str,
    servo: ServoName,
    resume: bool,
    as_json: bool,
) -> None:
    """Make every gait of a sweep, check it, and keep files and figures in a folder.

    A gait that is infeasible or fails a check is a result, not an error: its row in
    manifest.sqlite says why. Exit code 1 when the run is cut short or the work on a gait broke
    down; --resume goes on.

    \b
    Examples:
      mgs batch run speeds.yaml -o outputs/speeds
      mgs batch run speeds.yaml -o outputs/speeds --resume
      mgs batch run speeds.yaml --physics pybullet,mujoco --servo model
      mgs batch run speeds.yaml --dask tcp://192.168.1.10:8786
    """  # noqa: D301
    from mgs.core.errors import ConfigError, MgsError

    if workers is not None and address is not None:
        raise ConfigError("--workers", "a running cluster (--dask) has workers of its own")
    engines = tuple(engines_of(physics))
    if servo == "model" and not engines:
        raise ConfigError("--servo", "model says nothing without --physics")
    from mgs.library.points import plan_sweep
    from mgs.library.quiet import silence

    silence()
    from mgs.library.run import recipe_of, run_batch

    found = plan_sweep(sweep)
    recipe = recipe_of(found, engines, servo)
    folder = output or Path("outputs") / sweep.stem
    bar = _Bar()
    try:
        summary = run_batch(
            found, recipe, folder, resume=resume, workers=workers, address=address, tell=bar
        )
    except KeyboardInterrupt as interrupt:
        message = f"stopped; {folder} is whole as far as it goes, go on with --resume"
        raise MgsError(message) from interrupt
    finally:
        bar.close()
    if as_json:
        print_json(summary.to_dict())
    else:
        _print(summary)
    ctx.exit(1 if summary.verdicts["lost"] else 0)


class _Bar:
    """The bar of a run: gaits done, rate, time left, and how many do not pass."""

    def __init__(self) -> None:
        self._bar = ProgressBar("gaits", detail=self._detail)
        self._summary: Summary | None = None
        self._said = False

    def __call__(self, summary: Summary) -> None:
        """Show a state."""
        self._summary = summary
        if not self._said and summary.dashboard:
            click.echo(f"dashboard: {summary.dashboard}", err=True)
        self._said = True
        self._bar(summary.kept + summary.done, summary.n)

    def _detail(self) -> str:
        assert self._summary is not None
        failed = sum(n for verdict, n in self._summary.verdicts.items() if verdict != "pass")
        return f"{self._summary.rate:.1f} gaits/s, {failed} without a pass"

    def close(self) -> None:
        """Leave the line."""
        self._bar.close()


def _print(summary: Summary) -> None:
    kept = f", {summary.kept} were there" if summary.kept else ""
    click.echo(
        f"{click.format_filename(str(summary.folder))}: {summary.n} gaits{kept}; "
        f"{summary.done} made in {summary.seconds:.1f} s by {summary.workers} workers "
        f"({summary.rate:.2f} gaits/s)"
    )
    for verdict in ("pass", "fail", "infeasible", "lost"):
        if n := summary.verdicts[verdict]:
            click.echo(f"{n:8d}  {verdict}")
    for reason, n in summary.reasons.most_common(20):
        click.echo(f"{n:8d}      {reason}")
