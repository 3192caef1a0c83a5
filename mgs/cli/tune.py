"""The command mgs tune."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mgs.cli.common import (
    FiniteRange,
    ProgressBar,
    force_option,
    json_option,
    print_json,
    say,
    with_progress,
)
from mgs.cli.judge import engines_of
from mgs.core.errors import ConfigError, MgsError, OutputExistsError

if TYPE_CHECKING:
    from mgs.search.tune.compare import Assessment
    from mgs.search.tune.study import Search, Trial

DEFAULT_MINUTES = 10.0


@click.command()
@click.argument("gait")
@click.option(
    "--robot", "robot_name", metavar="ROBOT",
    help="Name of a shipped robot, or robot folder. Default: the robot that the gait names.",
)  # fmt: skip
@click.option(
    "--objective", type=click.Choice(["robust", "speed", "energy", "torque"]), required=True,
    help="Aim of the search. robust: survive random conditions; speed: walk fast; energy: low "
    "cost of transport; torque: low joint torques.",
)  # fmt: skip
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False, path_type=Path),
    help="Gait file to write. Default: outputs/ROBOT/GAIT_OBJECTIVE.yaml.",
)  # fmt: skip
@click.option(
    "--minutes", type=FiniteRange(0.01, 100_000.0),
    help=f"Duration of the search [min]. Default: {DEFAULT_MINUTES:g} without --trials.",
)  # fmt: skip
@click.option(
    "--trials", type=click.IntRange(1, 1_000_000),
    help="Number of walks to judge, those of a continued search included. Default: no limit.",
)  # fmt: skip
@click.option(
    "--workers", type=click.IntRange(1, 1024), default=1,
    help="Number of worker processes. Default: 1.",
)  # fmt: skip
@click.option(
    "--seed", type=click.IntRange(0), default=0,
    help="Seed of the search and of its random conditions. Default: 0.",
)  # fmt: skip
@click.option(
    "--speed", type=FiniteRange(1e-4, 10.0),
    help="Speed that every walk keeps [m/s]; step sizes follow from the step time. Default: that "
    "of GAIT. Not with --objective speed.",
)  # fmt: skip
@click.option(
    "--margin", type=FiniteRange(0.0, 1.0),
    help="Least distance of the zero-moment point (ZMP) from the edge of the support polygon [m]. "
    "Default: that of GAIT for energy and torque, else 0.",
)  # fmt: skip
@click.option(
    "--pin", "pins", metavar="KEY=VALUE", multiple=True,
    help="Key of the gait file that keeps a value, e.g. walk.step_height=0.02. May be repeated.",
)  # fmt: skip
@click.option(
    "--free", "frees", metavar="KEY=LOW:HIGH", multiple=True,
    help="Key that is searched between two bounds, or among values (KEY=VALUE,VALUE), instead of "
    "its default. May be repeated.",
)  # fmt: skip
@click.option(
    "--physics", metavar="ENGINES",
    help="Physics engines for the replays: pybullet, mujoco or pybullet,mujoco. Default: all "
    "installed engines.",
)  # fmt: skip
@click.option(
    "--ranges", type=click.Choice(["wide", "lab"]),
    help="Ranges of the random conditions. Default: wide for robust, else lab.",
)  # fmt: skip
@click.option(
    "--draws", type=click.IntRange(0, 10_000),
    help="Number of random conditions for each walk with each kind of servos; for robust in each "
    "engine, else in the fastest one. 0: none, not for robust. Default: 24 for robust, else 8.",
)  # fmt: skip
@click.option(
    "--final-draws", type=click.IntRange(0, 100_000), default=100,
    help="Number of other random conditions for the comparison of GAIT with the best walk, in each "
    "engine with each kind of servos. Default: 100.",
)  # fmt: skip
@click.option("--resume", is_flag=True, help="Continue the search that the journal contains.")
@force_option
@json_option
@click.pass_context
def tune(
    ctx: click.Context,
    /,
    gait: str,
    robot_name: str | None,
    output: Path | None,
    minutes: float | None,
    trials: int | None,
    workers: int,
    final_draws: int,
    resume: bool,
    force: bool,
    as_json: bool,
    **asked: Any,
) -> None:
    """Search for the parameters of a walk that make it robust, fast or efficient.

    GAIT is a gait file or the name of a shipped gait with motion: walk. Durations, step sizes,
    heights, weights and gains are varied between bounds in proportion to the robot. Each walk is
    planned and checked, then replayed in MuJoCo with ideal and with PD servos, then under random
    conditions, then in all engines; it is given up as soon as it fails or cannot be the best. Swing
    feet have to rise by 4 % of the leg length.

    Writes a gait file, and beside it a page (.md) and a picture (.png) that compare GAIT with the
    best walk on random conditions that the search has not used, and the journal of the search
    (.journal). Ctrl-C ends the search and keeps the journal; --resume continues it. Exit code 1 if
    no walk passes.

    \b
    Examples:
      mgs tune melson/walk_practical --objective robust --minutes 30 --workers 2
      mgs tune walk --robot coman --objective speed --pin ik.torso=upright
      mgs tune melson/walk_practical --objective energy --free walk.landing=0.1:0.3
    """  # noqa: D301
    from mgs.pipeline.request import request
    from mgs.search.tune.setup import make_task
    from mgs.search.tune.study import search

    wanted = request(robot_name, gait)
    engines = tuple(engines_of(asked.pop("physics")))
    if not engines:
        raise ConfigError("--physics", "none is not possible, because the search needs replays; "
                          "name pybullet or mujoco")  # fmt: skip
    folder = Path("outputs") / Path(str(wanted.gait.robot)).name
    path = output or folder / f"{Path(gait).stem}_{asked['objective']}.yaml"
    journal = _journal(path, resume, force)
    task = make_task(
        wanted.robot, wanted.gait, engines=engines, n_draws=asked.pop("draws"), **asked
    )
    if not resume:
        journal.unlink(missing_ok=True)  # it may be replaced, see above
    if minutes is None and trials is None:
        minutes = DEFAULT_MINUTES
    line = _BestLine(task.objective, minutes, trials)
    try:
        found = search(
            task, journal, trials=trials, minutes=minutes, workers=workers, seed=task.seed,
            tell=line.tell,
        )  # fmt: skip
    finally:
        line.close()
    if found.interrupted:
        name = click.format_filename(str(journal))
        raise MgsError(f"interrupted after {len(found.trials)} walks; the same command with "
                       f"--resume continues the search in {name}")  # fmt: skip
    _finish(ctx, found, path, gait, final_draws, workers, as_json)


def _journal(path: Path, resume: bool, force: bool) -> Path:
    """Path of the journal; refuses what is in the way before any work is done."""
    from mgs.core.atomic_files import refuse_taken

    journal = path.with_suffix(".journal")
    if path.suffix in (".journal", ".md", ".png"):
        raise ConfigError(
            "--output", f"{path.name} is the name of a file beside the gait; use the ending .yaml"
        )
    for file in (path, path.with_suffix(".md"), path.with_suffix(".png")):
        refuse_taken(file, force or resume)
    if resume:
        if not journal.exists():
            raise ConfigError("--resume", f"{journal} does not exist; leave the option out")
        return journal
    try:
        refuse_taken(journal, force)
    except OutputExistsError as error:
        error.remedy = "--resume continues the search in it"
        raise
    return journal


class _BestLine:
    """Progress bar of a search with the best score so far."""

    def __init__(self, objective: str, minutes: float | None, trials: int | None) -> None:
        from mgs.search.tune.objective import UNITS

        self._unit = UNITS[objective]
        self._minutes, self._trials = minutes, trials
        self._text = "no walk passes so far"
        self._bar = ProgressBar("walks", lambda: self._text)

    def tell(self, done: int, seconds: float, best: Trial | None) -> None:
        """Report a finished walk."""
        told = "no walk passes so far"
        if best is not None:
            told = f"best {best.found.score:.4g} ({self._unit}), walk {best.number}"
        self._text = f"{done} walks in {seconds / 60.0:.1f} min; {told}"
        if self._trials is not None:
            self._bar(min(done, self._trials), self._trials)
        elif self._minutes is not None:
            total = max(1, round(60.0 * self._minutes))
            self._bar(min(round(seconds), total), total)

    def close(self) -> None:
        """End the line."""
        self._bar.close()


def _finish(
    ctx: click.Context,
    found: Search,
    path: Path,
    name: str,
    final_draws: int,
    workers: int,
    as_json: bool,
) -> None:
    """Measure start gait and best walk, write all files and print the comparison."""
    from mgs.core.atomic_files import replace_file
    from mgs.report import save_figures
    from mgs.report.tuning import comparison, plot_tuning, tuning_page
    from mgs.search.tune.compare import assess, gait_text

    best, task = found.best, found.task
    if best is None:
        _print_failure(found, as_json)
        ctx.exit(1)
    gaits = {"start gait": task.space.gait, "best walk": task.space.gait_of(best.values)}
    before, after = (
        with_progress(label, partial(assess, task, wanted, final_draws, workers))
        for label, wanted in gaits.items()
    )
    title = f"{name} on {task.robot.spec.name}, tuned for {task.objective}"
    text = gait_text(found, after, title)
    page = tuning_page(found, before, after, title, path.with_suffix(".png").name)
    replace_file(path, text.encode())
    replace_file(path.with_suffix(".md"), page.encode())
    save_figures({path.stem: plot_tuning(found)}, path.parent, "png", force=True)
    if as_json:
        print_json(_summary(found, path, before, after))
    else:
        say(f"{click.format_filename(str(path))}: walk {best.number} of "
                   f"{len(found.trials)}")  # fmt: skip
        for words, old, new in comparison(found, before, after):
            say(f"  {words:50s} {old:>24s} -> {new}")
        say(f"page: {click.format_filename(str(path.with_suffix('.md')))}")
    ctx.exit(0 if after.passed else 1)


def _summary(found: Search, path: Path, before: Assessment, after: Assessment) -> dict[str, object]:
    best, task = found.best, found.task
    assert best is not None
    return {
        "file": str(path),
        "objective": task.objective,
        "robot": task.robot.spec.name,
        "trials": len(found.trials),
        "seconds": found.seconds,
        "best": {"number": best.number, "score": best.found.score, "values": best.values},
        "importance": found.importance,
        "before": before.to_dict(),
        "after": after.to_dict(),
    }


def _print_failure(found: Search, as_json: bool) -> None:
    from mgs.search.tune.study import counts

    stages = counts(found)
    if as_json:
        print_json({"file": None, "trials": len(found.trials), "failed": stages})
        return
    say(f"none of {len(found.trials)} walks passes; no gait file was written")
    for stage, (n, reason) in stages.items():
        say(f"  {n} failed at {stage}, most of them: {reason}")
