"""Gains of the null-space objectives over time."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from mgs.core.contact import Support
from mgs.ik_solver.gains import gravity_gain_profile, rest_profile


def test_the_gravity_gain_is_off_in_double_support_and_ramps_at_both_ends_of_single_support():
    support = np.repeat([0, 1, 0, 2, 0], [30, 100, 20, 60, 40]).astype(np.int8)
    dt, ramp = 0.01, 0.2
    gain = gravity_gain_profile(support, dt, ramp)
    assert np.all(gain[support == Support.DOUBLE] == 0.0)
    for start, end in ((30, 130), (150, 210)):
        k = np.arange(start, end)
        since, until = (k - start) * dt, (end - k) * dt
        expected = np.interp(np.minimum(since, until), [0.0, ramp], [0.0, 1.0])
        assert_allclose(gain[start:end], expected, atol=1e-12)
        assert gain[start:end].max() == 1.0
    assert np.abs(np.diff(gain)).max() <= dt / ramp + 1e-12  # continuous


@pytest.mark.parametrize("first", [0, 1, 2])
def test_in_a_single_support_shorter_than_two_ramps_the_gain_has_no_jump(first: int):
    support = np.repeat([first, 0, 2], [5, 20, 10]).astype(np.int8)
    gain = gravity_gain_profile(support, 0.01, 0.2)
    assert gain.min() == 0.0 and gain.max() <= 1.0
    assert np.abs(np.diff(gain[5:])).max() <= 0.2 + 1e-12  # up and down within ten samples


def test_null_space_motion_starts_and_ends_at_rest():
    profile = rest_profile(1001, 0.01, 0.2)
    k = np.arange(1001)
    expected = np.interp(np.minimum(k, 1000 - k) * 0.01, [0.0, 0.2], [0.0, 1.0])
    assert_allclose(profile, expected, atol=1e-12)
