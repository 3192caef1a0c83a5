"""Corrections from a log of a simulated physical robot, shown on motions that were not logged.

The robot in MuJoCo has servos of its own stiffness (within 20 % of the described one), play of 0.5
deg in its gears and zeros that are off by 1 deg. One motion is logged, at a rate and a start of the
log's own, with noise and in ticks; other motions are then executed with corrected commands.
"""

from __future__ import annotations

import functools
import sys

import numpy as np
import pytest

import mgs
from mgs.judge.logged.comparison import compare_log, unit_spec
from mgs.motion import Motion
from mgs.motion.goals import goals_along
from mgs.motion_file.joint_log import JointLog
from mgs.robot.unit import Unit as Corrections
from mgs.robot.unit import load_unit, write_unit
from tests.support.physical_robot import Executed, Unit, drawn, execute

TICK = 0.00511  # [rad] of the servos of melson


@functools.cache
def motion(name: str) -> Motion:
    settings = {"walk__n_steps": 4} if "walk" in name else {}
    return mgs.generate(gait=f"melson/{name}", **settings)


def logged(plan: Motion, executed: Executed, seed: int) -> JointLog:
    rng = np.random.default_rng([seed, 1])
    own = plan.dt * np.arange(len(executed.position))
    times = np.arange(0.0, own[-1], 1.0 / 80.0)
    columns = [np.interp(times, own, column) for column in executed.position.T]
    noisy = np.stack(columns, axis=1) + rng.normal(0.0, 1e-3, (len(times), plan.robot.n))
    position = np.rint(noisy / TICK) * TICK
    return JointLog("a log", plan.robot.joint_names, times + rng.uniform(3.0, 50.0), position, None)


def joint_error(plan: Motion, executed: Executed) -> float:
    """RMS over all joints, up to the end or to a fall [deg]."""
    n = len(executed.position)
    return float(np.degrees(np.sqrt(np.mean((executed.position - plan.q[:n, 7:]) ** 2))))


@functools.cache
def identified(folder, seed: int) -> tuple[Unit, Corrections]:
    """A physical robot, and what `compare` makes of its log; through the file."""
    plan = motion("squat")
    true = drawn(plan.robot, seed)
    log = logged(plan, execute(plan, goals_along(plan).position, true), seed)
    path = folder / f"unit_{seed}.yaml"
    write_unit(unit_spec(compare_log(plan, log), plan, f"robot {seed}", "squat"), path)
    return true, load_unit(path, plan.robot)


SHOWN = [
    pytest.param(name, seed, marks=[] if (name, seed) == ("sway", 1) else pytest.mark.slow)
    for name in ("sway", "bow", "walk_5cm")
    for seed in (1, 2, 3, 4, 5)
]


@pytest.mark.parametrize(("name", "seed"), SHOWN)
def test_corrections_of_one_motion_halve_the_joint_error_of_another(
    tmp_path_factory, name, seed, capsys
):
    true, unit = identified(tmp_path_factory.getbasetemp(), seed)
    plan = motion(name)
    before = execute(plan, goals_along(plan).position, true)
    after = execute(plan, goals_along(plan, unit=unit).position, true)
    assert not after.fell
    errors = joint_error(plan, before), joint_error(plan, after)
    with capsys.disabled():
        sys.stdout.write(
            f"\n{name}, robot {seed}: joint error {errors[0]:.3f}, corrected {errors[1]:.3f} deg"
            f"{', falls without corrections' if before.fell else ''}\n"
        )
    assert errors[1] < 0.5 * errors[0]
