"""Tests of the crouch experiment: heights, losses, ratios, claims of small and whole studies."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from mgs.core.constants import FLOATING_BASE_NV
from mgs.experiments import run
from mgs.experiments.claim import Claim
from mgs.experiments.crouch import claims as told
from mgs.experiments.crouch.engines import Measured
from mgs.experiments.crouch.figures import NAMES, plot_power, plot_torque
from mgs.experiments.crouch.losses import copper_factor, electric_power
from mgs.experiments.crouch.runs import (
    COMAN,
    JUDGED,
    MELSON,
    MOTIONS,
    MotionName,
    Run,
    Sweep,
    given_robots,
    methods_of,
    run_one,
    straight_height,
)
from mgs.experiments.crouch.study import Study
from mgs.experiments.faraji.runs import Z_MAX
from mgs.experiments.variant import BASE
from mgs.motion import Motion
from mgs.robot import Robot, servos_of
from mgs.robot.identified import MOTORS
from mgs.sim import available_engines


@pytest.fixture(scope="module")
def robots() -> dict[str, Robot]:
    return given_robots()


def made(robots: dict[str, Robot], name: str, motion: MotionName, fraction: float) -> Run:
    found = run_one(name, robots[name], motion, JUDGED, fraction, BASE)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def ends(robots: dict[str, Robot]) -> dict[tuple[str, float], Run]:
    """Standing and swaying of COMAN on stretched and on crouched legs."""
    pairs = [(m, f) for m in MOTIONS[:2] for f in (1.0, 0.76)]
    return {(m, f): made(robots, COMAN, m, f) for m, f in pairs}


def test_straight_legs_of_coman_are_as_high_as_the_experiments_of_faraji_say(robots):
    assert straight_height(robots[COMAN]) == pytest.approx(Z_MAX, abs=1e-4)


# --- losses -----------------------------------------------------------------------------------


def test_the_copper_factor_is_no_load_speed_over_stall_torque_at_any_supply(robots):
    """A motor that stalls and one that runs free, at the same voltage: R / k^2 = speed / torque."""
    factor = copper_factor(robots[MELSON])
    motor = MOTORS["bam/mx64"]
    assert factor is not None
    for supply in (9.0, 15.0):
        expected = motor.no_load_speed(supply) / motor.stall_torque(supply)
        assert factor == pytest.approx(expected, rel=1e-12)


def test_servos_that_are_not_identified_have_no_electric_power(robots, ends):
    assert copper_factor(robots[COMAN]) is None
    assert all(one.electric is None and one.cost == one.torque2 for one in ends.values())


@pytest.fixture(scope="module")
def standing(robots: dict[str, Robot]) -> Run:
    return made(robots, MELSON, "stand", 0.93)


def changed(run: Run, torque: float, speed: float) -> Motion:
    """The motion with one torque and speed at its first joint and none elsewhere."""
    motion = run.motion
    torques, v = np.zeros_like(motion.torque), np.zeros_like(motion.v)
    torques[:, 0], v[:, FLOATING_BASE_NV] = torque, speed
    return dataclasses.replace(motion, torque=torques, v=v)


def test_a_servo_at_rest_draws_its_copper_loss(standing):
    factor = MOTORS["bam/mx64"].resistance / MOTORS["bam/mx64"].torque_constant ** 2
    power = electric_power(changed(standing, 2.0, 0.0))
    assert power == pytest.approx(factor * 4.0)


def test_a_servo_that_turns_draws_voltage_times_current_and_gives_nothing_back(standing):
    motor, motion = MOTORS["bam/mx64"], changed(standing, 2.0, 1.5)
    power = electric_power(motion)
    v, torque = motion.v[0, FLOATING_BASE_NV:], motion.torque[0]
    friction = servos_of(motion.robot).friction_under_load(v, torque)[0]
    assert friction > 0.3 * 2.0  # of the load, which gears of this kind lose
    current = (2.0 + friction) / motor.torque_constant
    voltage = motor.resistance * current + motor.torque_constant * 1.5
    assert power == pytest.approx(voltage * current)
    braking = electric_power(changed(standing, -4.0, 6.0))
    assert braking is not None and np.all(braking >= 0.0)


# --- sweeps and claims ------------------------------------------------------------------------


def test_standing_and_swaying_take_over_three_times_as_much_on_crouched_legs(ends):
    """The paper's factor, for its motion and its method."""
    stretched, crouched = ends["sway", 1.0], ends["sway", 0.76]
    quiet = ends["stand", 1.0]
    assert stretched.is_feasible and crouched.is_feasible and quiet.is_feasible
    assert stretched.knee_deg < 10.0 < 90.0 < crouched.knee_deg
    sweep = Sweep(COMAN, "sway", JUDGED, (stretched, crouched), quiet)
    assert sweep.net_ratio > sweep.ratio > told.THREE_TIMES


