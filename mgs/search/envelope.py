"""Speed envelope: the longest step for each step duration with which a walk passes.

For each step time the longest step that passes is found by bisection over integer multiples of a
resolution. A probe is a walk with these steps: it is planned, checked statically, and replayed in
one engine after another until a check fails, the fastest engine first. Bisection assumes that all
longer steps than a failing one fail as well; all probes are kept, so that exceptions are visible.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from contextlib import closing
from dataclasses import asdict, dataclass

from mgs.core.config import build
from mgs.core.constants import GRAVITY
from mgs.core.errors import ConfigError, DivergenceError, InfeasibleGaitError
from mgs.core.progress import Progress
from mgs.gait import WalkGait, WalkParameters
from mgs.judge.motion_checks import Check, check_motion
from mgs.judge.processes import in_order
from mgs.judge.verdict import replay_checks
from mgs.motion_planner.phases import MIN_SAMPLES
from mgs.motion_planner.scaling import REST
from mgs.pipeline import run_stages
from mgs.robot import Robot, leg_length
from mgs.sim import EngineName, ServoName, replay

PACES = (2.0, 2.5, 3.0, 4.0, 5.0, 6.0)  # default step times in units of sqrt(leg length / g)
SHARE_OF_SINGLE_SUPPORT = 0.8  # default part of single support in a step
STEP_HEIGHT = 0.05  # default step height as part of the leg length


@dataclass(frozen=True)
class Probe:
    """One walk of the search with its result."""

    step_time: float  # duration of double and single support together [s]
    step_length: float  # length of a step [m]
    failed: tuple[str, ...]  # names of failed checks, or of the error during planning
    message: str  # message of that error
    zmp_margin: float | None  # least ZMP margin of the plan [m]; None without a plan
    max_tilt_deg: float | None  # largest tilt of all replays [deg]; None without replays

    @property
    def passed(self) -> bool:
        """True if no check failed."""
        return not self.failed

    @property
    def speed(self) -> float:
        """Speed of the steady walk [m/s]."""
        return self.step_length / self.step_time


@dataclass(frozen=True, eq=False)
class Envelope:
    """All probes of one robot; `gait` is the walk whose steps are varied."""

    gait: WalkGait
    leg_length: float  # length of the stretched leg [m]
    engines: tuple[EngineName, ...]
    servo: ServoName
    resolution: float  # resolution of the step length [m]
    probes: tuple[Probe, ...]

    def limits(self) -> dict[float, Probe | None]:
        """Longest step that passes for each step time; None if no step passes."""
        found: dict[float, Probe | None] = {}
        for probe in sorted(self.probes, key=lambda p: (p.step_time, p.step_length)):
            found.setdefault(probe.step_time, None)
            if probe.passed:
                found[probe.step_time] = probe
        return found

    @property
    def fastest(self) -> Probe | None:
        """Fastest probe that passed; None if no probe passed."""
        return max((p for p in self.probes if p.passed), key=lambda p: p.speed, default=None)

    def fastest_gait(self) -> WalkGait | None:
        """Gait of the fastest probe that passed; None if no probe passed."""
        best = self.fastest
        return None if best is None else with_step(self.gait, best.step_time, best.step_length)

    def froude(self, probe: Probe) -> float:
        """Froude number v^2 / (g l) of a probe, with the leg length l."""
        return probe.speed**2 / (GRAVITY * self.leg_length)

    def to_dict(self) -> dict[str, object]:
        """Convert to plain data."""
        fastest = self.fastest
        return {
            "robot": self.gait.robot,
            "gait": self.gait.model_dump(mode="json"),
            "leg_length": self.leg_length,
            "engines": list(self.engines),
            "servo": self.servo,
            "resolution": self.resolution,
            "fastest": None if fastest is None else self._row(fastest),
            "probes": [self._row(probe) for probe in self.probes],
        }

    def _row(self, probe: Probe) -> dict[str, object]:
        figures = {"speed": probe.speed, "froude": self.froude(probe)}
        return {**asdict(probe), "failed": list(probe.failed), **figures}


def default_walk(robot: Robot, name: str) -> WalkGait:
    """Walk of ten steps in proportion to the robot; `name` is the robot in the gait file."""
    step_height = round(STEP_HEIGHT * leg_length(robot), 4)
    share = SHARE_OF_SINGLE_SUPPORT
    walk = WalkParameters(
        n_steps=10,
        step_height=step_height,
        single_support=share,
        double_support=round(1.0 - share, 9),
        lead_in=REST,
        lead_out=REST,
    )
    return WalkGait(mgs=1, robot=name, motion="walk", walk=walk)


def default_step_times(robot: Robot, dt: float) -> list[float]:
    """Step times [s] in proportion to the time constant of a pendulum with the leg length."""
    unit = math.sqrt(leg_length(robot) / GRAVITY)
    return sorted({round(round(pace * unit / dt) * dt, 6) for pace in PACES})


def with_step(gait: WalkGait, step_time: float, step_length: float) -> WalkGait:
    """Gait with other steps; the part of single support is kept up to whole samples.

    Raises:
        ConfigError: a value is not valid in a gait file.
    """
    steps = {**_phases(gait, step_time), "step_length": step_length}
    values = {**gait.model_dump(), "walk": {**gait.walk.model_dump(), **steps}}
    return build(WalkGait, values, f"a step of {step_length:g} m in {step_time:g} s")


def _phases(gait: WalkGait, step_time: float) -> dict[str, float]:
    walk = gait.walk
    share = walk.single_support / (walk.single_support + walk.double_support)
    least = MIN_SAMPLES * gait.dt
    single = round(share * step_time / gait.dt) * gait.dt
    single = round(max(min(single, step_time - least), least), 9)
    return {"single_support": single, "double_support": round(step_time - single, 9)}


def find_envelope(
    robot: Robot,
    gait: WalkGait,
    step_times: Iterable[float],
    *,
    resolution: float,
    engines: tuple[EngineName, ...],
    servo: ServoName = "model",
    workers: int = 1,
    progress: Progress | None = None,
    keep: Callable[[Envelope], None] | None = None,
) -> Envelope:
    """Find the longest step of each step time.

    Args:
        robot: robot model.
        gait: walk whose steps are varied.
        step_times: durations of double and single support together [s].
        resolution: resolution of the step lengths [m].
        engines: engines in which a walk has to pass.
        servo: "model" (with feed-forward) or "ideal".
        workers: number of processes.
        progress: function that is called with the number of finished step times and of all.
        keep: function that is called with the results so far after each step time.

    Raises:
        ConfigError: a step time is too short for the phases of the gait.
        SimulationError: an engine is missing.
    """
    probes: list[Probe] = []
    times = list(step_times)
    for step_time in times:
        _check_time(gait, step_time)

    def envelope() -> Envelope:
        return Envelope(gait, leg_length(robot), engines, servo, resolution, tuple(probes))

    jobs = [(robot, gait, step_time, resolution, engines, servo) for step_time in times]
    with closing(in_order(_column, jobs, len(jobs), workers)) as columns:
        for done, column in enumerate(columns, start=1):
            probes += column
            if keep is not None:
                keep(envelope())
            if progress is not None:
                progress(done, len(times))
    return envelope()


Job = tuple[Robot, WalkGait, float, float, tuple[EngineName, ...], ServoName]


def _check_time(gait: WalkGait, step_time: float) -> None:
    least = 2 * MIN_SAMPLES * gait.dt
    if step_time < least - 1e-9:
        raise ConfigError(
            "--times", f"{step_time:g} s is too short for a step; use at least {least:g} s"
        )


def _column(jobs: list[Job], number: int) -> list[Probe]:
    """Probes of one step time, by bisection between zero and the leg length."""
    robot, gait, step_time, resolution, engines, servo = jobs[number]
    probes: list[Probe] = []
    low, high = 0, max(2, math.ceil(min(leg_length(robot), 1.0) / resolution))
    while high - low > 1:
        middle = (low + high) // 2
        walk = with_step(gait, step_time, round(middle * resolution, 9))
        probes.append(probe(robot, walk, engines, servo))
        low, high = (middle, high) if probes[-1].passed else (low, middle)
    return probes


def probe(robot: Robot, gait: WalkGait, engines: tuple[EngineName, ...], servo: ServoName) -> Probe:
    """Plan, check and replay one walk until a check fails."""
    step_time = round(gait.walk.single_support + gait.walk.double_support, 9)
    step_length = gait.walk.step_length

    def found(
        failed: Iterable[str], message: str, margin: float | None, tilt: float | None
    ) -> Probe:
        return Probe(step_time, step_length, tuple(failed), message, margin, tilt)

    try:
        motion = run_stages(robot, gait).motion
    except InfeasibleGaitError as error:
        return found([type(error).__name__], str(error), None, None)
    checks = check_motion(motion)
    margin = next(check.value for check in checks if check.name == "zmp_margin")
    tilt: float | None = None
    failed = _failed(checks)
    for engine in sorted(engines):  # mujoco is first, because it is faster
        if failed:
            break
        try:
            result = replay(motion, engine, servo=servo)
        except DivergenceError as error:
            return found([f"{engine}_diverged"], str(error), margin, tilt)
        tilt = max(result.max_tilt_deg, tilt or 0.0)
        failed = _failed(replay_checks(result))
    return found(failed, "", margin, tilt)


def _failed(checks: list[Check]) -> list[str]:
    return [check.name for check in checks if not check.ok]
