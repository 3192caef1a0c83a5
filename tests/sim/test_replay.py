"""Replays of motions whose fate is known beforehand."""

from __future__ import annotations

import dataclasses
import json
import subprocess
import sys

import numpy as np
import pytest

from mgs.core.errors import SimulationError
from mgs.sim import DEFAULTS, replay
from tests.support.motions import leaning, standing
from tests.support.replays import figures, side_to_side


def test_a_standing_robot_stays_where_it_is(engine_name, melson):
    result = replay(standing(melson, 2.0), engine_name)
    assert not result.fell
    assert result.fall_time is None
    assert result.torque_saturation == 0.0
    assert result.max_tilt_deg < 0.1
    assert result.sole_slip_max < 1e-4
    assert result.position_error < 1e-4
    assert abs(result.yaw_error_deg) < 0.05
    assert result.joint_error_max_deg < 0.1  # what a stiff spring yields under the robot's weight
    assert result.min_base_height == pytest.approx(melson.standing_q[2], abs=1e-3)


def test_the_soles_carry_the_weight_through_the_knees(engine_name, melson):
    """Oracle: the torques that hold the posture against gravity, each leg bearing one half."""
    import pinocchio as pin

    result = replay(standing(melson, 1.0), engine_name)
    data, q = melson.model.createData(), melson.standing_q
    torque = pin.computeGeneralizedGravity(melson.model, data, q)
    support = np.array([0.0, 0.0, 0.5 * melson.mass * 9.81, 0.0, 0.0, 0.0])
    for frame in melson.sole_frames:
        jacobian = pin.computeFrameJacobian(melson.model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
        torque -= jacobian.T @ support
    knee = melson.joint_names.index("left_knee_pitch")
    # the feet can also push against each other, and the load need not be under the sole centres
    assert result.trace.torque[-1, knee] == pytest.approx(torque[6 + knee], abs=0.15)


def test_a_sway_over_resting_soles_is_followed(engine_name, melson):
    result = replay(side_to_side(melson, 0.02, 2.0), engine_name)
    assert not result.fell
    assert result.max_tilt_deg < 0.5
    assert result.sole_slip_max < 1e-3
    assert np.ptp(result.trace.q[:, 1]) == pytest.approx(0.02, abs=1e-3)


def test_a_robot_that_leans_too_far_falls_forward(engine_name, melson):
    """Its CoM passes the front edge of the soles at 13 deg of lean, 1.8 s into the motion."""
    result = replay(leaning(melson, np.radians(15.0), seconds=2.0), engine_name)
    assert result.fell
    assert 1.8 < result.fall_time < 3.0
    assert result.max_tilt_deg > 45.0
    assert len(result.trace.t) < 401  # the replay ends soon after a fall


def test_too_weak_servos_saturate_and_let_the_robot_down(engine_name, melson):
    weak = dataclasses.replace(melson, torque_limit=0.05 * melson.torque_limit)
    result = replay(standing(weak, 2.0), engine_name)
    assert result.fell
    assert result.torque_saturation > 0.05
    assert result.torque_saturation_joint in melson.joint_names
    assert max(result.torque_peak.values()) <= 0.05 * melson.torque_limit.max() * (1 + 1e-9)


def test_the_friction_asked_for_is_the_one_that_acts(engine_name, melson):
    """A sway that needs a sixth of the weight as side force slips on ice and on nothing else."""
    motion = side_to_side(melson, 0.03, 0.6)
    settings = DEFAULTS[engine_name]
    rough = replay(motion, engine_name, settings)
    ice = replay(motion, engine_name, dataclasses.replace(settings, friction=0.01))
    assert rough.sole_slip_max < 2e-3
    assert ice.sole_slip_max > 5e-3


def test_the_same_replay_twice_gives_the_same_figures(engine_name, melson):
    motion = side_to_side(melson, 0.02, 1.0)
    first, second = (replay(motion, engine_name) for _ in range(2))
    assert figures(first) == figures(second)
    np.testing.assert_array_equal(first.trace.q, second.trace.q)


ELSEWHERE = """
import json, sys
from mgs.robot import load_robot
from mgs.sim import replay
from tests.support.replays import figures, side_to_side
result = replay(side_to_side(load_robot("melson"), 0.02, 1.0), sys.argv[1])
print(json.dumps(figures(result)))
"""


def test_another_process_gives_the_same_figures(engine_name, melson):
    here = figures(replay(side_to_side(melson, 0.02, 1.0), engine_name))
    command = [sys.executable, "-c", ELSEWHERE, engine_name]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == json.loads(json.dumps(here))


@pytest.mark.slow_if("pybullet")
def test_the_verdict_holds_at_half_the_step_and_twice_the_iterations(engine_name, melson):
    motion, default = side_to_side(melson, 0.02, 1.0), DEFAULTS[engine_name]
    finer = dataclasses.replace(default, dt=default.dt / 2)
    thorough = dataclasses.replace(default, iterations=2 * default.iterations)
    for settings in (finer, thorough):
        result = replay(motion, engine_name, settings)
        assert not result.fell
        assert result.max_tilt_deg < 0.5
        assert result.sole_slip_max < 1e-3


def test_the_settings_used_are_reported_with_a_step_that_divides_the_period(engine_name, melson):
    settings = dataclasses.replace(DEFAULTS[engine_name], dt=0.0003, settle=0.1, tail=0.1)
    result = replay(standing(melson, 0.2), engine_name, settings)
    assert result.settings == dataclasses.replace(settings, dt=0.01 / 34)
    assert result.to_json()["settings"]["friction"] == 1.0
    assert len(result.trace.t) == 31  # 0.2 s and a tail of 0.1 s


def test_the_keys_that_scripts_rely_on_are_there(engine_name, melson):
    result = replay(standing(melson, 0.1), engine_name).to_json()
    keys = "engine fell fall_time distance planned_distance yaw_error_deg max_tilt_deg"
    keys += " joint_error_rms_deg torque_saturation sole_slip_max wall_seconds"
    assert set(keys.split()) <= set(result)
    assert json.loads(json.dumps(result)) == result


def test_progress_counts_up_to_the_end(engine_name, melson):
    calls = []
    replay(standing(melson, 0.1), engine_name, progress=lambda *done: calls.append(done))
    assert calls == [(k, 110) for k in range(1, 111)]


def test_targets_that_are_no_numbers_are_an_error(engine_name, melson, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    motion = standing(melson, 0.2)
    motion.q[10, 12] = np.nan
    with pytest.raises(SimulationError, match=r"diverged at t = 0\.1"):
        replay(motion, engine_name)
    assert not list(tmp_path.iterdir())  # MuJoCo would leave a log file


def test_an_unknown_engine_is_refused(melson):
    with pytest.raises(SimulationError, match="pybullet, mujoco"):
        replay(standing(melson, 0.1), "bullet")
