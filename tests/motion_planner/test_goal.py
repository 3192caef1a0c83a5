"""Steps to a goal: arrival, size of the steps and mirror images."""

from __future__ import annotations

import cmath

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.gait import GoalParameters
from mgs.motion_planner import plan_motion
from mgs.motion_planner.goal import StepLimits, along_twist, way_to_goal
from mgs.robot import load_robot
from tests.support.strategies import walk_gait

MELSON = load_robot("melson")
LIMITS = StepLimits(length=0.05, lateral=0.03, inward=0.01, yaw=0.2)
goals = st.builds(
    GoalParameters, x=st.floats(-0.6, 0.6), y=st.floats(-0.6, 0.6), yaw=st.floats(-3.1, 3.1)
)


@given(goals, st.sampled_from(Side))
def test_the_last_step_to_a_goal_arrives_there(goal: GoalParameters, swing: Side):
    centres = way_to_goal(goal, swing, LIMITS)
    end = centres[-1] if centres else np.zeros(3)
    assert_allclose(end[:2], [goal.x, goal.y], atol=1e-9)
    assert cmath.exp(1j * end[2]) == pytest.approx(cmath.exp(1j * goal.yaw), abs=1e-9)


@given(goals, st.sampled_from(Side))
def test_no_step_to_a_goal_exceeds_the_largest_step(goal: GoalParameters, swing: Side):
    before = np.zeros(3)
    for centre in way_to_goal(goal, swing, LIMITS):
        step = complex(*(centre - before)[:2]) * cmath.exp(-1j * 0.5 * (centre[2] + before[2]))
        leads = swing.sign * step.imag > 0.0
        assert abs(step.real) <= LIMITS.length + 1e-9  # a chord is shorter than its arc
        assert abs(step.imag) <= (LIMITS.lateral if leads else LIMITS.inward) + 1e-9
        assert abs(centre[2] - before[2]) <= LIMITS.yaw + 1e-9
        before, swing = centre, swing.other


@given(goals, st.sampled_from(Side))
def test_the_steps_to_a_mirrored_goal_are_mirrored(goal: GoalParameters, swing: Side):
    mirrored = GoalParameters(x=goal.x, y=-goal.y, yaw=-goal.yaw)
    there, here = way_to_goal(mirrored, swing.other, LIMITS), way_to_goal(goal, swing, LIMITS)
    assert len(there) == len(here)
    if here:
        assert_allclose(there, np.array(here) * [1.0, -1.0, -1.0], atol=1e-9)


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(-3, 3))
def test_the_pose_after_a_constant_twist_is_the_sum_of_its_small_displacements(
    x: float, y: float, turn: float
):
    n = 2000
    place = sum(
        complex(x, y) / n * cmath.exp(1j * turn * (i + 0.5) / n) for i in range(n)
    )  # midpoint rule
    found = along_twist(np.array([x, y, turn]), 1.0)
    assert complex(found[0], found[1]) == pytest.approx(place, abs=1e-6)


@given(goals)
def test_a_walk_to_a_pose_ends_within_a_millimetre_and_a_tenth_of_a_degree(goal: GoalParameters):
    gait = walk_gait(
        n_steps=None, goal=goal.model_dump(), step_length=0.05, lateral=0.02, step_yaw=0.15
    )
    footsteps = plan_motion(MELSON, gait).footsteps
    last = [[f for f in footsteps if f.side is side][-1] for side in Side]
    middle = 0.5 * complex(last[0].x + last[1].x, last[0].y + last[1].y)
    assert abs(middle - complex(goal.x, goal.y)) < 1e-3
    for footstep in last:
        off = cmath.phase(cmath.exp(1j * (footstep.yaw - goal.yaw)))
        assert abs(off) < np.radians(0.1)


def test_a_goal_that_takes_too_many_steps_is_refused_by_its_key():
    with pytest.raises(ConfigError, match=r"walk\.goal: .* steps away, 20000 allowed"):
        way_to_goal(GoalParameters(x=1000.0, y=0.0), Side.LEFT, LIMITS)
