"""The whole judgement of a motion, static checks and physics: `mgs.validate`, `mgs validate`."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterable
from functools import partial
from pathlib import Path

from mgs.core.errors import ConfigError
from mgs.core.progress import StepProgress, progress_of_step
from mgs.judge.monte_carlo import monte_carlo as replay_draws
from mgs.judge.monte_carlo import summary, survival_check
from mgs.judge.motion_checks import check_motion, checks_left_out
from mgs.judge.servo_sweep import sweep_servos
from mgs.judge.verdict import Verdict, judge
from mgs.motion import Motion
from mgs.motion.energy import energy_of
from mgs.motion_file import read_motion
from mgs.robot import servos_of
from mgs.robot.unit import load_unit
from mgs.sim import (
    OneRobot,
    check_servos,
    choose_engines,
    choose_servos,
    engine_settings,
    missing_engines,
    replay,
)
from mgs.sim.conditions import RANGES, draw
from mgs.sim.settings import settings_of_draws

SERVOS = ("ideal", "pd")  # of the replays, unless others are asked for


def validate(
    motion: Motion | str | Path,
    *,
    physics: str | Iterable[str] | None = None,
    servo: str | Iterable[str] = SERVOS,
    sag_deg: float | None = None,
    damping_time: float | None = None,
    feed_forward: bool | None = None,
    monte_carlo: int | None = None,
    ranges: str = "wide",
    seed: int = 0,
    workers: int = 1,
    sample: int | None = None,
    servo_sweep: bool = False,
    unit: str | Path | None = None,
    corrected: bool = True,
    progress: StepProgress | None = None,
) -> Verdict:
    """Judge a motion by static checks and open-loop replays in physics.

    Args:
        motion: a motion or the path of a motion file.
        physics: names of engines; "none": static checks alone; None: every engine installed.
        servo: kinds of servos, one replay each: "ideal", "model" for the servos that robot.yaml
            describes, "pd" for PD servos; several in a list or with commas between them. By
            default ideal and PD servos, so that a motion passes only if it also stands on servos
            that give way and that nobody has modelled.
        sag_deg: position error of PD servos at stall torque [deg]; None: 1.
        damping_time: damping of PD servos divided by their stiffness [s]; None: 0.01.
        feed_forward: whether commands compensate the position error of servos that are not ideal;
            None: of modelled servos only.
        monte_carlo: number of further replays in each engine, with robot, servos and floor at
            random a little different from the plan and the first kind of servos; None: none.
        ranges: how large these differences are, "wide" or "lab" (half as large).
        seed: seed of the random differences.
        workers: number of processes for these replays and for those of a servo sweep.
        sample: number of one such draw, whose conditions the single replay of each engine then
            has; None: those of the plan.
        servo_sweep: whether PD servos of many kinds are replayed too (`mgs.judge.servo_sweep`); no
            check depends on it.
        unit: file with the corrections of one physical robot, whose errors the simulated robot
            then has; None: it has none.
        corrected: whether the commands are corrected for these errors, as those of an export are.
        progress: called with the name of a step, and work done and work in all of this step.

    Raises:
        ConfigError: an argument has a value that is not allowed, or robot.yaml gives a servo that
            is to be modelled no stiffness.
        MotionFileError: the motion file is missing or damaged.
        SimulationError: an engine is missing, has loaded another robot or diverged.
        TypeError: `motion` or `physics` has a wrong type.
    """
    engines = choose_engines(physics)
    servos = choose_servos(servo)
    check_servos(
        servos, {"feed_forward": feed_forward, "sag_deg": sag_deg, "damping_time": damping_time}
    )
    settings = {name: engine_settings(name, sag_deg, damping_time) for name in engines}
    _check_draws(monte_carlo, ranges, seed, workers, sample)
    file = str(motion) if isinstance(motion, str | Path) else ""
    motion = read_motion(motion)
    if "model" in servos:
        servos_of(motion.robot)  # before the checks take their time
    one_robot = None
    if unit is not None:
        one_robot = OneRobot(load_unit(Path(unit), motion.robot), corrected)
    checks = check_motion(motion, progress_of_step(progress, "static checks"))
    conditions = None if sample is None else draw(motion, RANGES[ranges], seed, sample)
    told = {kind: None if kind == "ideal" else feed_forward for kind in servos}
    replays = []
    for kind, name in itertools.product(servos, engines):
        run = partial(replay, servo=kind, feed_forward=told[kind], conditions=conditions)
        run = partial(run, one_robot=one_robot)
        tell = progress_of_step(progress, f"{name}, {kind} servos")
        used = settings[name]
        if sample is not None:
            used = settings_of_draws(name, kind, used)
        replays.append(run(motion, name, used, tell))
    found, n_draws = [], monte_carlo or 0
    for name in engines if n_draws else ():
        drawn = partial(replay_draws, n=n_draws, seed=seed, ranges=ranges, workers=workers)
        drawn = partial(drawn, servo=servos[0], feed_forward=told[servos[0]], one_robot=one_robot)
        tell = progress_of_step(progress, f"{name}, {n_draws} random replays")
        found.append(drawn(motion, name, settings=settings[name], progress=tell))
    checks += [survival_check(result) for result in found]
    verdict = judge(file or motion.gait_name, checks, replays, summary(found))
    verdict = dataclasses.replace(
        verdict,
        engines_missing=missing_engines(),
        energy=energy_of(motion),
        left_out=checks_left_out(motion),
        guesses=tuple(motion.robot.spec.guesses),
    )
    if not servo_sweep:
        return verdict
    sweeps = []
    for name in engines:
        tell = progress_of_step(progress, f"{name}, servo sweep")
        sweeps.append(sweep_servos(motion, name, settings[name], workers=workers, progress=tell))
    return dataclasses.replace(verdict, servo_sweep=tuple(sweeps))


def _check_draws(
    monte_carlo: int | None, ranges: str, seed: int, workers: int, sample: int | None
) -> None:
    if ranges not in RANGES:
        raise ConfigError("ranges", f"{ranges!r} is unknown; use {' or '.join(RANGES)}")
    counts = {
        "monte_carlo": (monte_carlo, 1),
        "seed": (seed, 0),
        "workers": (workers, 1),
        "sample": (sample, 0),
    }
    for name, (value, least) in counts.items():
        if value is None and name in ("monte_carlo", "sample"):
            continue
        if not isinstance(value, int) or value < least:
            raise ConfigError(name, f"should be a whole number, at least {least}; found {value!r}")
