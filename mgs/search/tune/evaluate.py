"""Judgement of one walk of the search in stages, the cheapest first.

    plan -> static checks -> MuJoCo: all kinds of servos -> random conditions -> all engines

A walk that fails a stage does not reach the next one. Where the plan alone tells the score, a walk
is only replayed if it would be the best by 1 %. Other engines than MuJoCo come last, because their
replays take ten times as long. Where robustness is the objective, random conditions are drawn in
them too, and they are only asked about a walk that is promising: of those judged so far, none
survives more often in MuJoCo. For other objectives random conditions are those of MuJoCo alone.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from mgs.core.errors import ConfigError, DivergenceError, InfeasibleGaitError
from mgs.judge.monte_carlo import Task, replay_draw
from mgs.judge.motion_checks import Check, check_motion
from mgs.judge.verdict import replay_checks
from mgs.motion import Motion
from mgs.pipeline import run_stages
from mgs.robot import Robot
from mgs.search.tune.objective import (
    ObjectiveName,
    known_score,
    least_clearance,
    plan_figures,
)
from mgs.search.tune.space import Space, Value
from mgs.sim import DEFAULTS, EngineName, Replay, ServoName, replay
from mgs.sim.conditions import RANGES
from mgs.sim.prepare import prepare
from mgs.sim.settings import settings_of_draws

STAGES = ("plan", "checks", "first replays", "random conditions", "all replays", "passes")
PD_CASES = (  # sag [deg] and friction of replays with PD servos: first three that differ most
    (1.0, 1.0), (2.0, 0.7), (0.5, 1.3),
    (2.0, 1.3), (2.0, 1.0), (1.0, 0.7), (1.0, 1.3), (0.5, 0.7), (0.5, 1.0),
)  # fmt: skip
WRONG_STIFFNESS = (0.7, 1.4)  # that feed-forward is computed for, relative to the servos'
MOST_FAILED = 4  # replays in the fastest engine, after which a walk is given up
LEAST_RATE = 0.9  # of draws that a walk survives, where robustness is not the objective
SURVIVAL = "survival "  # what the names of survival rates among the figures begin with
LEAST_GAIN = 0.01  # over the best score, from which minutes of replays are worth it
ROUNDING = 1e-4  # [m] by which a margin may be below the one asked for


@dataclass(frozen=True)
class Column:
    """Replays under random conditions in one engine with one kind of servos."""

    engine: EngineName
    servo: ServoName

    def __str__(self) -> str:
        return f"{self.engine}, {self.servo} servos"


class Nominal(NamedTuple):
    """Servos and floor of a replay that is not random."""

    servo: ServoName
    sag_deg: float = 1.0  # of PD servos
    friction: float = 1.0
    assumed_stiffness: float = 1.0  # of feed-forward, relative to that of the servos

    def __str__(self) -> str:
        if self.servo == "pd":
            return f"pd {self.sag_deg:g} deg, friction {self.friction:g}"
        wrong = f", commands for {self.assumed_stiffness:g} times the stiffness"
        return f"{self.servo}{wrong if self.assumed_stiffness != 1.0 else ''}"


@dataclass(frozen=True, eq=False)
class TuneTask:
    """What all walks of one search have in common."""

    robot: Robot
    space: Space
    objective: ObjectiveName
    engines: tuple[EngineName, ...]
    servos: tuple[ServoName, ...]  # of random conditions
    ranges: str
    n_draws: int  # in each column
    seed: int  # of the draws
    least_margin: float = 0.0  # of the ZMP from the edge of the support polygon [m]
    least_score: float = 0.0  # of the start gait; walks that score less are not replayed

    @property
    def columns(self) -> tuple[Column, ...]:
        """Engines and servos of random conditions, the fastest to simulate first."""
        engines = sorted(self.engines)
        return tuple(Column(engine, servo) for engine in engines for servo in self.servos)


@dataclass(frozen=True)
class Found:
    """One walk of the search."""

    score: float
    stage: str  # that it failed, or "passes"
    reason: str = ""  # checks that failed, or the message of the planner
    pruned: bool = False  # whether it was given up since another walk is better
    figures: dict[str, float] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        """True if the walk went through all stages."""
        return self.stage == STAGES[-1] and not self.pruned


def evaluate(
    task: TuneTask, values: Mapping[str, Value], best: float = 0.0, promising: float = 0.0
) -> Found:
    """Judge the walk with these values.

    Args:
        task: what all walks have in common.
        values: values of the keys that are varied.
        best: score of the best walk so far that passes; 0: none.
        promising: survival rate in the fastest engine below which no other engine is asked, where
            robustness is the objective.
    """
    try:
        motion = run_stages(task.robot, task.space.gait_of(values)).motion
    except (ConfigError, InfeasibleGaitError) as error:
        return Found(-4.0, STAGES[0], str(error)[:300])
    found = judge_plan(task, motion)
    if found.stage != STAGES[-1]:
        return found
    figures = found.figures
    known = known_score(task.objective, figures)
    if known is not None and known <= (1.0 + LEAST_GAIN) * best:
        return Found(known, STAGES[-1], "is hardly better than the best, or worse", True, figures)
    fastest = min(task.engines)  # mujoco, where both are asked
    for engine in sorted(task.engines):
        failed = _replayed(task, motion, engine)
        if failed is not None:
            level, stage = (-2.0, STAGES[2]) if engine == fastest else (0.0, STAGES[4])
            return Found(level - failed[0], stage, failed[1], False, figures)
        if known is None:
            last = engine == max(task.engines)
            figures |= _survival(task, motion, engine, best if last else max(best, promising))
            least = min(_rates(figures))
            if not last and least < promising:
                reason = f"survives less in {engine} than walks that are replayed in all engines"
                return Found(least - 2.0, STAGES[3], reason, False, figures)
            if least <= best:
                return Found(least, STAGES[-1], "", True, figures)
        elif engine == fastest and task.n_draws:
            figures |= _survival(task, motion, engine, LEAST_RATE)
            if (least := min(_rates(figures))) < LEAST_RATE:
                reason = f"survives {least:.2f} of the random conditions"
                return Found(least - 2.0, STAGES[3], reason, False, figures)
    if known is None:
        rates = _rates(figures)
        score = 0.99 * min(rates) + 0.01 * sum(rates) / len(rates)
        return Found(score, STAGES[-1], "", score <= best, figures)
    return Found(known, STAGES[-1], "", False, figures)


def judge_plan(task: TuneTask, motion: Motion) -> Found:
    """Static checks of a plan, foot clearance and margin of the ZMP."""
    checks = check_motion(motion)
    figures = plan_figures(motion)
    figures |= {
        check.name: check.value for check in checks if check.name in ("zmp_margin", "joint_torque")
    }
    limits = [(check.name, _excess(check)) for check in checks if not check.ok]
    clearance, margin = least_clearance(task.robot), task.least_margin - ROUNDING
    if figures["clearance"] < clearance:
        limits.append(("clearance", 1.0 - figures["clearance"] / clearance))
    if 0.0 < margin > figures["zmp_margin"]:
        limits.append(("margin asked for", min(1.0, 1.0 - figures["zmp_margin"] / margin)))
    if not limits:
        return Found(0.0, STAGES[-1], figures=figures)
    total = sum(excess for _, excess in limits)
    reason = ", ".join(name for name, _ in limits)
    return Found(-3.0 - total / (1.0 + total), STAGES[1], reason, False, figures)


def _excess(check: Check) -> float:
    """By how much a failed check exceeds its limit, in logarithms; 1 where the limit is 0."""
    return math.log1p(abs(check.value - check.limit) / abs(check.limit)) if check.limit else 1.0


def _replayed(task: TuneTask, motion: Motion, engine: EngineName) -> tuple[float, str] | None:
    """What is missing until all nominal replays in an engine pass (0 to 1), and the first reason.

    None: they pass. A walk that has failed several replays, or one in a slow engine, is given up,
    and counts as failed entirely in those that are left.
    """
    cases = exact_replays(task.servos) + wrong_replays(task.servos) + pd_replays()
    most = MOST_FAILED if engine == min(task.engines) else 1
    missing, reasons = 0.0, []
    for done, case in enumerate(cases, start=1):
        bad, reason = _missing(motion, engine, case)
        missing += bad
        if bad:
            reasons.append(reason)
        if len(reasons) == most:
            missing += len(cases) - done
            break
    return (missing / len(cases), reasons[0]) if reasons else None


def exact_replays(servos: Iterable[ServoName]) -> list[Nominal]:
    """Replays with servos that are exactly those planned for."""
    return [Nominal(servo) for servo in servos if servo != "pd"]


def wrong_replays(servos: Iterable[ServoName]) -> list[Nominal]:
    """Replays with modelled servos whose feed-forward is computed for another stiffness."""
    factors = WRONG_STIFFNESS if "model" in servos else ()
    return [Nominal("model", assumed_stiffness=factor) for factor in factors]


def pd_replays() -> list[Nominal]:
    """Replays with plain PD servos."""
    return [Nominal("pd", *case) for case in PD_CASES]


def replay_nominal(motion: Motion, engine: EngineName, case: Nominal) -> Replay:
    """One replay with the physics steps of `mgs validate`; raises DivergenceError."""
    settings = dataclasses.replace(
        DEFAULTS[engine], sag=math.radians(case.sag_deg), friction=case.friction
    )
    return replay(
        motion, engine, settings, servo=case.servo, assumed_stiffness=case.assumed_stiffness
    )


def _missing(motion: Motion, engine: EngineName, case: Nominal) -> tuple[float, str]:
    name = f"{engine} {case}"
    try:
        result = replay_nominal(motion, engine, case)
    except DivergenceError:
        return 1.0, f"{name}: diverged"
    if result.fell:
        upright = (result.fall_time or 0.0) / max(motion.duration, motion.dt)
        return 1.0 - 0.5 * min(1.0, upright), f"{name}: fell at {result.fall_time:.1f} s"
    failed = [check for check in replay_checks(result, "") if not check.ok]
    total = sum(_excess(check) for check in failed)
    reason = f"{name}: {', '.join(check.name.strip('_') for check in failed)}"
    return 0.5 * total / (1.0 + total), reason


def _survival(task: TuneTask, motion: Motion, engine: EngineName, floor: float) -> dict[str, float]:
    """Survival rates in an engine by column, until one is below a floor."""
    rates: dict[str, float] = {}
    for column in task.columns:
        if column.engine == engine:
            rates[f"{SURVIVAL}{column}"] = rate = survival_rate(task, motion, column, floor)
            if rate < floor:
                break
    return rates


def promising_rate(task: TuneTask, judged: Iterable[Found]) -> float:
    """Survival rate in the fastest engine from which a walk is worth replays in all engines."""
    fastest = f"{SURVIVAL}{min(task.engines)}"
    rates = [min(own) for found in judged if (own := _rates(found.figures, fastest))]
    return min(LEAST_RATE, max(rates, default=0.0))


def _rates(figures: Mapping[str, float], prefix: str = SURVIVAL) -> list[float]:
    """Survival rates among the figures of a walk."""
    return [rate for name, rate in figures.items() if name.startswith(prefix)]


def survival_rate(
    task: TuneTask, motion: Motion, column: Column, floor: float, draws: range | None = None
) -> float:
    """Part of the draws that a walk survives; ends early when it is sure to be below a floor.

    Args:
        task: ranges, seed and number of draws.
        motion: the walk.
        column: engine and servos.
        floor: rate below which the exact rate does not matter.
        draws: numbers of the draws; None: as many as the task says, from 0.
    """
    numbers = range(task.n_draws) if draws is None else draws
    settings = settings_of_draws(column.engine, column.servo, DEFAULTS[column.engine])
    prepared = prepare(motion, column.engine, settings, column.servo)
    draw_task = Task(prepared, RANGES[task.ranges], task.seed)
    falls = 0
    for done, number in enumerate(numbers, start=1):
        falls += not replay_draw(draw_task, number).survived
        most = 1.0 - falls / len(numbers)
        if most < floor:  # a cautious estimate: one more that survives, and one more that falls
            return min(most, (done - falls + 1) / (done + 2))
    return 1.0 - falls / len(numbers)
