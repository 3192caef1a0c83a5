"""Curves through knots against SciPy's Hermite interpolation, closed forms and differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.interpolate import BPoly

from mgs.core.curves import Knots, at_rest, evaluate

intervals = st.lists(st.floats(0.5, 2.0), min_size=1, max_size=6)
seeds = st.integers(0, 2**32 - 1)


def random_knots(spans: list[float], seed: int) -> Knots:
    rng = np.random.default_rng(seed)
    times = np.concatenate([[0.0], np.cumsum(spans)])
    return Knots(times, rng.uniform(-1, 1, (len(times), 2)), rng.uniform(-1, 1, (len(times), 2)))


@given(intervals, seeds)
def test_a_curve_is_the_hermite_interpolant_of_its_knots(spans: list[float], seed: int):
    """Oracle: SciPy's piecewise Bernstein polynomial with the same three derivatives at a knot."""
    knots = random_knots(spans, seed)
    derivatives = np.stack([knots.points, knots.speeds, np.zeros_like(knots.points)], axis=1)
    oracle = BPoly.from_derivatives(knots.times, list(derivatives))
    t = np.linspace(0.0, knots.times[-1], 301)
    assert_allclose(evaluate(knots, t), oracle(t), rtol=0, atol=1e-13)


def test_between_knots_at_rest_a_curve_is_the_minimum_jerk_motion():
    t = np.linspace(1.0, 3.0, 41)
    s = (t - 1.0) / 2.0
    expected = 5.0 - 7.0 * (10 * s**3 - 15 * s**4 + 6 * s**5)
    found = evaluate(at_rest([1.0, 3.0], [[5.0], [-2.0]]), t)
    assert_allclose(found[:, 0], expected, atol=1e-12)


@given(intervals, seeds)
def test_a_curve_has_the_speed_of_every_knot_and_no_acceleration_there(
    spans: list[float], seed: int
):
    knots = random_knots(spans, seed)
    times, h = knots.times, 1e-4
    assert_allclose(evaluate(knots, times), knots.points, atol=1e-12)
    before, at, after = (evaluate(knots, times[1:-1] + d) for d in (-h, 0.0, h))
    assert_allclose((after - before) / (2 * h), knots.speeds[1:-1], atol=1e-3)
    assert_allclose((after - 2 * at + before) / h**2, 0.0, atol=0.5)  # O(h) of a jerk below 2000


def test_a_curve_stands_still_before_its_first_and_after_its_last_knot():
    found = evaluate(at_rest([0.0, 1.0], [[1.0], [2.0]]), [-1.0, 0.0, 1.0, 5.0])
    assert found[:, 0].tolist() == [1.0, 1.0, 2.0, 2.0]


def test_a_single_knot_is_a_curve_that_stands_still():
    found = evaluate(Knots(np.zeros(1), np.array([[3.0]]), np.array([[7.0]])), [-1.0, 0.0, 1.0])
    assert found.tolist() == [[3.0]] * 3


@pytest.mark.parametrize("times", [[0.0, 0.0, 1.0], [0.0, 1.0, 1.0]])
def test_of_knots_at_the_same_time_the_first_one_counts(times: list[float]):
    found = evaluate(at_rest(times, [[1.0], [1.0], [1.0]]), np.linspace(0.0, 1.0, 5))
    assert found[:, 0].tolist() == [1.0] * 5
    found = evaluate(at_rest([0.0, 0.0, 1.0], [[1.0], [2.0], [1.0]]), np.linspace(0.0, 1.0, 5))
    assert found[:, 0].tolist() == [1.0] * 5
