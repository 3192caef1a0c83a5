"""Steps and footsteps that a gait file gives one by one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.core.contact import Footstep, Side, Support
from mgs.core.errors import ConfigError, InfeasibleGaitError
from mgs.motion_planner import WalkPlan, plan_motion
from mgs.robot import load_robot
from tests.support.strategies import numbers, walk_gait

MELSON = load_robot("melson")
ROUNDING = 1e-12  # [m], [rad]
step = st.fixed_dictionaries(
    {
        "step_length": numbers(-0.03, 0.05),
        "lateral": numbers(-0.02, 0.02),
        "step_yaw": numbers(-0.1, 0.1),
    }
)
steps_lists = st.lists(step, min_size=1, max_size=8)
sides = st.sampled_from(["left", "right"])


def plan(**walk: Any) -> WalkPlan:
    return plan_motion(MELSON, walk_gait(**{"n_steps": None, **walk}))


def poses(footsteps: tuple[Footstep, ...]) -> np.ndarray:
    return np.array([[f.x, f.y, f.yaw] for f in footsteps])


@given(steps_lists, sides)
def test_each_step_advances_by_its_own_length_sideways_way_and_turn(
    steps: list[dict[str, float]], first: str
):
    """Oracle: complex numbers, step by step; the trailing foot of a side step only closes up."""
    found = plan(steps=steps, first_support=first, step_width=0.11).footsteps
    assert len(found) == 2 + len(steps) + 1
    place, turn, side = 0j, 0.0, Side[first.upper()].other
    for asked, footstep in zip(steps, found[2:], strict=False):
        aside = asked["lateral"] if asked["lateral"] * side.sign > 0.0 else 0.0
        place += complex(asked["step_length"], aside) * np.exp(1j * (turn + asked["step_yaw"] / 2))
        turn += asked["step_yaw"]
        sole = place + 0.055j * side.sign * np.exp(1j * turn)
        assert footstep.side is side
        assert_allclose(
            [footstep.x, footstep.y, footstep.yaw], [sole.real, sole.imag, turn], atol=ROUNDING
        )
        side = side.other
    closing = place + 0.055j * side.sign * np.exp(1j * turn)
    assert_allclose(poses(found)[-1], [closing.real, closing.imag, turn], atol=ROUNDING)


@given(steps_lists, sides)
def test_mirrored_steps_have_the_mirrored_plan(steps: list[dict[str, float]], first: str):
    mirrored = [s | {"lateral": -s["lateral"], "step_yaw": -s["step_yaw"]} for s in steps]
    here = plan(steps=steps, first_support=first, step_width=0.11).footsteps
    other = Side[first.upper()].other.label
    there = plan(steps=mirrored, first_support=other, step_width=0.11).footsteps
    assert_allclose(poses(there[2:]), poses(here[2:]) * [1, -1, -1], atol=ROUNDING)


def test_a_step_takes_missing_values_from_the_walk():
    found = plan(steps=[{}, {"step_length": 0.02}, {"step_yaw": 0.1}], step_length=0.04)
    equal = plan(
        steps=[
            {"step_length": 0.04},
            {"step_length": 0.02},
            {"step_length": 0.04, "step_yaw": 0.1},
        ]
    )
    assert found.footsteps == equal.footsteps


def test_a_list_of_equal_steps_gives_the_footsteps_of_n_steps():
    walk = {"step_length": 0.04, "lateral": 0.01, "step_yaw": 0.05}
    assert plan(n_steps=5, **walk).footsteps == plan(steps=[walk] * 4).footsteps


@pytest.mark.parametrize("n", [1, 2, 3, 4])
@pytest.mark.parametrize("last", ["left", "right"])
def test_the_last_support_is_the_one_asked_for(n: int, last: str):
    found = plan(n_steps=n, last_support=last)
    singles = [phase for phase in found.phases if phase.support is not Support.DOUBLE]
    assert singles[-1].support.label == last
    assert len(singles) in (n, n + 1)


@given(st.lists(sides, min_size=1, max_size=6))
def test_footsteps_are_taken_as_given_in_any_order_of_the_feet(order: list[str]):
    given_steps = [
        {"side": side, "x": 0.01 * i, "y": 0.055 * Side[side.upper()].sign, "yaw": 0.01 * i}
        for i, side in enumerate(order, start=1)
    ]
    found = plan(footsteps=given_steps, step_width=0.11)
    for asked, footstep in zip(given_steps, found.footsteps[2:], strict=True):
        assert footstep.side.label == asked["side"]
        assert [footstep.x, footstep.y, footstep.yaw] == [asked[k] for k in ("x", "y", "yaw")]
    singles = [phase for phase in found.phases if phase.target is not None]
    assert [phase.support.sides[0].other.label for phase in singles] == order
    feet = [0, 1]
    for phase in singles:
        assert list(phase.feet) == feet
        feet[found.footsteps[phase.target].side] = phase.target


@pytest.mark.parametrize(
    ("walk", "message"),
    [
        ({"first_support": "left"}, r"walk\.first_support: left, but the first of walk\.footsteps"),
        ({"last_support": "left"}, r"walk\.last_support: left, but the last of walk\.footsteps"),
    ],
)
def test_footsteps_that_contradict_other_keys_are_refused(walk: dict, message: str):
    with pytest.raises(ConfigError, match=message):
        plan(footsteps=[{"side": "left", "x": 0.02, "y": 0.048}], **walk)


@pytest.mark.parametrize(
    "walk",
    [{}, {"n_steps": 2, "goal": {"x": 0.1}}, {"steps": [{}], "footsteps": []}],
    ids=["none", "two", "an empty list"],
)
def test_a_walk_gives_its_way_by_exactly_one_key(walk: dict):
    with pytest.raises(ValueError, match=r"exactly one of n_steps|at least 1 item"):
        plan(**walk)


def test_a_foot_that_would_swing_through_the_other_leg_is_refused():
    footsteps = [{"side": "left", "x": 0.0, "y": -0.15}]
    with pytest.raises(InfeasibleGaitError, match=r"footstep 2 the left foot would strike the oth"):
        plan(footsteps=footsteps)


def test_a_zmp_that_travels_out_of_the_sole_is_refused():
    with pytest.raises(ConfigError, match=r"walk\.zmp_travel: 0\.09 m leads out .* for 0\.086"):
        plan(n_steps=2, zmp_travel=0.09, zmp_offset=[0.01, 0.0])
