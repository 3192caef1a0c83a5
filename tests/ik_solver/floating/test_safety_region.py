"""The interval of each joint against eq. (6) of Faraji and Ijspeert, evaluated on a fine grid."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.ik_solver.floating.safety_region import POLYGON_SPEED, SafetyRegion
from tests.support.strategies import numbers

N_GRID = 4001


@st.composite
def joints(draw: st.DrawFn) -> tuple[float, float, float, float]:
    """Limits [rad], largest speed [rad/s] and dt [s] of one joint."""
    lower, width = draw(numbers(-3.0, 2.0)), draw(numbers(0.05, 5.0))
    return lower, lower + width, draw(numbers(0.1, 20.0)), draw(numbers(1e-3, 0.1))


def ellipse(lower: float, upper: float, speed: float, dt: float, q_prev: float, q) -> np.ndarray:
    """Eq. (6) as printed, q_s = 0."""
    return (
        (2.0 * q - (lower + upper)) ** 2 / (upper - lower) ** 2
        + ((q - q_prev) / dt / speed) ** 2
        - 1.0
    )


def polygon(lower: float, upper: float, speed: float, dt: float, q_prev: float, q) -> np.ndarray:
    """Excess over |v| <= min(speed, v0 + kappa distance to the nearer limit)."""
    kappa = 4.0 * speed / (upper - lower)
    bound = np.minimum(speed, POLYGON_SPEED + kappa * np.minimum(q - lower, upper - q))
    outside = np.maximum(lower - q, q - upper)
    return np.maximum(np.abs((q - q_prev) / dt) - bound, outside)


DEFINITIONS = {"ellipse": ellipse, "polygon": polygon}


def interval(
    shape: str, lower: float, upper: float, speed: float, dt: float, q_prev: float
) -> tuple[float, float, int]:
    one = np.ones(1)
    region = SafetyRegion(lower * one, upper * one, speed * one, dt, shape)  # type: ignore[arg-type]
    low, high = np.empty(1), np.empty(1)
    recovering = region.interval(q_prev * one, low, high)
    return float(low[0]), float(high[0]), recovering


@pytest.mark.parametrize("shape", DEFINITIONS)
@given(joint=joints(), place=numbers(0.0, 1.0))
def test_the_interval_contains_exactly_the_positions_of_the_region(
    shape: str, joint: tuple[float, float, float, float], place: float
):
    """The joint starts inside its limits; the grid covers more than one step can reach."""
    lower, upper, speed, dt = joint
    q_prev = lower + place * (upper - lower)
    low, high, recovering = interval(shape, *joint, q_prev)
    assert recovering == 0
    assert low <= q_prev + 1e-12
    assert high >= q_prev - 1e-12
    d = dt * speed
    grid = np.linspace(q_prev - 1.5 * d, q_prev + 1.5 * d, N_GRID)
    step = grid[1] - grid[0]
    inside = DEFINITIONS[shape](lower, upper, speed, dt, q_prev, grid) <= 1e-12
    margin = 1e-9  # [rad] about the ends, where rounding decides
    assert not inside[(grid < low - margin) | (grid > high + margin)].any()
    assert inside[(grid > low + margin) & (grid < high - margin)].all()
    if inside.any():
        assert abs(grid[inside][0] - low) <= step + margin
        assert abs(grid[inside][-1] - high) <= step + margin


@pytest.mark.parametrize("shape", DEFINITIONS)
@given(joint=joints(), place=numbers(0.0, 1.0))
def test_both_ends_of_the_interval_are_on_the_edge(
    shape: str, joint: tuple[float, float, float, float], place: float
):
    """The excess over the region is zero there, up to rounding."""
    lower, upper, speed, dt = joint
    one = np.ones(1)
    region = SafetyRegion(lower * one, upper * one, speed * one, dt, shape)  # type: ignore[arg-type]
    q_prev = lower + place * (upper - lower)
    for end in interval(shape, *joint, q_prev)[:2]:
        excess = region.excess(q_prev * one, end * one)[0]
        assert abs(excess) <= 1e-9
        assert_allclose(
            excess, DEFINITIONS[shape](lower, upper, speed, dt, q_prev, end), atol=1e-11 * speed
        )


@given(joint=joints(), place=numbers(0.0, 1.0), inner=numbers(-0.5, 1.5))
def test_excess_is_that_of_the_definition_inside_and_outside(
    joint: tuple[float, float, float, float], place: float, inner: float
):
    lower, upper, speed, dt = joint
    one, width = np.ones(1), upper - lower
    q_prev, q = lower + place * width, lower + inner * width
    for shape, definition in DEFINITIONS.items():
        region = SafetyRegion(lower * one, upper * one, speed * one, dt, shape)  # type: ignore[arg-type]
        expected = definition(lower, upper, speed, dt, q_prev, q)
        assert_allclose(region.excess(q_prev * one, q * one)[0], expected, rtol=1e-9, atol=1e-9)


@given(joint=joints())
def test_from_the_limit_one_step_reaches_about_two_d_squared_over_h(
    joint: tuple[float, float, float, float],
):
    """(1 - s/h)^2 + s^2/d^2 = 1 has the roots s = 0 and s = 2 h / (1 + h^2/d^2)."""
    lower, upper, speed, dt = joint
    h, d = 0.5 * (upper - lower), dt * speed
    reach = 2.0 * h / (1.0 + (h / d) ** 2)
    assert reach <= 2.0 * d**2 / h * (1.0 + 1e-12)
    low, high, _ = interval("ellipse", *joint, lower)
    assert_allclose([low, high], [lower, lower + reach], atol=1e-12)
    low, high, _ = interval("ellipse", *joint, upper)
    assert_allclose([low, high], [upper - reach, upper], atol=1e-12)


@given(joint=joints(), beyond=numbers(-1.0, 1.0).filter(lambda x: abs(x) > 1e-3))
def test_the_region_is_out_of_reach_exactly_beyond_the_root_of_h2_plus_d2(
    joint: tuple[float, float, float, float], beyond: float
):
    """Just inside that distance there is a short interval; outside, a joint takes a full step."""
    lower, upper, speed, dt = joint
    middle, h, d = 0.5 * (lower + upper), 0.5 * (upper - lower), dt * speed
    edge = np.hypot(h, d)
    for factor in (1.0 - 1e-6, 1.0 + 1e-6):
        q_prev = middle + np.sign(beyond) * edge * factor
        low, high, recovering = interval("ellipse", *joint, q_prev)
        grid = np.linspace(q_prev - d, q_prev + d, 200 * N_GRID)
        found = bool((ellipse(lower, upper, speed, dt, q_prev, grid) <= 0.0).any())
        assert recovering == (factor > 1.0) == (not found)
        assert low <= high
        if recovering:
            nearest = lower if beyond < 0.0 else upper
            expected = q_prev + np.clip(nearest - q_prev, -d, d)
            assert_allclose([low, high], expected, atol=1e-12)


@pytest.mark.parametrize("shape", DEFINITIONS)
@given(joint=joints(), far=numbers(1.0, 3.0), side=st.sampled_from([-1.0, 1.0]))
def test_from_far_outside_a_joint_returns_at_its_largest_speed(
    shape: str, joint: tuple[float, float, float, float], far: float, side: float
):
    lower, upper, speed, dt = joint
    limit = lower if side < 0.0 else upper
    q = limit + side * (far * dt * speed + 0.01 * (upper - lower))
    if shape == "ellipse" and abs(q - 0.5 * (lower + upper)) <= np.hypot(
        0.5 * (upper - lower), dt * speed
    ):
        return
    low, high, recovering = interval(shape, *joint, q)
    assert recovering == 1
    assert low == high
    assert_allclose(low, q - side * dt * speed, atol=1e-12)


def test_joints_are_independent_and_counted_one_by_one():
    lower, upper = np.array([-1.0, 0.0, -2.0]), np.array([1.0, 2.0, -1.0])
    speed, dt = np.array([4.0, 2.0, 1.0]), 0.01
    q_prev = np.array([0.3, -0.5, -0.9])  # inside, outside, outside
    for shape in DEFINITIONS:
        region = SafetyRegion(lower, upper, speed, dt, shape)  # type: ignore[arg-type]
        low, high = np.empty(3), np.empty(3)
        assert region.interval(q_prev, low, high) == 2
        for j in range(3):
            alone = interval(shape, lower[j], upper[j], speed[j], dt, q_prev[j])
            assert_allclose([low[j], high[j]], alone[:2], atol=1e-15)
        # a second call starts afresh
        assert region.interval(np.array([0.3, 0.5, -1.5]), low, high) == 0


def test_a_braking_joint_can_always_stop_before_its_limit():
    """The joint moves up at the bound of every step; it reaches the limit and never exceeds it."""
    for shape in DEFINITIONS:
        q, speeds = 0.0, []
        for _ in range(400):
            _, high, recovering = interval(shape, -1.0, 1.0, 4.0, 0.01, q)
            assert recovering == 0
            speeds.append((high - q) / 0.01)
            q = high
        assert q <= 1.0
        assert q > 0.99
        assert all(np.diff(speeds) <= 1e-9)  # it only slows down
