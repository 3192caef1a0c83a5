"""A CoM motion that is given: differences against closed forms, ZMP against a point mass."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from numpy.testing import assert_allclose

from mgs.com_generator.from_positions import follow_com
from mgs.motion_planner import plan_motion
from mgs.pipeline import first_com
from mgs.robot import load_robot
from mgs.trajectory_planner import plan_trajectories
from tests.support.strategies import balance_gait, numbers, sine

GRAVITY = 9.81


def swing(
    dt: float, amplitude: float = 0.02, frequency: float = 0.5
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, velocity and acceleration (N, 3) of a sine about (0.01, 0, 0.3), each axis late."""
    times = dt * np.arange(round(4.0 / dt) + 1)
    turn = 2.0 * np.pi * frequency
    angle = turn * times[:, None] + np.array([0.0, 1.0, 2.0])
    middle = np.array([0.01, 0.0, 0.3])
    return (
        middle + amplitude * np.sin(angle),
        amplitude * turn * np.cos(angle),
        -amplitude * turn**2 * np.sin(angle),
    )


def test_the_com_is_passed_on_as_it_is():
    position, _, _ = swing(0.01)
    assert np.array_equal(follow_com(position, 0.01).position, position)


@given(numbers(0.1, 3.0))
def test_differences_of_a_sine_are_the_sine_of_the_sampled_frequency(frequency: float):
    """sin(a + b) - sin(a - b) = 2 cos a sin b, and the like for the second difference."""
    dt, amplitude = 0.01, 0.02
    position, velocity, acceleration = swing(dt, amplitude, frequency)
    com = follow_com(position, dt)
    half = np.pi * frequency * dt
    inner = slice(1, -1)
    first, second = np.sin(2.0 * half) / (2.0 * half), (np.sin(half) / half) ** 2
    assert_allclose(com.velocity[inner], first * velocity[inner], atol=1e-11)
    assert_allclose(com.acceleration[inner], second * acceleration[inner], atol=1e-9)


def test_differences_come_to_the_derivatives_with_the_square_of_the_period():
    errors = []
    for dt in (0.02, 0.01, 0.005):
        position, velocity, acceleration = swing(dt)
        com = follow_com(position, dt)
        errors.append(
            [
                np.abs(com.velocity - velocity)[1:-1].max(),
                np.abs(com.acceleration - acceleration)[1:-1].max(),
            ]
        )
    assert_allclose(np.array(errors[:-1]) / errors[1:], 4.0, rtol=0.01)


def test_before_and_after_the_motion_it_rests():
    position, _, _ = swing(0.01)
    com = follow_com(position, 0.01)
    for end, inward in ((0, 1), (-1, -2)):
        step = (position[inward] - position[end]) / 0.01
        assert_allclose(com.velocity[end], 0.5 * step * (1 if end == 0 else -1), atol=1e-12)
        assert_allclose(com.acceleration[end], step / 0.01, atol=1e-9)


def test_the_zmp_is_where_the_point_mass_has_no_tilting_moment():
    position, _, _ = swing(0.01, 0.02, 1.5)
    com = follow_com(position, 0.01)
    force = com.acceleration + np.array([0.0, 0.0, GRAVITY])
    arm = com.position - np.column_stack([com.zmp, np.zeros(len(position))])
    assert np.abs(np.cross(arm, force)[:, :2]).max() < 1e-12
    assert np.abs(com.zmp - com.position[:, :2]).max() > 0.01


def test_at_rest_the_zmp_is_below_the_com():
    position = np.tile([0.01, -0.02, 0.3], (5, 1))
    com = follow_com(position, 0.01)
    assert np.array_equal(com.zmp, position[:, :2])
    assert not com.velocity.any() and not com.acceleration.any()


@pytest.mark.parametrize("com_height", [None, 0.25])
def test_a_balance_motion_needs_no_parameters_of_the_preview_control(com_height: float | None):
    gait = balance_gait(sine("com_y", 0.02), com_height=com_height)
    robot = load_robot("melson")
    tasks = plan_trajectories(plan_motion(robot, gait))
    com = first_com(robot, gait, tasks)
    assert tasks.com is not None
    assert np.array_equal(com.position, tasks.com)
    for k in (0, -1):
        assert not com.velocity[k].any() and not com.acceleration[k].any()
