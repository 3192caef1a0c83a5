"""Boxes and balls in the engines, and kicks and stairs on them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_allclose

from mgs.core.scene import Ball, Box, Scene
from mgs.gait import load_gait
from mgs.judge.verdict import replay_checks
from mgs.pipeline import run_stages
from mgs.robot import load_robot
from mgs.sim import replay
from mgs.sim.strike import measure_strike
from tests.support.motions import standing
from tests.support.shipped import generated

FAR_BALL = Ball(0.5, 0.0, 0.0325, 0.05, 0.0, 0.0, 0.5)


def failed(result) -> list[str]:
    return [check.name for check in replay_checks(result) if not check.ok]


def test_a_ball_rests_until_it_is_struck(engine_name, melson):
    motion = dataclasses.replace(standing(melson, 0.5), scene=Scene(balls=(FAR_BALL,)))
    result = replay(motion, engine_name)
    balls = result.trace.balls
    assert_allclose(balls[:, 0, :3], np.broadcast_to([0.5, 0.0, 0.0325], balls[:, 0, :3].shape),
                    atol=1e-3)  # fmt: skip
    assert result.strikes[0].time is None
    assert failed(result) == [f"{engine_name}_ball_speed", f"{engine_name}_ball_direction"]


def test_a_ball_does_not_weigh_on_the_robot(engine_name, melson):
    """Mass and CoM of the robot are proven when the engine is made; contacts are the soles' own."""
    motion = dataclasses.replace(standing(melson, 0.5), scene=Scene(balls=(FAR_BALL,)))
    loads = replay(motion, engine_name).trace.contacts[-1, :, 2].sum()
    assert loads == pytest.approx(9.81 * melson.mass, rel=0.02)


def test_a_robot_stands_on_a_box(engine_name, melson):
    """Oracle: the same robot on the ground, lifted."""
    low = standing(melson, 0.5)
    q, soles = low.q.copy(), low.soles.copy()
    q[:, 2] += 0.05
    soles[..., 2] += 0.05
    high = dataclasses.replace(
        low,
        q=q,
        soles=soles,
        soles_ref=soles,
        footsteps=tuple(dataclasses.replace(f, z=0.05) for f in low.footsteps),
        scene=Scene(boxes=(Box(0.01, 0.0, 0.3, 0.4, 0.4, 0.05),)),
    )
    down, up = (replay(motion, engine_name) for motion in (low, high))
    assert failed(up) == []
    assert up.min_base_height == pytest.approx(down.min_base_height + 0.05, abs=1e-3)
    loads = up.trace.contacts[-1, :, 2].sum()
    assert loads == pytest.approx(9.81 * melson.mass, rel=0.02)


def test_without_the_box_it_comes_down(engine_name, melson):
    low = standing(melson, 0.3)
    q = low.q.copy()
    q[:, 2] += 0.05
    high = dataclasses.replace(
        low, q=q, footsteps=tuple(dataclasses.replace(f, z=0.05) for f in low.footsteps)
    )
    assert replay(high, engine_name).trace.soles[-1, :, 2].max() < 0.01


def test_a_strike_is_measured_as_it_happened():
    dt = 0.01
    t = np.arange(100) * dt
    soles = np.zeros((100, 2, 7))
    soles[:, 1, 0] = 0.6 * t  # the right sole at 0.6 m/s
    states = np.zeros((100, 6))
    states[40:, 3:5] = 0.5 * np.array([np.cos(0.3), np.sin(0.3)])
    found = measure_strike(dataclasses.replace(FAR_BALL, direction=0.2), states, soles, dt)
    assert found.time == pytest.approx(0.40)
    assert found.sole_speed == pytest.approx(0.6)
    assert found.ball_speed == pytest.approx(0.5)
    assert found.direction_error_deg == pytest.approx(np.degrees(0.1))


@pytest.mark.parametrize("servo", ["ideal", "model"])
@pytest.mark.slow_if("pybullet")
def test_melson_strikes_the_ball_as_asked_and_stays_up(engine_name, servo):
    motion = generated("melson/kick").stages.motion
    ball = motion.scene.balls[0]
    assert (ball.radius, ball.mass) == (0.0325, 0.05)
    result = replay(motion, engine_name, servo=servo)
    assert failed(result) == []
    (strike,) = result.strikes
    assert strike.time == pytest.approx(ball.time, abs=0.03)
    assert strike.ball_speed >= max(0.5 * strike.sole_speed, 0.3)
    assert abs(strike.direction_error_deg) < 10.0


@pytest.mark.slow_if("pybullet")
def test_a_kick_to_the_side_sends_the_ball_there(engine_name, melson):
    gait = load_gait("melson/kick", ("kick.direction=0.3", "kick.foot=left"))
    result = replay(run_stages(melson, gait).motion, engine_name)
    x, y = result.trace.balls[-1, 0, :2] - result.trace.balls[0, 0, :2]
    assert failed(result) == []
    assert np.arctan2(y, x) == pytest.approx(0.3, abs=0.1)


@pytest.mark.parametrize("engine", ["mujoco", pytest.param("pybullet", marks=pytest.mark.slow)])
def test_coman_climbs_three_stairs(engine):
    pytest.importorskip(engine)
    motion = generated("coman/stairs").stages.motion
    tops = [box.height for box in motion.scene.boxes]
    assert_allclose(tops, [0.05, 0.10, 0.15])
    assert motion.robot.spec.name == load_robot("coman").spec.name
    result = replay(motion, engine)
    assert failed(result) == []
    assert_allclose(result.trace.soles[-1, :, 2], 0.15, atol=2e-3)


def test_without_the_rod_the_obstacle_walk_is_the_same_and_with_a_wall_it_fails(melson):
    """The rod is there: a wall in its place throws the robot off its plan."""
    pytest.importorskip("mujoco")
    motion = generated("melson/obstacle").stages.motion
    assert failed(replay(motion, "mujoco")) == []
    (rod,) = motion.scene.boxes
    wall = Scene(boxes=(dataclasses.replace(rod, height=0.06),))
    assert failed(replay(dataclasses.replace(motion, scene=wall), "mujoco")) != []
