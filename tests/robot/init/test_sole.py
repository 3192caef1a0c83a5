"""Tests of the contact rectangle of a foot, for any orientation of the axes of its body."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mgs.robot.init.sole import find_sole

angle = st.floats(-np.pi, np.pi)


@given(
    rpy=st.tuples(angle, angle, angle),
    tilt=st.floats(np.deg2rad(2.0), np.deg2rad(20.0)) | st.just(0.0),
    length=st.floats(0.1, 0.3),
    width=st.floats(0.05, 0.15),
)
def test_a_box_stands_on_its_lower_face(
    rpy: tuple[float, float, float], tilt: float, length: float, width: float
):
    """The toes of the standing robot point up by `tilt`; the axes of the body are arbitrary."""
    corners = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T * [length, width, 0.04]
    T_base_foot = pin.SE3(pin.rpy.rpyToMatrix(0.0, -tilt, 0.0), np.array([0.1, 0.2, -0.7]))
    T_base_body = pin.SE3(pin.rpy.rpyToMatrix(*rpy), np.array([0.05, 0.2, -0.6]))
    in_body = np.array([T_base_body.actInv(T_base_foot.act(corner)) for corner in corners])
    sole = find_sole(in_body, T_base_body)
    assert (sole.length, sole.width) == pytest.approx((length, width), abs=1e-6)
    expected = T_base_foot * pin.SE3(np.eye(3), np.array([0.0, 0.0, -0.02]))
    error = (T_base_body * sole.placement).actInv(expected)
    assert np.linalg.norm(error.translation) < 1e-6
    assert np.linalg.norm(pin.log3(error.rotation)) < 1e-6
