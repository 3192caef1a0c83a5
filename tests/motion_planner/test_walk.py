"""Footsteps and phases of walks against circles, mirror images and sums of durations."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.core.contact import Footstep, Side, Support
from mgs.core.errors import ConfigError, FootstepError, InfeasibleGaitError
from mgs.gait import Gait, load_gait
from mgs.motion_planner import WalkPlan, plan_motion
from mgs.motion_planner.footsteps import first_support_of, plan_footsteps
from mgs.pipeline import run_stages
from mgs.robot import Robot, load_robot, midpoint_width
from tests.support.strategies import numbers, walk_gait, walks

ROUNDING = 1e-12  # [m], [rad]; places are within a few metres
MELSON = load_robot("melson")  # Hypothesis and fixtures of a test do not mix well


def plan(**walk: object) -> WalkPlan:
    return plan_motion(MELSON, walk_gait(**walk))


def poses(footsteps: tuple[Footstep, ...]) -> np.ndarray:
    return np.array([[f.x, f.y, f.yaw] for f in footsteps])


def seen_from(first: Footstep, second: Footstep) -> tuple[float, float, float]:
    """Planar pose of the second footstep in the frame of the first."""
    offset = complex(second.x - first.x, second.y - first.y) * np.exp(-1j * first.yaw)
    return offset.real, offset.imag, second.yaw - first.yaw


# --- phases -----------------------------------------------------------------------------------


@given(walks())
def test_phases_tile_time(gait: Gait):
    plan = plan_motion(MELSON, gait)
    assert plan.phases[0].start == 0
    assert plan.phases[-1].end == plan.n_samples
    for before, after in itertools.pairwise(plan.phases):
        assert before.start < before.end == after.start


@given(walks())
def test_phases_last_as_long_as_asked_and_rounding_does_not_add_up(gait: Gait):
    plan, walk = plan_motion(MELSON, gait), gait.walk
    steps = [walk.double_support, walk.single_support] * walk.n_steps
    ends = np.cumsum([walk.lead_in, *steps, walk.double_support, walk.lead_out])
    # the last sample ends the last phase, which is why it is counted there
    found = np.array([phase.end for phase in plan.phases]) * gait.dt
    found[-1] -= gait.dt
    assert_allclose(found, ends, atol=0.5 * gait.dt + 1e-9)


@given(walks())
def test_the_feet_swing_in_turn_and_never_stand_and_swing_at_once(gait: Gait):
    plan = plan_motion(MELSON, gait)
    singles = [phase for phase in plan.phases if phase.support is not Support.DOUBLE]
    assert len(singles) == gait.walk.n_steps
    for before, after in itertools.pairwise(singles):
        assert {before.support, after.support} == {Support.LEFT, Support.RIGHT}
    for phase in singles:
        assert phase.target is not None
        assert plan.footsteps[phase.target].side is phase.support.sides[0].other
    assert [phase.target for phase in singles] == list(range(2, 2 + len(singles)))
    for phase in plan.phases:
        assert [plan.footsteps[foot].side for foot in phase.feet] == [Side.LEFT, Side.RIGHT]
        assert (phase.support is Support.DOUBLE) == (phase.target is None)


@given(walks())
def test_each_phase_begins_on_the_feet_that_the_last_one_ended_on(gait: Gait):
    plan = plan_motion(MELSON, gait)
    assert plan.phases[0].feet == (0, 1)
    for before, after in itertools.pairwise(plan.phases):
        ended_on = list(before.feet)
        if before.target is not None:
            ended_on[plan.footsteps[before.target].side] = before.target
        assert after.feet == tuple(ended_on)


def test_walk_5cm_takes_12_s_and_1201_samples(melson: Robot):
    plan = plan_motion(melson, load_gait("melson/walk_5cm"))
    assert (plan.n_samples, plan.dt) == (1201, 0.01)
    assert [phase.start for phase in plan.phases] == [0, 180, 300, 540, 660, 900, 1020]
    supports = [phase.support for phase in plan.phases if phase.support is not Support.DOUBLE]
    assert supports == [Support.LEFT, Support.RIGHT]


@pytest.mark.parametrize(
    ("key", "walk", "com"),
    [
        ("double_support", {"double_support": 0.04}, {}),
        ("single_support", {"single_support": 0.04}, {}),
        ("lead_in", {"lead_in": 0.1, "lead_out": 0.2}, {"preview": 0.1}),
        ("lead_out", {"lead_in": 0.2, "lead_out": 0.1}, {"preview": 0.1}),
    ],
)
def test_a_phase_of_too_few_samples_is_refused_by_name(key: str, walk: dict, com: dict):
    dt = 0.01 if not com else 0.05
    with pytest.raises(ConfigError, match=rf"walk\.{key}: .* fewer than 5 samples"):
        plan_motion(MELSON, walk_gait(dt=dt, com=com, **walk))


# --- footsteps --------------------------------------------------------------------------------


@given(walks())
def test_the_plan_starts_around_the_origin_and_ends_with_the_feet_abreast(gait: Gait):
    footsteps = plan_motion(MELSON, gait).footsteps
    width = gait.walk.step_width
    assert_allclose(poses(footsteps[:2]), [[0, width / 2, 0], [0, -width / 2, 0]], atol=ROUNDING)
    last, other = footsteps[-1], footsteps[-2] if len(footsteps) > 3 else footsteps[0]
    assert_allclose(seen_from(other, last), [0.0, last.side.sign * width, 0.0], atol=ROUNDING)


@given(walks())
def test_a_mirrored_gait_has_the_mirrored_plan(gait: Gait):
    side = Side[(gait.walk.first_support or "left").upper()]
    walk = gait.walk.model_dump() | {"first_support": side.label}
    mirrored = walk | {
        "first_support": side.other.label,
        "lateral": -walk["lateral"],
        "step_yaw": -walk["step_yaw"],
    }
    plan = plan_motion(MELSON, walk_gait(gait.dt, **walk))
    twin = plan_motion(MELSON, walk_gait(gait.dt, **mirrored))
    swapped = [plan.footsteps[1], plan.footsteps[0], *plan.footsteps[2:]]
    assert [f.side.other for f in swapped] == [f.side for f in twin.footsteps]
    assert_allclose(poses(tuple(swapped)) * [1, -1, -1], poses(twin.footsteps), atol=ROUNDING)
    for here, there in zip(plan.phases, twin.phases, strict=True):
        assert (here.start, here.end, here.target) == (there.start, there.end, there.target)
        if here.support is not Support.DOUBLE:
            assert here.support.sides[0].other is there.support.sides[0]


@given(walks())
def test_without_a_first_support_the_planner_treats_both_sides_alike(gait: Gait):
    """A turn or side step to the right is then the mirror image of one to the left."""
    walk = gait.walk.model_dump() | {"first_support": None}
    assume(walk["lateral"] or walk["step_yaw"])
    mirrored = walk | {"lateral": -walk["lateral"], "step_yaw": -walk["step_yaw"]}
    plan = plan_motion(MELSON, walk_gait(gait.dt, **walk))
    twin = plan_motion(MELSON, walk_gait(gait.dt, **mirrored))
    assert_allclose(
        poses(plan.footsteps[2:]) * [1, -1, -1], poses(twin.footsteps[2:]), atol=ROUNDING
    )


@pytest.mark.parametrize("first", ["left", "right"])
@pytest.mark.parametrize("length", [0.05, -0.03])
def test_a_straight_walk_advances_one_step_length_past_the_support_sole(first: str, length: float):
    footsteps = plan(n_steps=6, step_length=length, first_support=first, step_width=0.1).footsteps
    x, y, yaw = poses(footsteps).T
    assert_allclose(x, np.array([0, 0, 1, 2, 3, 4, 5, 5]) * length, atol=ROUNDING)
    assert_allclose(y, [0.05 * f.side.sign for f in footsteps], atol=ROUNDING)
    assert_allclose(yaw, 0.0, atol=ROUNDING)
    assert footsteps[2].side is Side[first.upper()].other


@given(numbers(-0.1, 0.1), numbers(-0.3, 0.3), st.sampled_from(list(Side)), st.integers(2, 12))
def test_footsteps_of_a_turning_walk_lie_on_two_circles(
    length: float, turn: float, first: Side, n: int
):
    """A chord L of an arc psi lies on a circle of radius R = L / (2 sin(psi / 2)) about (0, R)."""
    assume(abs(turn) > 1e-3)
    width = 0.1
    walk = walk_gait(n_steps=n, step_length=length, step_yaw=turn).walk
    footsteps = plan_footsteps(walk, width, first)
    radius = length / (2.0 * np.sin(0.5 * turn))
    for i, footstep in enumerate(footsteps):
        # the robot's centre has turned by one step_yaw a step, but for the closing one
        angle = turn * np.clip(i - 1, 0, n - 1)
        middle = 1j * radius * (1.0 - np.exp(1j * angle))
        own = middle + 0.5j * footstep.side.sign * width * np.exp(1j * angle)
        assert_allclose([footstep.x, footstep.y], [own.real, own.imag], atol=1e-11)
        assert footstep.yaw == pytest.approx(angle, abs=ROUNDING)
        distance = np.hypot(footstep.x, footstep.y - radius)
        assert distance == pytest.approx(abs(radius - 0.5 * footstep.side.sign * width), abs=1e-11)


@pytest.mark.parametrize("lateral", [0.03, -0.03])
def test_in_a_sideways_walk_the_leading_foot_steps_out_and_the_other_closes_up(lateral: float):
    footsteps = plan(n_steps=6, lateral=lateral, step_width=0.1).footsteps
    leading = Side.LEFT if lateral > 0.0 else Side.RIGHT
    assert footsteps[2].side is leading
    centres = [f.y - 0.05 * f.side.sign for f in footsteps]
    assert_allclose(centres, np.array([0, 0, 1, 1, 2, 2, 3, 3]) * lateral, atol=ROUNDING)
    for footstep in footsteps:
        assert footstep.x == footstep.yaw == 0.0


@given(walks())
def test_feet_never_cross(gait: Gait):
    """The foot that lands stays on its own side of the one that it lands beside."""
    footsteps = plan_motion(MELSON, gait).footsteps
    for before, after in itertools.pairwise(footsteps[2:]):
        assert seen_from(before, after)[1] * after.side.sign > 0.0


def test_without_a_step_width_or_height_those_of_the_posture_are_used():
    found = plan()
    assert found.footsteps[0].y - found.footsteps[1].y == pytest.approx(0.0955)  # hip to hip
    assert found.com_height == pytest.approx(0.2668, abs=5e-5)  # the robot's README
    assert plan(com_height=0.27).com_height == 0.27


def plan_footsteps_of(walk: dict) -> tuple[Footstep, ...]:
    block = walk_gait(**walk).walk
    width = block.step_width or midpoint_width(MELSON)
    return plan_footsteps(block, width, first_support_of(block))


# --- refusals ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("walk", "pair"),
    [
        ({"step_width": 0.05}, (0, 1)),  # two soles of 60 mm side by side
        ({"step_yaw": 0.9, "n_steps": 2, "first_support": "left"}, (0, 2)),
        ({"step_yaw": 0.9, "n_steps": 2, "first_support": "right"}, (1, 2)),
        ({"step_yaw": 0.7, "n_steps": 5, "lateral": 0.05, "first_support": "right"}, (2, 3)),
    ],
)
def test_overlapping_soles_are_refused_with_the_pair_and_the_keys_that_help(
    walk: dict, pair: tuple[int, int]
):
    with pytest.raises(FootstepError) as caught:
        run_stages(MELSON, walk_gait(**walk))
    error = caught.value
    assert isinstance(error, InfeasibleGaitError)
    assert (error.first, error.second) == pair
    assert error.gap < 0.0
    assert f"footsteps {pair[0]} and {pair[1]} overlap by {-1e3 * error.gap:.1f} mm" in str(error)
    first, second = (plan_footsteps_of(walk)[number] for number in pair)
    assert error.distance == pytest.approx(math.hypot(first.x - second.x, first.y - second.y))
    assert "step_width" in str(error)
    assert ("step_yaw" in str(error)) == ("step_yaw" in walk)


def test_soles_that_almost_touch_are_accepted():
    with pytest.raises(FootstepError, match=r"overlap by 0\.1 mm"):
        plan(step_width=0.0599)
    assert plan(step_width=0.0601).footsteps


@pytest.mark.parametrize("offset", [[0.053, 0.0], [-0.06, 0.0], [0.0, 0.03], [0.0, -1.0]])
def test_a_zmp_beside_the_sole_is_refused(offset: list[float]):
    with pytest.raises(ConfigError, match=r"walk\.zmp_offset: .* outside the sole"):
        plan(zmp_offset=offset)


@given(walks())
def test_planning_twice_gives_the_same_plan(gait: Gait):
    assert plan_motion(MELSON, gait).footsteps == plan_motion(MELSON, gait).footsteps
    assert plan_motion(MELSON, gait).phases == plan_motion(MELSON, gait).phases
