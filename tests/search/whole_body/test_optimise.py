"""A motion with lower torques: what it keeps, what it gains, what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import mgs
from mgs.core.errors import ConfigError
from mgs.judge.motion_checks import check_motion
from mgs.motion import Motion
from mgs.motion_file import read_motion, write_motion
from mgs.search.refine import refine
from mgs.search.whole_body import Optimised, Weights, optimise
from tests.support.commands import run

EVERY = 0.04  # [s]


@pytest.fixture(scope="module")
def squat() -> Motion:
    return mgs.generate("melson", "melson/squat", dt=EVERY)


@pytest.fixture(scope="module")
def better(squat: Motion) -> Optimised:
    return optimise(squat)


def test_torques_fall_and_everything_else_that_is_asked_is_kept(squat: Motion, better: Optimised):
    found = better.motion
    assert better.after.torque_rms < 0.85 * better.before.torque_rms
    assert better.holds and better.solution.objective[-1] < better.solution.objective[0]
    np.testing.assert_allclose(found.q[[0, -1]], squat.q[[0, -1]], atol=1e-12)
    np.testing.assert_allclose(found.soles, squat.soles, atol=1e-6)
    assert better.after.zmp_margin > min(better.before.zmp_margin, 0.02) - 1e-3
    assert np.all(found.q[:, 7:] >= found.robot.lower) and np.all(
        found.q[:, 7:] <= found.robot.upper
    )
    assert [check.name for check in check_motion(found) if not check.ok] == []


def test_a_large_weight_of_the_plan_keeps_the_plan(squat: Motion):
    found = optimise(squat, Weights(distance=1e5), iterations=3)
    assert np.abs(found.motion.q[:, 7:] - squat.q[:, 7:]).max() < 5e-3


@pytest.mark.slow
def test_the_weight_of_the_work_lowers_the_work(squat: Motion, better: Optimised):
    found = optimise(squat, Weights(work=1.0))
    assert found.holds
    assert found.after.positive_work < 0.97 * better.after.positive_work


def test_a_motion_without_balance_and_one_with_a_payload_are_refused():
    with pytest.raises(ConfigError, match="does not stand on its soles"):
        optimise(mgs.generate("melson", "melson/get_up"))
    with pytest.raises(ConfigError, match="payload"):
        optimise(mgs.generate("melson", "melson/pick_up", pick_up__payload=0.1))


def test_the_command_writes_a_motion_and_prints_figures_of_both(squat: Motion, tmp_path: Path):
    path = tmp_path / "squat.mcap"
    write_motion(squat, path)
    done = run("optimize", path, "--iterations", 1, "--json")
    assert done.exit_code in (0, 1), done.output
    told = json.loads(done.stdout)
    written = read_motion(tmp_path / "squat_optimized.mcap")
    assert told["after"]["torque_rms"] < told["before"]["torque_rms"]
    assert told["after"]["torque_rms"] == pytest.approx(
        float(np.sqrt(np.mean(written.torque**2))), rel=1e-6
    )
    assert written.provenance.to_dict()["optimised"]["objective"][0] == told["objective"][0]
    again = run("optimize", path, "--iterations", 1)
    assert again.exit_code != 0 and "--force" in again.output


def test_a_refinement_would_undo_it_and_is_refused(better: Optimised):
    with pytest.raises(ConfigError, match="refine first"):
        refine(better.motion, ("mujoco",))


@pytest.mark.slow
def test_a_walk_with_lower_torques_stays_up_on_ideal_and_on_pd_servos():
    walk = mgs.generate("melson", "melson/walk_practical", walk__n_steps=4)
    found = optimise(walk)
    assert found.after.torque_rms < 0.85 * found.before.torque_rms
    fall = np.diff(found.motion.com[:, 2], n=2) / walk.dt**2  # of the CoM [m/s^2]
    assert fall.min() > -0.51 * 9.81  # the soles bear half of the weight at least
    verdict = mgs.validate(found.motion, physics="mujoco")
    assert verdict.passed, str(verdict)
