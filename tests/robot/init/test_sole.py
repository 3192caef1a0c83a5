"""Tests of the contact rectangle of a foot, for any orientation of the axes of its body."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mgs.robot.init.posture import stance_width
from mgs.robot.init.sole import Sole, find_sole

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


def test_soles_that_overlap_at_rest_stand_apart():
    """Soles 0.16 m wide, 0.14 m apart at rest; others stand as at rest or narrower."""

    def width_of_stance(width: float, apart: float) -> float:
        sole = Sole(pin.SE3.Identity(), 0.06, width)
        rest = [pin.SE3(np.eye(3), np.array([0.0, y, 0.0])) for y in (0.5 * apart, -0.5 * apart)]
        return stance_width(rest, (sole, sole), 0.6)

    assert width_of_stance(0.16, 0.14) == pytest.approx(1.3 * 0.16)
    assert width_of_stance(0.13, 0.14) == pytest.approx(0.14)
    assert width_of_stance(0.08, 0.40) == pytest.approx(0.35 * 0.6)
