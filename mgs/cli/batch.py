"""The commands mgs batch plan and mgs batch run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mgs.cli.common import FiniteRange, ProgressBar, json_option, print_json, say
from mgs.cli.judge import engines_of
from mgs.cli.servo_options import servo_option

if TYPE_CHECKING:
    from mgs.library.points import Plan
    from mgs.library.summary import Summary
    from mgs.sim import ServoName

sweep_argument = click.argument(
    "sweep", metavar="SWEEP.yaml", type=click.Path(exists=True, dir_okay=False, path_type=Path)
)


@click.group()
def batch() -> None:
    """Make a gait library: many variations of one gait.

    SWEEP.yaml names the base gait and the values of the keys that vary; mgs schema sweep describes
    this file.

    \b
    Examples:
      mgs batch plan speeds.yaml
      mgs batch run speeds.yaml -o outputs/speeds
    """  # noqa: D301


@batch.command(short_help="Print the number of gaits in a sweep, and the first few.")
@sweep_argument
@click.option(
    "--show", metavar="N", type=click.IntRange(0), default=5,
    help="Number of gaits to print. Default: 5.",
)  # fmt: skip
@json_option
def plan(sweep: Path, show: int, as_json: bool) -> None:
    """Print the number of gaits in a sweep, and the first few of them.

    Reads SWEEP.yaml and its base gait. Makes no gait and writes no file.

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
    say(f"{len(found.points)} gaits{filtered}, variations of {found.base}")
    for gait in first:
        say(f"{gait['number']:6d}  {'  '.join(gait['set'])}")
        if gait["problem"]:
            say(f"        invalid gait: {gait['problem']}")
    if len(first) < len(found.points):
        say(f"   and {len(found.points) - len(first)} more")


def _shown(plan: Plan, number: int) -> dict[str, Any]:
    """Number and assignments of a gait, and the reason if it is invalid."""
    from mgs.core.errors import ConfigError
    from mgs.gait import parse_gait

    assignments = plan.assignments(number)
    problem = None
    try:
        parse_gait(plan.base_text, plan.base, assignments)
    except ConfigError as error:
        problem = "; ".join(error.problems)
    return {"number": number, "set": list(assignments), "problem": problem}


@batch.command(short_help="Make and check every gait of a sweep.")
@sweep_argument
@click.option(
    "-o", "--output", type=click.Path(file_okay=False, path_type=Path),
    help="Folder of the library. Default: outputs/SWEEP.",
)  # fmt: skip
@click.option(
    "--workers", metavar="N", type=click.IntRange(1, 1024),
    help="Number of worker processes on this machine. Default: one per processor.",
)  # fmt: skip
@click.option(
    "--dask", "address", metavar="ADDRESS",
    help="Address of the scheduler of a running Dask cluster, e.g. tcp://HOST:8786, to be used "
    "instead of worker processes on this machine.",
)  # fmt: skip
@click.option(
    "--physics", metavar="ENGINES", default="none",
    help="Physics engines in which each gait is replayed: pybullet, mujoco, pybullet,mujoco or "
    "none. Default: none.",
)  # fmt: skip
@servo_option
@click.option(
    "--timeout", metavar="SECONDS", type=FiniteRange(1.0, 1e6), default=600.0,
    help="Time limit of one gait [s]; a gait that takes longer gets the verdict lost. Default: "
    "600.",
)  # fmt: skip
@click.option(
    "--resume", is_flag=True,
    help="Continue an unfinished library: make the gaits that are missing or damaged, keep the "
    "others.",
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
    timeout: float,
    resume: bool,
    as_json: bool,
) -> None:
    """Make and check every gait of a sweep.

    Reads SWEEP.yaml and its base gait. Writes one motion file per gait and the table
    manifest.sqlite, which holds the verdict and the figures of every gait.

    An infeasible gait or a failed check is a result, not an error: the row of the gait states the
    reason. Exit code 0 if every gait has a verdict; 1 if the run was interrupted or the
    computation of a gait broke down. Use --resume to continue such a run.

    \b
    Examples:
      mgs batch run speeds.yaml -o outputs/speeds
      mgs batch run speeds.yaml -o outputs/speeds --resume
      mgs batch run speeds.yaml --physics pybullet,mujoco --servo model
      mgs batch run speeds.yaml --dask tcp://192.168.1.10:8786
    """  # noqa: D301
    from mgs.core.errors import ConfigError, MgsError

    if workers is not None and address is not None:
        raise ConfigError(
            "--workers", "cannot be combined with --dask; the cluster has its own workers"
        )
    engines = tuple(engines_of(physics))
    if servo != "ideal" and not engines:
        remedy = "has no effect without replays; add --physics ENGINES"
        raise ConfigError("--servo", f"{servo} {remedy}")
    from mgs.library.points import plan_sweep
    from mgs.library.quiet import silence

    silence()
    from mgs.library.run import recipe_of, run_batch

    found = plan_sweep(sweep)
    recipe = recipe_of(found, engines, servo, timeout)
    folder = output or Path("outputs") / sweep.stem
    bar = _Bar()
    try:
        summary = run_batch(
            found, recipe, folder, resume=resume, workers=workers, address=address, tell=bar
        )
    except KeyboardInterrupt as interrupt:
        message = f"interrupted; all gaits made so far are in {folder}; continue with --resume"
        raise MgsError(message) from interrupt
    finally:
        bar.close()
    if as_json:
        print_json(summary.to_dict())
    else:
        _print(summary)
    ctx.exit(1 if summary.verdicts["lost"] else 0)


class _Bar:
    """Progress bar of a run: finished gaits, rate, remaining time, number that did not pass."""

    def __init__(self) -> None:
        self._bar = ProgressBar("gaits", detail=self._detail)
        self._summary: Summary | None = None
        self._said = False

    def __call__(self, summary: Summary) -> None:
        """Show the progress of the run."""
        self._summary = summary
        if not self._said and summary.dashboard:
            say(f"dashboard: {summary.dashboard}", err=True)
        self._said = True
        self._bar(summary.kept + summary.done, summary.n)

    def _detail(self) -> str:
        assert self._summary is not None
        failed = sum(n for verdict, n in self._summary.verdicts.items() if verdict != "pass")
        return f"{self._summary.rate:.1f} gaits/s, {failed} did not pass"

    def close(self) -> None:
        """End the line of the bar."""
        self._bar.close()


def _print(summary: Summary) -> None:
    kept = f", {summary.kept} already present" if summary.kept else ""
    say(
        f"{click.format_filename(str(summary.folder))}: {summary.n} gaits{kept}; "
        f"{summary.done} made in {summary.seconds:.1f} s by {summary.workers} workers "
        f"({summary.rate:.2f} gaits/s)"
    )
    for verdict in ("pass", "fail", "infeasible", "lost"):
        if n := summary.verdicts[verdict]:
            say(f"{n:8d}  {verdict}")
    for reason, n in summary.reasons.most_common(20):
        say(f"{n:8d}      {reason}")
