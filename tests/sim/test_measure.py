"""Figures of a replay, on poses made by hand."""

from __future__ import annotations

import numpy as np
import pytest

from mgs.core.contact import Side, Support
from mgs.core.geometry import quat_xyzw_from_yaw
from mgs.sim.effort import Effort
from mgs.sim.measure import angle_between, largest_slip, travel

DT = 0.01


def resting(n):
    """Soles (n, 2, 7) at rest, 0.1 m apart."""
    soles = np.zeros((n, 2, 7))
    soles[:, :, 1] = [0.05, -0.05]
    soles[:, :, 6] = 1.0
    return soles


def test_slip_counts_only_while_the_plan_says_support():
    soles, support = resting(100), np.full(100, Support.DOUBLE, dtype=np.int8)
    support[40:60] = Support.LEFT
    soles[40:60, Side.RIGHT, 0] = np.linspace(0.0, 0.3, 20)
    soles[60:, Side.RIGHT, 0] = 0.3
    assert largest_slip(soles, resting(100), support, DT).distance == 0.0
    soles[50:, Side.LEFT, 1] += 0.004
    slip = largest_slip(soles, resting(100), support, DT)
    assert slip.distance == pytest.approx(0.004)
    assert (slip.side, slip.sample) == (Side.LEFT, 50)


def test_slip_leaves_touchdown_and_take_off_out():
    soles, support = resting(100), np.full(100, Support.DOUBLE, dtype=np.int8)
    support[40:60] = Support.LEFT
    soles[:39, Side.RIGHT, 0] = 0.0
    soles[39:61, Side.RIGHT, 0] = 0.02  # lifts a sample early and lands a sample late
    soles[61:, Side.RIGHT, 0] = 0.04
    assert largest_slip(soles, resting(100), support, DT).distance == 0.0


def test_slip_within_one_phase_is_the_farthest_point_of_the_path():
    soles, support = resting(100), np.full(100, Support.DOUBLE, dtype=np.int8)
    soles[:, Side.RIGHT, 0] = 0.01 * np.sin(np.linspace(0.0, 2.0 * np.pi, 100))
    slip = largest_slip(soles, resting(100), support, DT)
    # measured from 20 ms in, at the other side of the swing
    assert slip.distance == pytest.approx(0.01 + 0.01 * np.sin(2.0 * np.pi * 2 / 99), rel=0.01)


def test_travel_is_that_of_the_midpoint_and_of_the_mean_heading():
    soles = resting(3)
    soles[-1, :, 0] = [0.2, 0.4]
    soles[-1, :, 3:] = quat_xyzw_from_yaw([0.1, 0.3])
    np.testing.assert_allclose(travel(soles), [0.3, 0.0, 0.2], atol=1e-12)


def test_travel_takes_the_short_way_across_half_a_turn():
    soles = resting(2)
    soles[0, :, 3:] = quat_xyzw_from_yaw([np.pi - 0.05, np.pi - 0.05])
    soles[1, :, 3:] = quat_xyzw_from_yaw([-np.pi + 0.05, -np.pi + 0.05])
    assert travel(soles)[2] == pytest.approx(0.1)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.5, np.pi])
def test_angles_between_vectors_are_exact_near_zero_too(angle):
    a, b = np.array([0.0, 0.0, 1.0]), np.array([np.sin(angle), 0.0, np.cos(angle)])
    assert angle_between(a, b) == pytest.approx(angle, abs=1e-15)


def test_saturation_is_the_longest_time_in_a_row_across_blocks():
    effort = Effort(stall=np.array([1.0, 2.0]), dt=0.001)
    first = np.zeros((10, 2))
    first[2:4, 0], first[7:, 0] = -1.0, 1.0  # 2 steps, then 3 that go on in the next block
    effort.add(first)
    second = np.zeros((10, 2))
    second[:2, 0], second[5:9, 1] = 1.0, 2.0
    effort.add(second)
    effort.add(np.zeros((10, 2)))
    np.testing.assert_allclose(effort.saturation, [0.005, 0.004])
    np.testing.assert_allclose(effort.saturation_end, [0.012, 0.019])
    np.testing.assert_allclose(effort.peak, [1.0, 2.0])
    np.testing.assert_allclose(effort.rms, [np.sqrt(7 / 30), np.sqrt(16 / 30)])


def test_a_pause_breaks_a_saturation():
    effort = Effort(stall=np.ones(1), dt=0.001)
    for torque in (1.0, 0.5, 1.0):
        effort.add(np.full((4, 1), torque))
    np.testing.assert_allclose(effort.saturation, [0.004])
