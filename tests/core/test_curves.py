"""Curves through knots against the minimum-jerk polynomial and finite differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.core.curves import Knots, at_rest, evaluate


def test_between_knots_at_rest_it_is_the_minimum_jerk_motion():
    t = np.linspace(1.0, 3.0, 41)
    s = (t - 1.0) / 2.0
    expected = 5.0 - 7.0 * (10 * s**3 - 15 * s**4 + 6 * s**5)
    found = evaluate(at_rest([1.0, 3.0], [[5.0], [-2.0]]), t)
    assert_allclose(found[:, 0], expected, atol=1e-12)


@given(
    st.lists(st.floats(0.5, 2.0), min_size=1, max_size=6),
    st.integers(0, 2**32 - 1),
)
def test_every_knot_is_met_with_its_speed_and_no_acceleration(spans: list[float], seed: int):
    rng = np.random.default_rng(seed)
    times = np.concatenate([[0.0], np.cumsum(spans)])
    knots = Knots(times, rng.uniform(-1, 1, (len(times), 2)), rng.uniform(-1, 1, (len(times), 2)))
    h = 1e-4
    assert_allclose(evaluate(knots, times), knots.points, atol=1e-12)
    before, at, after = (evaluate(knots, times[1:-1] + d) for d in (-h, 0.0, h))
    assert_allclose((after - before) / (2 * h), knots.speeds[1:-1], atol=1e-3)
    assert_allclose((after - 2 * at + before) / h**2, 0.0, atol=0.5)  # O(h) of a jerk below 2000


def test_it_rests_before_the_first_and_after_the_last_knot():
    found = evaluate(at_rest([0.0, 1.0], [[1.0], [2.0]]), [-1.0, 0.0, 1.0, 5.0])
    assert found[:, 0].tolist() == [1.0, 1.0, 2.0, 2.0]


@pytest.mark.parametrize("times", [[0.0, 0.0, 1.0], [0.0, 1.0, 1.0]])
def test_knots_at_the_same_time_count_once(times: list[float]):
    found = evaluate(at_rest(times, [[1.0], [1.0], [1.0]]), np.linspace(0.0, 1.0, 5))
    assert found[:, 0].tolist() == [1.0] * 5
