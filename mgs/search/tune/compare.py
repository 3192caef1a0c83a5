"""The start gait and the best walk side by side, on draws that the search has not seen."""

from __future__ import annotations

from dataclasses import dataclass

from mgs.core.errors import ConfigError, DivergenceError, InfeasibleGaitError
from mgs.core.progress import Progress
from mgs.gait import WalkGait
from mgs.gait.commented import commented_yaml
from mgs.judge.monte_carlo import Robustness, monte_carlo
from mgs.judge.motion_checks import check_motion
from mgs.judge.verdict import replay_checks
from mgs.motion import Motion
from mgs.pipeline import run_stages
from mgs.search.tune.evaluate import (
    Nominal,
    TuneTask,
    exact_replays,
    pd_replays,
    replay_nominal,
    wrong_replays,
)
from mgs.search.tune.objective import plan_figures
from mgs.search.tune.space import STEP_KEYS, value_at
from mgs.search.tune.study import Search
from mgs.sim import EngineName

HELD_OUT = 1_000_003  # added to the seed of the search


@dataclass(frozen=True)
class Assessment:
    """One gait with all its figures."""

    gait: WalkGait
    message: str = ""  # why it cannot be planned
    failed: tuple[str, ...] = ()  # static checks and nominal replays that fail
    figures: dict[str, float] | None = None  # of the plan
    pd_passed: dict[str, tuple[int, int]] | None = None  # by engine: PD replays that pass, and all
    wrong_passed: dict[str, tuple[int, int]] | None = None  # the same with wrong feed-forward
    survival: tuple[Robustness, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether plan, checks and all nominal replays pass."""
        swept = [*(self.pd_passed or {}).values(), *(self.wrong_passed or {}).values()]
        return not self.message and not self.failed and all(n == total for n, total in swept)

    def to_dict(self) -> dict[str, object]:
        """Convert to plain data."""
        return {
            "gait": self.gait.model_dump(mode="json"),
            "message": self.message,
            "failed": list(self.failed),
            "figures": self.figures,
            "pd_passed": {k: list(v) for k, v in (self.pd_passed or {}).items()},
            "wrong_passed": {k: list(v) for k, v in (self.wrong_passed or {}).items()},
            "survival": [found.to_dict() for found in self.survival],
        }


def assess(
    task: TuneTask,
    gait: WalkGait,
    n_draws: int,
    workers: int = 1,
    progress: Progress | None = None,
) -> Assessment:
    """Measure a gait with the physics steps of mgs validate.

    Args:
        task: robot, engines, servos and ranges.
        gait: the gait.
        n_draws: number of draws in each column; 0: none.
        workers: number of processes for the draws.
        progress: called with finished parts and all parts.
    """
    n_parts = 2 * len(task.engines) + (len(task.columns) if n_draws else 0)
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, n_parts)

    try:
        motion = run_stages(task.robot, gait).motion
    except (ConfigError, InfeasibleGaitError) as error:
        return Assessment(gait, str(error))
    checks = check_motion(motion)
    failed = [check.name for check in checks if not check.ok]
    margin = next(check.value for check in checks if check.name == "zmp_margin")
    swept: dict[str, tuple[int, int]] = {}
    wrong: dict[str, tuple[int, int]] = {}
    for engine in sorted(task.engines):
        for case in exact_replays(task.servos):
            failed += _failed(motion, engine, case)
        step()
        if cases := wrong_replays(task.servos):
            wrong[engine] = _passed(motion, engine, cases)
        swept[engine] = _passed(motion, engine, pd_replays())
        step()
    survival = []
    for column in task.columns if n_draws else ():
        survival.append(
            monte_carlo(
                motion, column.engine, n=n_draws, seed=task.seed + HELD_OUT,
                ranges=task.ranges, servo=column.servo, workers=workers,
            )
        )  # fmt: skip
        step()
    figures = plan_figures(motion) | {"zmp_margin": margin, "duration": motion.duration}
    return Assessment(gait, "", tuple(failed), figures, swept, wrong, tuple(survival))


def _passed(motion: Motion, engine: EngineName, cases: list[Nominal]) -> tuple[int, int]:
    """How many of some replays pass, and how many there are."""
    return sum(not _failed(motion, engine, case) for case in cases), len(cases)


def _failed(motion: Motion, engine: EngineName, case: Nominal) -> list[str]:
    """Checks of one replay that fail."""
    name = engine if case.servo == "ideal" else f"{engine}_{case.servo}"
    try:
        result = replay_nominal(motion, engine, case)
    except DivergenceError:
        return [f"{name}_diverged"]
    return [check.name for check in replay_checks(result, name) if not check.ok]


def gait_text(search: Search, after: Assessment, title: str) -> str:
    """Text of the gait file of the best walk; comments say what each tuned value was before."""
    task, start = search.task, search.task.space.gait
    comments: dict[str, str] = {}
    for parameter in task.space.parameters:
        key = ".".join(parameter.key.split(".")[:2])
        old, new = value_at(start, key), value_at(after.gait, key)
        if new != old:
            comments[key] = f"before: {_in_words(old)}"
    for key in STEP_KEYS:
        old, new = value_at(start, key), value_at(after.gait, key)
        if new != old and key not in comments:
            comments[key] = f"before: {_in_words(old)}; keeps the speed"
    heading = [f"{title}: best of {len(search.trials)} walks."]
    if after.figures is not None:
        heading.append(
            f"Speed {after.figures['speed']:.3g} m/s, cost of transport "
            f"{after.figures['cost_of_transport']:.3g}, ZMP margin "
            f"{1e3 * after.figures['zmp_margin']:.3g} mm."
        )
    for found in after.survival:
        heading.append(
            f"Survives {found.survived} of {found.n} draws of {found.ranges} in {found.engine} "
            f"with {found.servo} servos."
        )
    return commented_yaml(after.gait, comments, heading)


def _in_words(value: object) -> str:
    if value is None:
        return "null"
    if isinstance(value, dict):
        return ", ".join(f"{name} {_in_words(part)}" for name, part in value.items())
    return f"{value:.4g}" if isinstance(value, float) else str(value)
