"""Monte Carlo: how often a motion survives when robot, servos and floor are not quite the plan's.

Every draw is one open-loop replay under `mgs.sim.conditions`. A draw survives if the robot stays up
to the end. The rate comes with the 95 % interval of Wilson (J. Am. Stat. Assoc. 22, 1927); what
matters is told by the probability that a fallen draw had a larger deviation than a surviving one
(the statistic of Mann and Whitney), for each parameter.
"""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass

import numpy as np

from mgs.core.errors import DivergenceError
from mgs.core.progress import Progress
from mgs.core.short_repr import short_repr
from mgs.judge.motion_checks import Check
from mgs.judge.processes import in_order
from mgs.judge.verdict import replay_checks
from mgs.motion import Motion
from mgs.sim import DEFAULTS, EngineName, OneRobot, ServoName, Settings
from mgs.sim.conditions import RANGES, Ranges, draw
from mgs.sim.prepare import Prepared, prepare
from mgs.sim.replay import replay_prepared
from mgs.sim.settings import settings_of_draws

Z_95 = 1.959964  # of the normal distribution
LEAST_RATE = 0.95  # of draws that have to survive
LEAST_FALLS = 3  # below, nothing is said of what they have in common


@dataclass(frozen=True, eq=False)
class Task:
    """What all draws of one motion have in common."""

    prepared: Prepared
    ranges: Ranges
    seed: int


@dataclass(frozen=True, eq=False)
class Draw:
    """One draw and what became of it."""

    number: int
    engine: EngineName
    survived: bool
    failed: tuple[str, ...]  # checks of the replay, the fall included
    fall_time: float | None  # [s]
    max_tilt_deg: float
    figures: dict[str, float]  # parameters of the draw


@dataclass(frozen=True, eq=False)
class Robustness:
    """All draws of one motion in one engine."""

    engine: EngineName
    servo: ServoName
    ranges: str
    seed: int
    draws: tuple[Draw, ...]

    __repr__ = short_repr

    @property
    def n(self) -> int:
        """Number of draws."""
        return len(self.draws)

    @property
    def survived(self) -> int:
        """Number of draws in which the robot stayed up."""
        return sum(draw.survived for draw in self.draws)

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the survival rate."""
        return wilson(self.survived, self.n)

    def to_dict(self) -> dict[str, object]:
        """Convert to plain data."""
        rate = self.survived / self.n
        return {
            "engine": self.engine,
            "servo": self.servo,
            "ranges": self.ranges,
            "seed": self.seed,
            "n": self.n,
            "survived": self.survived,
            "survival_rate": rate,
            "wilson_95": list(self.interval),
            "passed": sum(not draw.failed for draw in self.draws),
            "fallen": [draw.number for draw in self.draws if not draw.survived],
            "offenders": offenders(self.draws),
        }


def monte_carlo(
    motion: Motion,
    engine: EngineName,
    *,
    n: int,
    seed: int = 0,
    ranges: str = "wide",
    servo: ServoName = "ideal",
    feed_forward: bool | None = None,
    settings: Settings | None = None,
    one_robot: OneRobot | None = None,
    workers: int = 1,
    progress: Progress | None = None,
) -> Robustness:
    """Replay a motion under n draws; the same arguments give the same result, whatever `workers`.

    Args:
        motion: the plan.
        engine: "pybullet" or "mujoco".
        n: number of draws.
        seed: of the draws.
        ranges: name of a set in `mgs.sim.conditions.RANGES`.
        servo: "ideal", "pd" or "model".
        feed_forward: whether servos are told feed-forward commands; None: modelled ones are.
        settings: None for the engine's defaults.
        one_robot: physical robot whose errors the simulated one has; None: none.
        workers: processes.
        progress: called with draws done and draws in all.

    Raises:
        SimulationError: the engine is missing. A draw whose simulation diverges has not survived.
    """
    settings = settings_of_draws(engine, servo, settings or DEFAULTS[engine])
    prepared = prepare(motion, engine, settings, servo, feed_forward, one_robot=one_robot)
    task = Task(prepared, RANGES[ranges], seed)
    done: list[Draw] = []
    with closing(in_order(replay_draw, task, n, workers)) as draws:
        for found in draws:
            done.append(found)
            if progress is not None:
                progress(len(done), n)
    return Robustness(engine, servo, ranges, seed, tuple(done))


def wilson(successes: int, n: int) -> tuple[float, float]:
    """95 % confidence interval of a rate."""
    if n == 0:
        return 0.0, 1.0
    p, z2 = successes / n, Z_95**2
    centre = p + z2 / (2.0 * n)
    half = Z_95 * np.sqrt(p * (1.0 - p) / n + z2 / (4.0 * n**2))
    low, high = (centre - half) / (1.0 + z2 / n), (centre + half) / (1.0 + z2 / n)
    return max(0.0, float(low)), min(1.0, float(high))


def survival_check(found: Robustness) -> Check:
    """Whether enough draws survived."""
    rate = found.survived / found.n
    fallen = [str(draw.number) for draw in found.draws if not draw.survived]
    where = f"fallen draws: {', '.join(fallen[:10])}" if fallen else ""
    name = f"{found.engine}_survival"
    return Check(name, rate >= LEAST_RATE, rate, LEAST_RATE, "of draws", None, where)


def summary(found: list[Robustness]) -> dict[str, object] | None:
    """Figures of the engine in which the motion does worst, and of every engine; None: no draws."""
    if not found:
        return None
    engines = [result.to_dict() for result in found]
    worst = min(engines, key=lambda figures: float(str(figures["survival_rate"])))
    keys = ("n", "survived", "survival_rate", "wilson_95", "ranges", "seed", "servo")
    return {**{key: worst[key] for key in keys}, "engines": engines}


def offenders(draws: tuple[Draw, ...]) -> list[dict[str, object]]:
    """Parameters in the order in which they separate falls from survivals.

    `probability` is that of a fallen draw to have the larger value: 0.5 says nothing, 0 that small
    values kill, 1 that large ones do; both signs of a slope or shift count alike.
    """
    fallen = [d.figures for d in draws if not d.survived]
    standing = [d.figures for d in draws if d.survived]
    if len(fallen) < LEAST_FALLS or len(standing) < LEAST_FALLS:
        return []
    found = []
    for name in fallen[0]:
        both_ways = name.startswith(("slope", "com"))
        a, b = (
            np.array([abs(f[name]) if both_ways else f[name] for f in group])
            for group in (fallen, standing)
        )
        wins = np.mean((a[:, None] > b) + 0.5 * (a[:, None] == b))
        found.append({"parameter": name, "probability": float(wins)})
    return sorted(found, key=lambda f: -abs(float(str(f["probability"])) - 0.5))


def replay_draw(task: Task, number: int) -> Draw:
    """Draw number `number` of a task and what becomes of it."""
    prepared = task.prepared
    engine = prepared.engine
    conditions = draw(prepared.motion, task.ranges, task.seed, number)
    figures = conditions.figures(prepared.servo)
    try:
        result = replay_prepared(
            prepared, conditions, with_contacts=not prepared.motion.gait.is_balanced
        )
    except DivergenceError:
        return Draw(number, engine, False, (f"{engine}_diverged",), None, 180.0, figures)
    return Draw(
        number=number,
        engine=engine,
        survived=not result.fell,
        failed=tuple(check.name for check in replay_checks(result) if not check.ok),
        fall_time=result.fall_time,
        max_tilt_deg=result.max_tilt_deg,
        figures=figures,
    )
