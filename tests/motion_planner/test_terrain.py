"""Stairs and obstacles: heights of soles and CoM, clearance of swings, and refusals."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mgs.core.contact import Side, Support
from mgs.core.errors import InfeasibleGaitError
from mgs.core.geometry import sole_corners, yaw_from_quat_xyzw
from mgs.motion_planner import WalkPlan, plan_motion
from mgs.robot import load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories
from tests.support.strategies import walk_gait

MELSON = load_robot("melson")
SOLE = MELSON.sole_spec(Side.LEFT)
WIDTH = 0.0955
CLEARANCE = 0.005


def climb(rise: float, tread: float, n: int = 2, **walk: object) -> WalkPlan:
    """Plan of a walk up n stairs, both feet onto each of them."""
    first = 0.5 * SOLE.length + 0.01  # the first edge ahead of the toes
    boxes, footsteps = [], []
    for k in range(n):
        near = first + k * tread
        boxes.append(
            {"x": near + tread / 2, "length": tread, "width": 1.0, "height": rise * (k + 1)}
        )
        x = near + 0.5 * SOLE.length + 0.002
        footsteps += [{"side": s.label, "x": x, "y": 0.5 * s.sign * WIDTH} for s in Side]
    return plan_motion(
        MELSON,
        walk_gait(
            n_steps=None, footsteps=footsteps, boxes=boxes, clearance=CLEARANCE,
            single_support=1.0, **walk,
        ),
    )  # fmt: skip


def swinging(plan: WalkPlan, tasks: TaskTrajectory) -> list[tuple[int, Side]]:
    return [
        (k, phase.support.sides[0].other)
        for phase in plan.phases
        if phase.support is not Support.DOUBLE
        for k in range(phase.start, phase.end)
    ]


@settings(max_examples=20)
@given(st.floats(0.005, 0.04), st.floats(0.12, 0.16))
def test_swing_soles_keep_clear_of_every_edge(rise: float, tread: float):
    """Oracle: single points of the sole against the height of the stairs as a function of x."""
    plan = climb(rise, tread)
    tasks = plan_trajectories(plan)
    first = 0.5 * SOLE.length + 0.01
    for k, side in swinging(plan, tasks):
        pose = tasks.soles[k, side]
        x = pose[0] + np.linspace(-0.5, 0.5, 107) * SOLE.length
        stair = np.clip(np.floor((x - first) / tread) + 1, 0, 2) * rise
        stair[x > first + 2 * tread] = 0.0
        assert pose[2] >= stair.max() - 1e-9
        if stair.min() != stair.max():  # over an edge
            assert pose[2] >= stair.max() + CLEARANCE - 1e-3  # within the grid of the planner


@settings(max_examples=20)
@given(st.floats(0.005, 0.04), st.floats(0.12, 0.16))
def test_soles_stand_still_on_top_of_their_stairs(rise: float, tread: float):
    plan = climb(rise, tread)
    tasks = plan_trajectories(plan)
    assert [round(f.z / rise) for f in plan.footsteps] == [0, 0, 1, 1, 2, 2]
    for phase in plan.phases:
        for side in phase.support.sides:
            span = tasks.soles[phase.start : phase.end, side]
            footstep = plan.footsteps[phase.feet[side]]
            assert np.abs(span - span[0]).max() == 0.0
            assert span[0, :3].tolist() == [footstep.x, footstep.y, footstep.z]


@settings(max_examples=20)
@given(st.floats(0.005, 0.04), st.floats(0.12, 0.16))
def test_both_ankles_stay_within_the_reach_of_the_legs(rise: float, tread: float):
    """The hips are assumed above the ZMP as they are above the CoM at rest."""
    plan = climb(rise, tread)
    tasks, reach = plan_trajectories(plan), plan.reach
    assert reach is not None
    for side in Side:
        hips = np.column_stack([tasks.zmp_ref, tasks.com_height]) + reach.hips[side]
        ankles = tasks.soles[:, side, :3] + reach.ankles[side]  # nobody turns here
        assert np.linalg.norm(hips - ankles, axis=1).max() <= reach.length + 1e-9
    assert np.all(tasks.com_height <= plan.com_height + 2 * rise + 1e-12)


def test_the_com_is_as_high_as_asked_where_the_legs_are_long_enough():
    plan = climb(0.005, 0.12, com_height=0.2)
    tasks = plan_trajectories(plan)
    assert tasks.com_height[0] == pytest.approx(0.2, abs=1e-12)
    assert tasks.com_height[-1] == pytest.approx(0.21, abs=1e-12)
    assert np.all(np.diff(tasks.com_height) >= -1e-12)


def test_a_footstep_over_an_edge_is_refused():
    boxes = [{"x": 0.1, "length": 0.08, "width": 1.0, "height": 0.02}]
    with pytest.raises(InfeasibleGaitError, match=r"footstep 2 stands .* over the edge of a box"):
        plan_motion(MELSON, walk_gait(step_length=0.05, boxes=boxes))


def test_an_edge_that_no_swing_clears_is_refused_with_the_remedy():
    boxes = [{"x": 0.0575, "length": 0.005, "width": 0.3, "height": 0.015}]
    footsteps = [{"side": s.label, "x": 0.115, "y": 0.5 * s.sign * WIDTH} for s in Side]
    with pytest.raises(InfeasibleGaitError, match=r"close to an edge, .*greater walk\.step_height"):
        plan_motion(
            MELSON,
            walk_gait(
                n_steps=None, footsteps=footsteps, boxes=boxes, step_height=0.004, clearance=0.01
            ),
        )


@settings(max_examples=20)
@given(st.floats(0.0, 0.6), st.floats(-0.02, 0.02))
def test_an_obstacle_is_stepped_over(yaw: float, y: float):
    """Oracle: corners of the swing sole and points between them against the turned obstacle."""
    boxes = [{"x": 0.085, "y": y, "yaw": yaw, "length": 0.004, "width": 0.02, "height": 0.012}]
    footsteps = [{"side": s.label, "x": 0.15, "y": 0.5 * s.sign * WIDTH} for s in Side]
    gait = walk_gait(n_steps=None, footsteps=footsteps, boxes=boxes, single_support=1.0)
    plan = plan_motion(MELSON, gait)
    tasks = plan_trajectories(plan)
    for k, side in swinging(plan, tasks):
        pose = tasks.soles[k, side]
        planar = [pose[0], pose[1], float(yaw_from_quat_xyzw(pose[3:]))]
        a, b, _, d = sole_corners(planar, SOLE.length, SOLE.width)
        for u, v in itertools.product(np.linspace(0, 1, 12), repeat=2):
            point = a + u * (b - a) + v * (d - a)
            local = complex(*(point - [0.085, y])) * np.exp(-1j * yaw)
            if abs(local.real) < 0.002 and abs(local.imag) < 0.01:
                assert pose[2] >= 0.012 + gait.walk.clearance - 1e-3
