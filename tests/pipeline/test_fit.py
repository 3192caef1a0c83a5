"""Walks whose sizes are chosen so that the legs of the robot have reserve."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mgs.core.errors import InfeasibleGaitError
from mgs.gait import WalkGait, load_gait
from mgs.judge.motion_checks import check_motion
from mgs.motion.joint_load import uses_of_legs
from mgs.motion_planner import for_robot, plan_motion
from mgs.pipeline import generate, run_stages
from mgs.pipeline.fit import FACTORS, MOST_USE, fit_walk
from mgs.robot import Robot, leg_mask, load_robot
from mgs.robot.init import init_robot
from tests.support.bipeds import Biped

SHORT = ("walk.n_steps=3",)


def biped(folder: Path, effort: float) -> Robot:
    path = folder / "boxes.urdf"
    path.write_text(Biped(effort=effort).urdf())
    return init_robot(path).robot


def walk(*assignments: str) -> WalkGait:
    gait = load_gait("generic/walk", (*SHORT, *assignments))
    assert isinstance(gait, WalkGait)
    return gait


def test_a_walk_with_reserve_stays_as_derived():
    robot = load_robot("melson")
    made = generate(robot, walk())
    assert made.fit is not None
    assert (made.fit.changes, made.fit.tried) == ({}, 1)
    assert np.array_equal(made.motion.q, run_stages(robot, walk()).motion.q)


def test_weak_legs_get_another_walk_that_keeps_the_reserve(tmp_path: Path):
    robot = biped(tmp_path, 36.0)
    derived = run_stages(robot, walk()).motion
    assert max(use.part for use in uses_of_legs(derived)) > MOST_USE
    made = generate(robot, walk())
    assert made.fit is not None and made.fit.has_reserve and made.fit.changes
    # the figures of the verdict, which do not come from the search
    checks = {check.name: check for check in check_motion(made.motion)}
    for name in ("joint_speed", "joint_torque", "joint_torque_rms"):
        if checks[name].where in np.array(robot.joint_names)[leg_mask(robot)]:
            assert checks[name].value <= MOST_USE * checks[name].limit + 1e-9
    assert [check.name for check in checks.values() if not check.ok] == []
    for key, value in made.fit.changes.items():
        assert getattr(made.motion.gait.walk, key) == pytest.approx(value)


@pytest.mark.parametrize("effort", [pytest.param(36.0, marks=pytest.mark.slow), 40.0])
def test_no_change_is_kept_that_the_walk_can_do_without(effort: float, tmp_path: Path):
    robot = biped(tmp_path, effort)
    _, fit = fit_walk(robot, walk())
    assert fit.has_reserve and fit.changes
    for keys, _ in FACTORS:
        fewer = {key: value for key, value in fit.changes.items() if key not in keys}
        if fewer != fit.changes:
            stated = (f"walk.{key}={value}" for key, value in fewer.items())
            motion = run_stages(robot, walk(*stated)).motion
            assert max(use.part for use in uses_of_legs(motion)) > MOST_USE


def test_what_the_file_states_is_kept(tmp_path: Path):
    stated = {"lead_in": 1.0, "lead_out": 1.1, "step_length": 0.05, "single_support": 0.9}
    gait = walk(*(f"walk.{key}={value}" for key, value in stated.items()))
    stages, fit = fit_walk(biped(tmp_path, 30.0), gait)
    assert {key: getattr(stages.gait.walk, key) for key in stated} == stated
    assert not set(fit.changes) & set(stated)
    assert fit.tried > 1


@pytest.mark.slow
def test_what_no_walk_gives_is_told(tmp_path: Path):
    _, fit = fit_walk(biped(tmp_path, 8.0), walk())
    assert not fit.has_reserve
    tried = fit.tried - 1 - sum(len(factors) for _, factors in FACTORS)
    assert tried in (1, 2)  # long rests, with the height of the CoM as changed and as derived
    assert fit.changes["lead_in"] < 9.0  # which do not help, so that they are not kept
    assert "lasting torque of " in str(fit) or "torque of " in str(fit)


def test_walks_of_too_many_samples_are_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Longer rests, which weak legs would need, do not fit."""
    robot = biped(tmp_path, 30.0)
    as_derived = plan_motion(robot, for_robot(walk(), robot)).n_samples
    monkeypatch.setattr("mgs.gait.gait_file.MAX_SAMPLES", as_derived + 100)
    _, fit = fit_walk(robot, walk())
    assert not set(fit.changes) & {"lead_in", "lead_out"}


def test_a_walk_that_is_infeasible_with_all_sizes_has_the_message_of_the_first():
    with pytest.raises(InfeasibleGaitError) as caught:
        fit_walk(load_robot("melson"), walk("walk.step_length=0.25"))
    with pytest.raises(InfeasibleGaitError) as first:
        run_stages(load_robot("melson"), walk("walk.step_length=0.25"))
    assert str(caught.value) == str(first.value)
