"""Walks by their velocity: steps against the planner's footsteps, and sweeps over velocities."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.gait import WalkGait, parse_gait
from mgs.library.points import plan_sweep
from mgs.library.velocity import steps_of, velocity_of
from mgs.motion_planner.footsteps import first_support_of, plan_footsteps
from tests.library.test_points import plan_of, sweep_of
from tests.support.strategies import walk_gait

WIDTH = 0.1  # [m]


def walk_of(length: float, lateral: float, yaw: float, n_steps: int = 9) -> WalkGait:
    gait = walk_gait(step_length=length, lateral=lateral, step_yaw=yaw, n_steps=n_steps)
    assert isinstance(gait, WalkGait)
    return gait


def centres(gait: WalkGait) -> list[np.ndarray]:
    """Poses (3, 3) of the centre between the feet after each step, from the planned footsteps."""
    walk = gait.walk
    found = []
    for step in plan_footsteps(walk, WIDTH, first_support_of(walk))[2:]:
        c, s = np.cos(step.yaw), np.sin(step.yaw)
        aside = -step.side.sign * 0.5 * WIDTH
        found.append(np.array([[c, -s, step.x - s * aside], [s, c, step.y + c * aside], [0, 0, 1]]))
    return found


@given(
    vx=st.floats(-0.2, 0.3),
    vy=st.floats(-0.1, 0.1),
    wz=st.floats(-0.6, 0.6),
)
def test_the_footsteps_of_a_velocity_are_where_it_leads(vx: float, vy: float, wz: float):
    """Two steps, four steps: the matrix exponential of the constant velocity over their time."""
    period = 0.5 + 0.2  # the defaults of a gait file
    length, lateral, yaw = steps_of(np.array([vx, vy, wz]), period)
    gait = walk_of(length, lateral, yaw)
    assert gait.walk.single_support + gait.walk.double_support == period
    found = centres(gait)
    velocity = np.array([[0.0, -wz, vx], [wz, 0.0, vy], [0.0, 0.0, 0.0]])
    for steps in (2, 4, 6):
        assert np.allclose(found[steps - 1], expm(steps * period * velocity), rtol=0, atol=1e-9)
    assert velocity_of(gait.walk) == pytest.approx((vx, vy, wz), abs=1e-10)


@pytest.mark.parametrize(
    ("velocity", "steps"),
    [
        ((0.1, 0.0, 0.0), (0.08, 0.0, 0.0)),
        ((0.0, 0.05, 0.0), (0.0, 0.08, 0.0)),  # the leading foot alone steps aside
        ((0.0, 0.0, 0.5), (0.0, 0.0, 0.4)),
    ],
)
def test_plain_velocities_have_plain_steps(velocity: tuple[float, ...], steps: tuple[float, ...]):
    assert steps_of(np.array(velocity), 0.8) == pytest.approx(steps, abs=1e-12)


def test_a_sweep_over_velocities_is_one_over_steps(tmp_path: Path):
    axes = {"vx": [0.0, 0.05], "wz": [-0.1, 0.1], "walk.single_support": [0.5, 0.6]}
    plan = plan_of(tmp_path, axes=axes)
    assert plan.keys == (
        *("walk.single_support", "walk.step_length", "walk.lateral", "walk.step_yaw"),
    )
    assert len(plan.points) == 8
    found = set()
    for number in range(8):
        gait = parse_gait(plan.base_text, plan.base, plan.assignments(number))
        assert isinstance(gait, WalkGait)
        vx, vy, wz = velocity_of(gait.walk)
        assert vy == pytest.approx(0.0, abs=1e-12)
        found.add((round(vx, 9), round(wz, 9), gait.walk.single_support))
    assert found == {(vx, wz, t) for vx in (0.0, 0.05) for wz in (-0.1, 0.1) for t in (0.5, 0.6)}


def test_filters_and_random_draws_take_velocities(tmp_path: Path):
    plan = plan_of(
        tmp_path, axes={"vx": [0.0, 0.05, 0.1]}, filters=["vx > 0.01 and walk.n_steps > 1"]
    )
    assert len(plan.points) == 2
    drawn = plan_of(
        tmp_path,
        sampling="sobol",
        samples=8,
        axes={"vx": {"uniform": [0.0, 0.05]}, "vy": {"uniform": [-0.02, 0.02]}},
    )
    assert len(set(drawn.points)) == 8


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"axes": {"vx": [0.1], "walk.step_length": [0.1]}}, "walk.step_length: the velocity"),
        ({"axes": {"vx": ["fast"]}}, "axes.vx: 'fast' is not a number"),
        ({"axes": {"vx": [True]}}, "axes.vx: True is not a number"),
        ({"axes": {"vx": [0.1]}, "base": "melson/bow"}, "axes.vx: velocities need a base gait"),
        ({"axes": {"vx": [0.1]}, "base": "melson/walk_to_pose"}, "axes.vx: velocities need"),
        ({"axes": {"wx": [0.1]}}, "axes.wx: gaits of the kind walk have no such key"),
    ],
)
def test_velocities_that_no_steps_have_are_refused(
    content: dict[str, object], message: str, tmp_path: Path
):
    with pytest.raises(ConfigError) as refused:
        plan_sweep(sweep_of(tmp_path, **content))
    assert message in str(refused.value)


def test_the_first_step_aside_is_that_of_the_leading_foot():
    for lateral, side in ((0.05, Side.LEFT), (-0.05, Side.RIGHT)):
        gait = walk_of(0.0, lateral, 0.0)
        first = plan_footsteps(gait.walk, WIDTH, first_support_of(gait.walk))[2]
        assert first.side is side
