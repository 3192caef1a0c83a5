"""References of soles, ZMP and hands in a walk: rest, smoothness, support polygon, symmetry."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial import ConvexHull

from mgs.core.contact import Footstep, Side, Support
from mgs.gait import Gait
from mgs.motion_planner import Phase, WalkPlan, plan_motion
from mgs.pipeline import Stages
from mgs.robot import load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories
from tests.support.strategies import walk_gait, walks

MELSON = load_robot("melson")
LENGTH, WIDTH = 0.106, 0.06  # [m] of a sole
FINE = {"n_steps": 4, "step_length": 0.05, "step_yaw": 0.1, "dt": 0.001}


def tasks_of(gait: Gait) -> tuple[WalkPlan, TaskTrajectory]:
    plan = plan_motion(MELSON, gait)
    return plan, plan_trajectories(plan)


def swings(plan: WalkPlan) -> list[tuple[Phase, Side]]:
    return [(p, p.support.sides[0].other) for p in plan.phases if p.target is not None]


def yaw(quat: np.ndarray) -> np.ndarray:
    return 2.0 * np.arctan2(quat[..., 2], quat[..., 3])


# --- soles ------------------------------------------------------------------------------------


@given(walks())
def test_a_sole_in_support_never_moves(gait: Gait):
    plan, tasks = tasks_of(gait)
    for phase in plan.phases:
        for side in phase.support.sides:
            span = tasks.soles[phase.start : phase.end, side]
            assert np.all(span == span[0])
            footstep = plan.footsteps[phase.feet[side]]
            assert_allclose(span[0, :3], [footstep.x, footstep.y, 0.0], rtol=0)
            assert np.exp(1j * yaw(span[0, 3:])) == pytest.approx(np.exp(1j * footstep.yaw))


@given(walks())
def test_the_sole_that_the_ik_starts_from_is_in_contact(gait: Gait):
    _, tasks = tasks_of(gait)
    for support, root in zip(tasks.support, tasks.root, strict=True):
        assert Side(root) in Support(int(support)).sides


@given(walks())
def test_the_ik_changes_its_sole_only_when_both_are_down(gait: Gait):
    _, tasks = tasks_of(gait)
    changes = np.flatnonzero(np.diff(tasks.root))
    assert np.all(tasks.support[changes] != tasks.support[changes + 1])  # at the edge of a phase
    assert np.all(tasks.support[changes + 1] == Support.DOUBLE)
    assert len(changes) == gait.walk.n_steps - 1  # once between any two steps


@pytest.mark.parametrize("profile", ["minimum_jerk", "cruise"])
@pytest.mark.parametrize("landing", [0.0, 0.3])
@pytest.mark.parametrize("coordinate", ["x", "y", "z", "yaw"])
def test_a_swing_sole_lifts_off_and_lands_without_speed_or_acceleration(
    coordinate: str, landing: float, profile: str
):
    """Differences over h of a motion with jerk j: at most j h^2 in speed, j h in acceleration."""
    plan, tasks = tasks_of(
        walk_gait(**FINE, lateral=0.02, step_width=0.12, landing=landing, swing_profile=profile)
    )
    h, duration = plan.dt, 0.5
    planar = np.concatenate([tasks.soles[..., :3], yaw(tasks.soles[..., 3:])[..., None]], axis=-1)
    path = planar[..., ["x", "y", "z", "yaw"].index(coordinate)]
    size = {"x": 0.1, "y": 0.1, "z": plan.step_height, "yaw": 0.2}[coordinate]  # two steps
    jerk = 400.0 * size / duration**3  # 60 (quintic) and 384 (bump) at the ends
    jerk /= (1.0 - landing) ** 3
    for phase, side in swings(plan):
        for k in (phase.start, phase.end):
            v = (path[k + 1, side] - path[k - 1, side]) / (2.0 * h)
            a = (path[k + 1, side] - 2.0 * path[k, side] + path[k - 1, side]) / h**2
            assert abs(v) < jerk * h**2
            assert abs(a) < jerk * h


@given(walks())
def test_a_swing_sole_lands_on_its_footstep_and_clears_the_ground_by_the_step_height(gait: Gait):
    plan, tasks = tasks_of(gait)
    for phase, side in swings(plan):
        footstep = plan.footsteps[phase.target]
        landed = tasks.soles[phase.end, side]
        assert_allclose(landed[:3], [footstep.x, footstep.y, 0.0], atol=1e-12)
        height = tasks.soles[phase.start : phase.end, side, 2]
        assert height.min() == height[0] == 0.0
        assert height.max() <= plan.step_height * (1.0 + 1e-12)
        # the top is flat: half a sample beside it costs 3 / n^2 of the height, or with a landing
        # 10 / m^3 of m samples above it
        above = (1.0 - plan.landing) * len(height)
        assert height.max() >= plan.step_height * (1.0 - 4.0 / above**2 - 10.0 / above**3)


@given(walks())
def test_a_sole_with_a_landing_comes_straight_and_slowly_down(gait: Gait):
    plan, tasks = tasks_of(gait)
    for phase, side in swings(plan):
        n = phase.end - phase.start
        last = slice(phase.start + math.ceil((1.0 - plan.landing) * n), phase.end + 1)
        sole = tasks.soles[last, side]
        assert_allclose(sole[:, :2], np.tile(sole[-1:, :2], (len(sole), 1)), atol=1e-15)
        assert_allclose(np.abs(sole[:, 3:] @ sole[-1, 3:]), 1.0, atol=1e-15)
        assert np.all(sole[:, 2] <= plan.step_height * plan.landing / 3.0 * (1.0 + 1e-9))
        # the fastest that a minimum-jerk blend gets is 15/8 of its mean
        assert np.all(np.diff(sole[:, 2]) * n >= -plan.step_height / 3.0 * 15.0 / 8.0 * 1.001)
        assert np.all(np.diff(sole[:, 2]) <= 1e-15)


@given(walks())
def test_soles_stay_level_and_their_quaternions_have_length_one(gait: Gait):
    _, tasks = tasks_of(gait)
    assert np.all(tasks.soles[..., 3:5] == 0.0)
    assert_allclose(np.linalg.norm(tasks.soles[..., 3:], axis=-1), 1.0, atol=1e-15)
    assert np.all(tasks.soles[..., 2] >= 0.0)


# --- ZMP --------------------------------------------------------------------------------------


def corners(pose: np.ndarray) -> np.ndarray:
    """Corners (4, 2) of a level sole at x, y, z, quaternion."""
    turn = np.exp(1j * yaw(pose[3:]))
    points = [
        complex(*pose[:2]) + turn * complex(0.5 * sx * LENGTH, 0.5 * sy * WIDTH)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    return np.array([[p.real, p.imag] for p in points])


def margin(point: np.ndarray, soles: np.ndarray) -> float:
    planes = ConvexHull(np.concatenate([corners(pose) for pose in soles])).equations
    return float(-(planes[:, :2] @ point + planes[:, 2]).max())


@settings(max_examples=15)
@given(walks())
def test_the_zmp_reference_stays_inside_the_support_polygon(gait: Gait):
    """Its margin is that of zmp_offset, in single and in double support."""
    _, tasks = tasks_of(gait)
    forward, inward = np.abs(gait.walk.zmp_offset)
    least = min(0.5 * LENGTH - forward, 0.5 * WIDTH - inward)
    for k in range(0, tasks.n_samples, 7):
        sides = list(Support(int(tasks.support[k])).sides)
        assert margin(tasks.zmp_ref[k], tasks.soles[k, sides]) >= least - 1e-9


def test_at_every_sample_of_shipped_walks_the_zmp_reference_is_inside(shipped_walk):
    tasks, walk = shipped_walk.stages.tasks, shipped_walk.gait.walk
    along, across = 0.5 * walk.zmp_travel, abs(walk.zmp_offset[1])
    least = min(0.02, 0.5 * LENGTH - along - 1e-3, 0.5 * WIDTH - across - 1e-3)
    for k in range(tasks.n_samples):
        sides = list(Support(int(tasks.support[k])).sides)
        assert margin(tasks.zmp_ref[k], tasks.soles[k, sides]) > least  # [m], soles are 60 mm wide


@given(walks())
def test_in_single_support_the_zmp_reference_rests_at_its_place_in_the_sole(gait: Gait):
    plan, tasks = tasks_of(gait)
    forward, inward = gait.walk.zmp_offset
    for phase, swing in swings(plan):
        foot = plan.footsteps[phase.feet[swing.other]]
        local = complex(forward, -foot.side.sign * inward) * np.exp(1j * foot.yaw)
        span = tasks.zmp_ref[phase.start : phase.end]
        assert_allclose(span, np.tile([foot.x + local.real, foot.y + local.imag], (len(span), 1)))


def test_the_zmp_reference_is_smooth():
    """The speed of a quintic blend over a way d in a time T is at most 1.875 d / T."""
    plan, tasks = tasks_of(walk_gait(**FINE))
    step = np.linalg.norm(np.diff(tasks.zmp_ref, axis=0), axis=1)
    widest = 0.12  # [m] from sole to sole
    assert step.max() <= 1.875 * widest / 0.2 * plan.dt
    speed = np.diff(tasks.zmp_ref, axis=0) / plan.dt
    assert np.abs(np.diff(speed, axis=0)).max() <= 5.8 * widest / 0.2**2 * plan.dt


@given(walks())
def test_the_zmp_divides_the_line_between_the_soles_as_the_load_is_shared(gait: Gait):
    """In single support one sole carries everything, at rest each carries half."""
    _, tasks = tasks_of(gait)
    load = tasks.load_left
    assert np.all((load >= 0.0) & (load <= 1.0))
    assert np.all(load[tasks.support == Support.LEFT] == 1.0)
    assert np.all(load[tasks.support == Support.RIGHT] == 0.0)
    assert load[0] == load[-1] == 0.5
    shortest = gait.walk.double_support - gait.dt  # [s], as rounded to samples
    assert np.abs(np.diff(load)).max() <= 1.875 * gait.dt / shortest  # top speed of a quintic
    # the ZMP divides the line between the two places like the load
    forward, inward = gait.walk.zmp_offset
    both = tasks.support == Support.DOUBLE
    places = []
    for side in Side:
        turn = np.exp(1j * yaw(tasks.soles[both, side, 3:]))
        local = complex(forward, -side.sign * inward) * turn
        places.append(tasks.soles[both, side, :2] + np.stack([local.real, local.imag], axis=1))
    share = load[both, None]
    expected = share * places[0] + (1.0 - share) * places[1]
    assert_allclose(tasks.zmp_ref[both], expected, atol=1e-12)


# --- hands and heights ------------------------------------------------------------------------


@given(walks())
def test_hands_keep_their_place_beside_the_com_and_turn_with_the_soles(gait: Gait):
    plan, tasks = tasks_of(gait)
    heading = yaw(tasks.soles[..., 3:])
    bisector = np.exp(1j * heading[:, 0]) + np.exp(1j * heading[:, 1])
    bisector /= np.abs(bisector)
    for side in Side:
        x, y, z = plan.hand_offsets[side]
        turned = complex(x, y) * bisector
        expected = np.stack([turned.real, turned.imag, np.full(len(turned), z)], axis=1)
        assert_allclose(tasks.hands[:, side], expected, atol=1e-9)


def test_walk_5cm_keeps_hands_and_com_height_constant(walk_5cm: Stages):
    tasks = walk_5cm.tasks
    assert np.all(tasks.hands == tasks.hands[0])
    assert np.all(tasks.com_height == tasks.com_height[0])
    assert tasks.dt == 0.01 and tasks.n_samples == 1201


# --- invariances ------------------------------------------------------------------------------


def moved(footstep: Footstep, shift: complex, turn: float) -> Footstep:
    place = shift + np.exp(1j * turn) * complex(footstep.x, footstep.y)
    return Footstep(footstep.side, place.real, place.imag, footstep.yaw + turn)


@settings(max_examples=20)
@given(walks())
def test_a_shifted_and_turned_world_shifts_and_turns_the_trajectories(gait: Gait):
    plan, here = tasks_of(gait)
    shift, turn = complex(1.3, -0.4), 0.8
    footsteps = tuple(moved(f, shift, turn) for f in plan.footsteps)
    there = plan_trajectories(dataclasses.replace(plan, footsteps=footsteps))

    def placed(points: np.ndarray) -> np.ndarray:
        z = np.exp(1j * turn) * (points[..., 0] + 1j * points[..., 1])
        return np.stack([z.real, z.imag], axis=-1)

    origin = [shift.real, shift.imag]
    assert_allclose(there.zmp_ref, origin + placed(here.zmp_ref), atol=1e-12)
    assert_allclose(there.soles[..., :2], origin + placed(here.soles[..., :2]), atol=1e-12)
    assert_allclose(there.soles[..., 2], here.soles[..., 2], rtol=0)
    turned = np.exp(1j * (yaw(here.soles[..., 3:]) + turn))
    assert_allclose(np.exp(1j * yaw(there.soles[..., 3:])), turned, atol=1e-12)
    assert_allclose(there.hands[..., :2], placed(here.hands[..., :2]), atol=1e-12)
    for name in ("support", "root", "load_left", "com_height"):
        assert np.array_equal(getattr(here, name), getattr(there, name))


@settings(max_examples=20)
@given(walks())
def test_a_mirrored_gait_has_mirrored_trajectories(gait: Gait):
    side = Side[(gait.walk.first_support or "left").upper()]
    walk = gait.walk.model_dump() | {"first_support": side.label}
    mirrored = walk | {
        "first_support": side.other.label,
        "lateral": -walk["lateral"],
        "step_yaw": -walk["step_yaw"],
    }
    _, here = tasks_of(walk_gait(gait.dt, **walk))
    _, there = tasks_of(walk_gait(gait.dt, **mirrored))
    flip = np.array([1.0, -1.0])
    assert_allclose(there.zmp_ref, here.zmp_ref * flip, atol=1e-12)
    assert_allclose(there.soles[:, ::-1, :2], here.soles[..., :2] * flip, atol=1e-12)
    assert_allclose(there.load_left, 1.0 - here.load_left, atol=1e-12)
    swapped = np.array([Support.DOUBLE, Support.RIGHT, Support.LEFT])
    assert np.array_equal(there.support, swapped[here.support])
    assert np.array_equal(there.root, 1 - here.root)


# --- heel to toe, arms ------------------------------------------------------------------------


@given(walks(), st.floats(0.0, 0.08))
def test_the_zmp_travels_from_heel_to_toe_without_a_jump(gait: Gait, travel: float):
    walk = gait.walk.model_dump() | {"zmp_travel": travel, "zmp_offset": [0.0, 0.0]}
    plan, tasks = tasks_of(walk_gait(dt=gait.dt, **walk))
    for phase in plan.phases:
        span = tasks.zmp_ref[phase.start : phase.end]
        if phase.support is Support.DOUBLE:
            continue
        footstep = plan.footsteps[phase.feet[phase.support.sides[0]]]
        local = (span - [footstep.x, footstep.y]) @ np.array([1.0, 1j]) * np.exp(-1j * footstep.yaw)
        assert_allclose(local.imag, 0.0, atol=1e-12)
        assert local[0].real == pytest.approx(-0.5 * travel, abs=1e-12)
        assert local.real.max() <= 0.5 * travel + 1e-12
        assert np.all(np.diff(local.real) >= -1e-12)
    fine = walk_gait(dt=gait.dt / 4, **walk)
    coarse_jump, fine_jump = (
        np.linalg.norm(np.diff(t.zmp_ref, axis=0), axis=1).max() for t in (tasks, tasks_of(fine)[1])
    )
    assert fine_jump < 0.5 * coarse_jump + 1e-9  # a jump would be as large however fine the samples


def test_where_soles_roll_the_zmp_travels_in_proportion_to_the_step():
    """Straight steps of 40, 80 and 60 mm, with the ways between the soles added up by hand."""
    steps = [{"step_length": way} for way in (0.04, 0.08, 0.06)]
    roll = {"toe_off": 0.1, "heel_strike": 0.1}
    walk = {"n_steps": None, "steps": steps, "zmp_travel": 0.03, "foot_roll": roll}
    plan, tasks = tasks_of(walk_gait(dt=0.01, **walk))
    behind = [0.0, 0.04, 0.08, 0.06]
    ahead = [0.04, 0.08, 0.06, 0.0]  # the last step closes the feet
    places = []
    for phase, swing in swings(plan):
        footstep = plan.footsteps[phase.feet[swing.other]]
        span = tasks.zmp_ref[phase.start : phase.end + 1, 0] - footstep.x
        places.append((span[0], span[-1]))  # the last one is at the start of the double support
    begin, end = np.transpose(places)
    assert_allclose(begin, -0.015 * np.array(behind) / 0.08, atol=1e-12)
    assert_allclose(end, 0.015 * np.array(ahead) / 0.08, atol=1e-12)


@given(walks(), st.floats(0.0, 1.0))
def test_each_hand_swings_with_the_opposite_foot(gait: Gait, part: float):
    walk = gait.walk.model_dump() | {"arm_swing": part}
    _, still = tasks_of(gait)
    _, tasks = tasks_of(walk_gait(dt=gait.dt, **walk))
    heading = yaw(tasks.soles[..., 3:])
    mean = np.unwrap(heading, axis=0).mean(axis=1)
    middle = tasks.soles[..., :2].mean(axis=1)
    for side in Side:
        swing = (tasks.hands - still.hands)[:, side, :2] @ np.array([1.0, 1j]) * np.exp(-1j * mean)
        foot = (tasks.soles[:, side.other, :2] - middle) @ np.array([1.0, 1j]) * np.exp(-1j * mean)
        assert_allclose(np.abs(swing.real), np.abs(part * foot.real), atol=1e-9)
        assert_allclose(swing.imag, 0.0, atol=1e-9)
    assert_allclose(tasks.hands[..., 2], still.hands[..., 2])
