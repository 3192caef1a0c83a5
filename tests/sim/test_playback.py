"""How a motion is turned into targets, and how a robot is put down."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from mgs.core.geometry import sole_corners
from mgs.sim.poses import fallen, on_ground, poses_along
from mgs.sim.targets import Targets
from tests.support.motions import DT, motion_of, standing


def test_targets_follow_a_cubic_exactly(melson):
    """Oracle: a polynomial of third degree is its own cubic interpolant."""
    t, fine = np.arange(21) * DT, np.arange(1, 201) * DT / 10
    q = np.tile(melson.standing_q, (21, 1))
    q[:, 10] += 3.0 * t**3 - t**2 + 0.5 * t
    motion = motion_of(melson, q)
    motion.v[:, 9] = 9.0 * t**2 - 2.0 * t + 0.5
    targets = Targets(motion, n_steps=10)
    blocks = [targets.before(k) for k in range(1, 21)]
    position = np.concatenate([block[0] for block in blocks])[:, 3]
    velocity = np.concatenate([block[1] for block in blocks])[:, 3]
    expected = melson.standing_q[10] + 3.0 * fine**3 - fine**2 + 0.5 * fine
    np.testing.assert_allclose(position, expected, atol=1e-12)
    np.testing.assert_allclose(velocity, 9.0 * fine**2 - 2.0 * fine + 0.5, atol=1e-10)


def test_targets_hold_the_last_sample_after_the_end(melson):
    motion = standing(melson, 0.1)
    position, velocity = Targets(motion, n_steps=5).before(11)
    np.testing.assert_array_equal(position, np.tile(melson.standing_q[7:], (5, 1)))
    np.testing.assert_array_equal(velocity, 0.0)


@pytest.mark.parametrize("roll", [-0.2, 0.0, 0.3])
def test_the_lowest_corner_of_a_sole_is_put_on_the_ground(melson, roll):
    q = melson.standing_q.copy()
    q[:7] = pin.SE3ToXYZQUAT(pin.SE3(pin.rpy.rpyToMatrix(roll, 0.1, 0.4), np.array([0, 0, 0.5])))
    q = on_ground(melson, q)
    data = melson.model.createData()
    pin.framesForwardKinematics(melson.model, data, q)
    corners = np.pad(sole_corners(np.zeros(3), 0.106, 0.06), ((0, 0), (0, 1)))
    heights = [
        (data.oMf[frame].act(corner))[2] for frame in melson.sole_frames for corner in corners
    ]
    assert min(heights) == pytest.approx(0.0, abs=1e-12)


def test_a_turn_about_the_vertical_is_no_fall(melson):
    q = melson.standing_q.copy()
    q[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(0.0, 0.0, 3.0)).coeffs()
    _, up = poses_along(melson, np.stack([q, melson.standing_q]))
    assert not fallen(up[0], up[1], q[2], melson.standing_q[2])


@pytest.mark.parametrize(("tilt", "height", "expected"), [(44, 1.0, False), (46, 1.0, True)])
def test_a_robot_is_down_beyond_45_degrees(tilt, height, expected):
    up = np.array([np.sin(np.radians(tilt)), 0.0, np.cos(np.radians(tilt))])
    assert fallen(up, np.array([0.0, 0.0, 1.0]), height, 1.0) == expected


@pytest.mark.parametrize(("height", "expected"), [(0.61, False), (0.59, True)])
def test_a_robot_is_down_below_60_percent_of_its_height(height, expected):
    up = np.array([0.0, 0.0, 1.0])
    assert fallen(up, up, height, 1.0) == expected
