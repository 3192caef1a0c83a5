"""The dynamic filter's correction against a plain simulation of the preview control."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from mgs.com_generator import correct_com
from mgs.com_generator.dynamic_filter import rest_window
from mgs.gait import ComParameters
from tests.support.preview import DT, HEIGHT, follow, simulate, steps_after

ZMP_REF = steps_after(1.8)
STIFF = ComParameters(generator="preview", weight_jerk=1e-10)
PARTS = ("position", "velocity", "acceleration")


def error_while_moving(seed: int) -> np.ndarray:
    """A ZMP error (N, 2) of some mm that is zero while the robot rests."""
    rng = np.random.default_rng(seed)
    bumps = np.hanning(41) / 20.0
    error = np.zeros((len(ZMP_REF), 2))
    error[220:-220] = rng.normal(0.0, 5e-3, (len(ZMP_REF) - 440, 2))
    return np.column_stack([np.convolve(column, bumps, mode="same") for column in error.T])


@pytest.mark.parametrize("weight_jerk", [1e-6, 1e-8])
def test_a_correction_adds_the_preview_response_of_the_error(weight_jerk: float):
    """Step by step, by the servo's formula; where the robot moves the error passes as it is.

    In the rest at the end what still moves, less than a thousandth, is brought to rest.
    """
    parameters = ComParameters(generator="preview", weight_jerk=weight_jerk)
    com, error = follow(ZMP_REF, weight_jerk=weight_jerk), error_while_moving(1)
    corrected = correct_com(com, ZMP_REF, error, DT, parameters)
    states = simulate(error, DT, HEIGHT, parameters)
    for i, part in enumerate(PARTS):
        added = (getattr(corrected, part) - getattr(com, part))[:, :2]
        largest = np.abs(states[:, i]).max()
        assert_allclose(added[:-241], states[:-241, i], atol=1e-8 * max(1.0, largest))
        assert_allclose(added[-241:], states[-241:, i], atol=1e-3 * largest)
    lever = HEIGHT / 9.81 * (corrected.acceleration - com.acceleration)[:, :2]
    moved = (corrected.position - com.position)[:, :2]
    assert_allclose(corrected.zmp - com.zmp, moved - lever, atol=1e-12)
    assert_array_equal(corrected.position[:, 2], com.position[:, 2])


def test_corrections_superpose():
    com, parameters = follow(ZMP_REF), ComParameters()
    first, second = error_while_moving(2), error_while_moving(3)
    at_once = correct_com(com, ZMP_REF, first - 2.0 * second, DT, parameters)
    one = correct_com(com, ZMP_REF, first, DT, parameters)
    both = correct_com(one, ZMP_REF, -2.0 * second, DT, parameters)
    for part in (*PARTS, "zmp"):
        assert_allclose(getattr(at_once, part), getattr(both, part), atol=1e-9)


def test_where_nothing_is_off_nothing_is_corrected():
    com = follow(ZMP_REF)
    corrected = correct_com(com, ZMP_REF, np.zeros_like(ZMP_REF), DT, ComParameters())
    for part in (*PARTS, "zmp"):
        assert_array_equal(getattr(corrected, part), getattr(com, part))


def test_a_cart_whose_zmp_was_off_is_corrected_to_the_reference():
    """Here the error is the cart's own: one pass of a stiff control takes most of it away."""
    soft = follow(ZMP_REF, weight_jerk=1e-6)
    error = ZMP_REF - soft.zmp
    corrected = correct_com(soft, ZMP_REF, error, DT, STIFF)
    left = np.abs(ZMP_REF - corrected.zmp)
    assert left.mean() < 0.05 * np.abs(error).mean()


def test_the_ends_of_an_error_are_left_out():
    """All of it counts from halfway through the first rest to halfway through the last."""
    window = rest_window(ZMP_REF)
    first, last = 180, 240  # samples of rest
    assert window[0] == window[-1] == 0.0
    assert np.all(window[first // 2 : -last // 2] == 1.0)
    assert np.all(np.diff(window[: first // 2]) >= 0.0)
    assert_allclose(window, rest_window(ZMP_REF[::-1])[::-1], atol=1e-15)


def test_a_zmp_that_never_moves_has_a_window_too():
    window = rest_window(np.zeros((50, 2)))
    assert window[0] == window[-1] == 0.0 and window.max() == 1.0
    assert np.all(np.isfinite(rest_window(np.zeros((1, 2)))))


@pytest.mark.parametrize("rest", [0.1, 0.3, 1.8])
def test_a_correction_ends_at_rest_however_short_the_rest(rest: float):
    """Place, speed and acceleration by finite differences of the positions."""
    zmp_ref = ZMP_REF[: len(ZMP_REF) - 240 + round(rest / DT)]
    error = np.full((len(zmp_ref), 2), 2e-3)
    still = follow(np.zeros_like(zmp_ref))
    corrected = correct_com(still, zmp_ref, error, DT, STIFF)
    xy = corrected.position[:, :2]
    lever = HEIGHT / 9.81 * corrected.acceleration[:, :2]
    assert np.abs(xy).max() > 1e-3  # something is corrected
    assert np.abs(xy[-1]).max() < 1e-12
    assert np.abs(corrected.velocity[-1]).max() < 1e-12
    assert np.abs(corrected.acceleration[-1]).max() < 1e-10
    assert_allclose(np.gradient(xy, DT, axis=0)[2:-2], corrected.velocity[2:-2, :2], atol=2e-3)
    assert_allclose(corrected.zmp, xy - lever, atol=1e-12)