def altered(run: Run, **changes: float) -> Run:
    return dataclasses.replace(run, **changes)


def small_study(ends: dict[tuple[str, float], Run], crouched: float) -> Study:
    """Every sweep has a stretched run of 10 and a crouched one of `crouched` (N m)^2."""
    base, sweeps = ends["stand", 1.0], {}
    runs = (
        altered(base, torque2=10.0, knee_deg=5.0),
        altered(base, torque2=crouched, knee_deg=90.0),
    )
    middle = altered(base, torque2=0.5 * (10.0 + crouched), knee_deg=47.5)
    quiet = altered(base, torque2=4.0)
    for robot in (COMAN, MELSON):
        for motion in MOTIONS:
            for method in methods_of(robot, motion):
                all_runs = (runs[0], middle, runs[1])
                sweeps[robot, motion, method] = Sweep(robot, motion, method, all_runs, quiet)
    engines = tuple(
        Measured(motion, "mujoco", "ideal", (10.0, crouched), (10.0, 0.9 * crouched), False)
        for motion in MOTIONS[1:]
    )
    return Study(sweeps, engines)


def by_id(study: Study) -> dict[str, Claim]:
    return {claim.id: claim for claim in told.all_claims(study)}


def test_claims_follow_the_figures(ends):
    high, low = by_id(small_study(ends, 40.0)), by_id(small_study(ends, 12.0))
    for name in ("stand_ratio", "walk_ratio", "sway_ratio", "losses", "sway_engines"):
        assert (high[name].holds, low[name].holds) == (True, False)
    assert high["sway_ratio"].values[JUDGED] == pytest.approx(36.0 / 6.0)
    assert high["walk_ratio"].values[JUDGED] == pytest.approx(4.0)
    assert high["sway_line"].values["slope"] == pytest.approx(30.0 / 85.0)
    assert high["walk_engines"].holds and high["stretched"].holds
    assert [high[name].kind for name in ("sway_ratio", "walk_ratio")] == ["paper", "ours"]


def test_what_a_robot_cannot_do_does_not_count(ends):
    base = ends["stand", 1.0]
    bad = {
        "soles 2 mm off": altered(base, sole_error=2e-3),
        "3 deg beyond a joint limit": altered(base, limit_excess_deg=3.0),
        "1.2 times the stall torque": altered(base, overload=1.2),
    }
    for reason, one in bad.items():
        assert (one.is_feasible, one.trouble) == (False, reason)
    sweep = Sweep(COMAN, "walk", JUDGED, (None, *bad.values(), base), base)
    assert sweep.made == [base] and math.isnan(sweep.ratio)


def test_engines_that_do_not_agree_are_told(ends):
    study = small_study(ends, 40.0)
    fell = dataclasses.replace(study.engines[1], fell=True)
    assert not by_id(Study(study.sweeps, (study.engines[0], fell)))["walk_engines"].holds
    assert by_id(Study(study.sweeps, ()))["walk_engines"].holds == "not applicable"


def test_figures_show_every_method(ends):
    study = small_study(ends, 40.0)
    labels = {line.get_label() for axes in plot_torque(study).axes for line in axes.lines}
    assert {"ik1", "ik2", "ik3", "ik4", "ik5", "clik"} <= labels
    assert len(plot_power(study).axes[0].lines) >= len(MOTIONS)


@pytest.mark.slow
def test_the_whole_experiment(tmp_path: Path):
    claims = {claim.id: claim for claim in run("crouch", tmp_path)}
    assert sorted(path.stem for path in tmp_path.iterdir()) == sorted(NAMES)
    held = {name for name, claim in claims.items() if claim.holds is True}
    assert {"stand_ratio", "sway_ratio", "sway_line", "stretched", "walk_joints", "losses"} <= held
    assert claims["walk_ratio"].holds is False
    if len(available_engines()) == 2:
        assert claims["walk_engines"].holds is True
