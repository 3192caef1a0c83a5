"""Tests of the search space: bounds, start values, pinned and freed keys, speed that is kept."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.com_generator.qp import default_margin
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.gait import WalkGait, load_gait
from mgs.gait.walk import FootRollParameters
from mgs.robot import leg_length, load_robot, midpoint_width
from mgs.search.tune.objective import LEAST_CLEARANCE, OBJECTIVES
from mgs.search.tune.space import (
    Parameter,
    Space,
    make_space,
    steady_speed,
    step_duration,
    value_at,
)

MELSON = load_robot("melson")
WALK = load_gait("melson/walk_practical")
assert isinstance(WALK, WalkGait)


def space(objective: str = "robust", **options: object) -> Space:
    return make_space(MELSON, WALK, objective, **options)  # type: ignore[arg-type]


@given(st.floats(0.01, 10.0), st.floats(1.1, 1e6), st.booleans(), st.floats(0.0, 1.0))
def test_a_place_between_the_bounds_and_its_value_are_inverse(
    low: float, ratio: float, log: bool, place: float
):
    parameter = Parameter("any", low, ratio * low, log)
    assert_allclose(parameter.place(parameter.at(place)), place, atol=1e-6)
    assert parameter.at(-1.0) == pytest.approx(low)
    assert parameter.at(2.0) == pytest.approx(ratio * low)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_search_begins_with_the_start_gait(objective: str):
    """Its own values, and for null what the robot itself has."""
    found = space(objective)
    start = found.start()
    for parameter in found.parameters:
        value = value_at(WALK, parameter.key)
        if parameter.choices:
            assert start[parameter.key] == value
            continue
        assert parameter.low <= start[parameter.key] <= parameter.high
        if value is not None:
            assert start[parameter.key] == value
    assert start["walk.step_width"] == pytest.approx(midpoint_width(MELSON))
    same = found.gait_of(start)
    assert same.walk.foot_roll == FootRollParameters()  # level soles
    assert same.walk.leg_stretch > 1.0  # the CoM keeps its height
    own = dict.fromkeys(("com_height", "step_width", "foot_roll", "leg_stretch"))
    assert same.walk.model_copy(update=own) == WALK.walk
    assert same.com == WALK.com


@given(st.data())
def test_every_walk_of_the_search_keeps_the_speed(data: st.DataObject):
    found = space(speed=0.05)
    values = {p.key: data.draw(st.floats(p.low, p.high)) for p in found.parameters if not p.choices}
    gait = found.gait_of(values)
    assert steady_speed(gait) == pytest.approx(0.05, rel=1e-3)
    samples = step_duration(gait) / gait.dt
    assert samples == pytest.approx(round(samples), abs=1e-6)


def test_step_sizes_are_free_only_where_speed_is_sought():
    keys = {p.key: p for p in space("speed").parameters}
    assert keys["walk.step_length"].high == pytest.approx(leg_length(MELSON))
    assert "walk.step_length" not in {p.key for p in space("energy").parameters}
    assert space("speed").speed is None
    assert space("energy").speed == pytest.approx(0.05 / 0.8)


def test_a_margin_that_the_gait_leaves_out_begins_at_that_of_the_planner():
    com = WALK.com.model_copy(update={"margin": None})
    found = make_space(MELSON, WALK.model_copy(update={"com": com}), "speed")
    assert found.start()["com.margin"] == default_margin(MELSON) > 0.0


def test_steps_may_be_as_narrow_as_the_soles_allow():
    bounds = {p.key: p for p in space().parameters}["walk.step_width"]
    assert MELSON.sole_spec(Side.LEFT).width < bounds.low < 0.9 * midpoint_width(MELSON)


def test_arms_swing_only_in_walks_that_hold_their_hands():
    keys = {p.key: p for p in space().parameters}
    assert keys["walk.arm_swing"].high == 2.0
    free = WALK.walk.model_copy(update={"hands": "free", "arm_swing": 0.0})
    found = make_space(MELSON, WALK.model_copy(update={"walk": free}), "robust")
    assert "walk.arm_swing" not in {p.key for p in found.parameters}


def test_bounds_grow_with_the_robot():
    coman = load_robot("coman")
    walk = load_gait("coman/walk")
    assert isinstance(walk, WalkGait)
    ratio = leg_length(coman) / leg_length(MELSON)
    small = {p.key: p for p in space().parameters}
    large = {p.key: p for p in make_space(coman, walk, "robust").parameters}
    key = "walk.step_height"
    assert large[key].high / small[key].high == pytest.approx(ratio)
    assert small[key].low > LEAST_CLEARANCE * leg_length(MELSON)
    key = "walk.single_support"
    assert large[key].low / small[key].low == pytest.approx(math.sqrt(ratio))


def test_bounds_reach_the_start_gait_but_for_the_least_clearance():
    usual = {p.key: p for p in space("speed").parameters}
    beyond = {"single_support": 2.4, "landing": 0.5, "step_length": 0.01, "step_height": 0.005}
    walk = WALK.walk.model_copy(update=beyond)
    ik = WALK.ik.model_copy(update={"gamma_joint": 0.0})
    gait = WALK.model_copy(update={"walk": walk, "ik": ik})
    found = make_space(MELSON, gait, "speed")
    start, bounds = found.start(), {p.key: p for p in found.parameters}
    assert bounds["walk.single_support"].high == start["walk.single_support"] == 2.4
    assert bounds["walk.landing"].high == start["walk.landing"] == 0.5
    assert bounds["walk.step_length"].low == start["walk.step_length"] == 0.01
    assert bounds["walk.step_height"] == usual["walk.step_height"]
    assert start["walk.step_height"] == usual["walk.step_height"].low
    assert bounds["ik.gamma_joint"] == usual["ik.gamma_joint"]  # 0 has no logarithm


def test_a_pinned_key_keeps_its_value_and_a_freed_one_its_bounds():
    found = space(
        pins=["walk.landing=0.25", "walk.zmp_offset=[0.001, 0.002]"],
        frees=["walk.step_height=0.013:0.03", "ik.torso=free,upright", "com.passes=1:4"],
    )
    keys = {p.key: p for p in found.parameters}
    assert not {"walk.landing", "walk.zmp_offset.0", "walk.zmp_offset.1"} & set(keys)
    assert found.gait.walk.landing == 0.25
    assert found.gait.walk.zmp_offset == [0.001, 0.002]
    one = space(pins=["walk.zmp_offset.0=0.003"])
    assert one.gait.walk.zmp_offset[0] == 0.003
    assert {p.key for p in one.parameters if "offset" in p.key} == {"walk.zmp_offset.1"}
    assert (keys["walk.step_height"].low, keys["walk.step_height"].high) == (0.013, 0.03)
    assert keys["ik.torso"].choices == ("free", "upright")
    height = next(p.own for p in space().parameters if p.key == "walk.com_height")
    assert height is not None
    low = space(frees=[f"walk.com_height={0.9 * height}:{1.1 * height}"])
    assert low.start()["walk.com_height"] == height  # the gait file says null
    values = found.start() | {"ik.torso": "upright", "com.passes": 2.4}
    gait = found.gait_of(values)
    assert (gait.ik.torso, gait.com.passes) == ("upright", 2)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"pins": ["walk.landing"]}, "key.sub=value"),
        ({"pins": ["walk.nothing=1"]}, "no such key"),
        ({"pins": ["walk.landing=2"]}, "walk.landing"),
        ({"frees": ["walk.nothing=0:1"]}, "no such key"),
        ({"frees": ["walk.landing=0.3:0.1"]}, "below the upper one"),
        ({"frees": ["walk.landing=a:b"]}, "two numbers"),
        ({"frees": ["walk.landing=0.1:nan"]}, "below the upper one"),
        ({"frees": ["walk.landing=0.1:0.9"]}, "0.5"),
        ({"frees": ["walk.landing=0.1"]}, "key=low:high"),
        ({"frees": ["ik.torso=free,sideways"]}, "sideways"),
    ],
)
def test_a_malformed_change_of_the_space_is_refused(options: dict[str, list[str]], words: str):
    with pytest.raises(ConfigError, match=words):
        space(**options)


def test_a_speed_to_keep_needs_steps_and_an_objective_other_than_speed():
    with pytest.raises(ConfigError, match="--speed"):
        space("speed", speed=0.1)
    with pytest.raises(ConfigError, match="--speed"):
        still = WALK.model_copy(update={"walk": WALK.walk.model_copy(update={"step_length": 0.0})})
        make_space(MELSON, still, "robust", speed=0.1)
