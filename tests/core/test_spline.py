"""The cubic spline, compared with SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from mgs.core.spline import evaluate, spline_at_rest

H = 0.01


@pytest.mark.parametrize("n", [3, 4, 50])
def test_it_is_the_clamped_spline_of_scipy(n: int):
    values = np.random.default_rng(n).normal(size=(n, 3))
    oracle = CubicSpline(H * np.arange(n), values, bc_type="clamped")
    times = np.linspace(0.0, (n - 1) * H, 97)
    for order, found in enumerate(evaluate(spline_at_rest(values, H), times)):
        expected = oracle(times, order)
        assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


def test_samples_are_met_exactly_and_the_ends_are_at_rest():
    values = np.random.default_rng(1).normal(size=(40, 2))
    found, rate, _ = evaluate(spline_at_rest(values, H), H * np.arange(40))
    assert np.array_equal(found, values)
    assert np.array_equal(rate[[0, -1]], np.zeros((2, 2)))


def test_outside_its_samples_it_stands_still():
    values = np.random.default_rng(2).normal(size=(5, 2))
    found, rate, second = evaluate(spline_at_rest(values, H), np.array([-1.0, 4 * H + 1.0]))
    assert np.array_equal(found, values[[0, -1]])
    assert not rate.any()
    assert not second.any()


@pytest.mark.parametrize("n", [1, 2])
def test_one_or_two_samples_make_a_curve(n: int):
    values = np.arange(2.0 * n).reshape(n, 2)
    found, rate, _ = evaluate(spline_at_rest(values, H), np.array([0.0, 0.5 * H, H]))
    assert np.allclose(found[1], values.mean(axis=0), rtol=0, atol=1e-12)
    assert not rate[0].any()
