"""Kicks: place, time, speed and direction of the contact with the ball, and refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError, InfeasibleGaitError
from mgs.core.geometry import yaw_from_quat_xyzw
from mgs.gait import KickGait
from mgs.motion_planner import WalkPlan, plan_motion
from mgs.pipeline import run_stages
from mgs.robot import load_robot
from mgs.trajectory_planner import plan_trajectories

MELSON = load_robot("melson")
SOLE = MELSON.sole_spec(Side.RIGHT)


def kick_gait(dt: float = 0.01, **kick: Any) -> KickGait:
    return KickGait.model_validate({"mgs": 1, "motion": "kick", "dt": dt, "kick": kick})


def plan(**kick: Any) -> WalkPlan:
    return plan_motion(MELSON, kick_gait(**kick))


kicks = st.fixed_dictionaries(
    {
        "foot": st.sampled_from(["left", "right"]),
        "direction": st.floats(-0.4, 0.4),
        "speed": st.floats(0.2, 1.0),
    }
)


@given(kicks, st.floats(0.1, 0.16), st.floats(-0.01, 0.02))
def test_the_front_edge_touches_the_ball_at_the_speed_and_in_the_direction_asked(
    kick: dict[str, Any], x: float, aside: float
):
    """Oracle: distance of the ball's centre from the front face of a thin sole."""
    side = Side[kick["foot"].upper()]
    y = side.sign * (0.5 * 0.0955 + aside)
    gait = kick_gait(dt=1e-3, **kick, ball={"x": x, "y": y})
    try:
        found = plan_motion(MELSON, gait)
    except InfeasibleGaitError:  # a leg or the ball in the way
        assume(False)
    ball = found.scene.balls[0]
    assert (ball.x, ball.y, ball.direction) == (x, y, kick["direction"])
    tasks = plan_trajectories(found)
    k = round(ball.time / gait.dt)
    pose = tasks.soles[k, side]
    ahead = np.array([np.cos(kick["direction"]), np.sin(kick["direction"])])
    assert float(yaw_from_quat_xyzw(pose[3:])) == pytest.approx(kick["direction"], abs=1e-3)
    to_ball = np.array([x, y]) - pose[:2]
    edge = float(to_ball @ ahead) - 0.5 * SOLE.length
    across = float(to_ball @ [-ahead[1], ahead[0]])
    assert np.hypot(edge, ball.radius - pose[2]) == pytest.approx(ball.radius, abs=1e-3)
    assert abs(across) < 1e-9
    velocity = (tasks.soles[k + 1, side, :2] - tasks.soles[k - 1, side, :2]) / (2 * gait.dt)
    assert_allclose(velocity, kick["speed"] * ahead, atol=0.02)


@given(kicks)
def test_the_foot_comes_back_to_where_it_stood_and_the_other_never_moves(kick: dict[str, Any]):
    found = plan(**kick)
    side = Side[kick["foot"].upper()]
    tasks = plan_trajectories(found)
    assert_allclose(tasks.soles[-1], tasks.soles[0], atol=1e-12)
    assert np.ptp(tasks.soles[:, side.other], axis=0).max() == 0.0
    for phase in found.phases:
        if phase.support is Support.DOUBLE:
            span = tasks.soles[phase.start : phase.end, side]
            assert_allclose(span, np.broadcast_to(tasks.soles[0, side], span.shape), atol=1e-12)
    assert tasks.soles[..., 2].min() >= -1e-12


@given(kicks)
def test_the_mirrored_kick_has_the_mirrored_plan(kick: dict[str, Any]):
    other = Side[kick["foot"].upper()].other
    mirrored = {**kick, "foot": other.label, "direction": -kick["direction"]}
    here, there = (plan_trajectories(plan(**k)) for k in (kick, mirrored))
    mirror = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0])  # pose: y and the x, z of the quat
    assert_allclose(there.soles, here.soles[:, ::-1] * mirror, atol=1e-12)
    assert_allclose(there.zmp_ref, here.zmp_ref * [1.0, -1.0], atol=1e-12)


def test_the_foot_gathers_speed_steadily_until_the_contact():
    tasks = plan_trajectories(plan(speed=0.6))
    x = tasks.soles[:, Side.RIGHT, 0]
    speed = np.diff(x) / 0.01
    k = int(np.argmax(speed))
    begin = int(np.argmin(x))
    assert speed[k] == pytest.approx(0.6, abs=0.01)
    assert np.all(np.diff(speed[begin:k]) > 0.0)


@pytest.mark.parametrize(
    ("kick", "message"),
    [
        ({"ball": {"x": 0.06}}, r"touches the right sole; move it at least 26 mm away"),
        ({"ball": {"x": -0.12}}, r"too near: .* move it at least"),
        ({"ball": {"x": 0.15, "y": 0.02}}, r"would strike the other leg, by .*farther outward"),
    ],
)
def test_a_ball_that_the_foot_cannot_strike_is_refused_with_the_remedy(
    kick: dict[str, Any], message: str
):
    with pytest.raises(InfeasibleGaitError, match=message):
        plan(**kick)


def test_a_foot_above_the_ball_is_refused_by_name():
    with pytest.raises(
        ConfigError, match=r"kick\.height: 0\.08 m is above the ball, which is 0\.065 m"
    ):
        plan(height=0.08)


def test_a_speed_that_a_servo_cannot_reach_is_refused_with_joint_and_remedy():
    with pytest.raises(InfeasibleGaitError, match=r"would have to move at .* lower kick\.speed"):
        run_stages(MELSON, kick_gait(speed=2.0))


def test_a_ball_out_of_reach_is_refused():
    with pytest.raises(InfeasibleGaitError, match=r"a nearer ball"):
        run_stages(MELSON, kick_gait(ball={"x": 0.25}))
