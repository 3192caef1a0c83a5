"""Boxes on the ground against points tried one by one."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.core.geometry import rectangle_gap, rectangle_gaps, sole_corners
from mgs.core.limits import MAX_CROWD
from mgs.core.scene import PLACE, Box, ground_below, is_crowded

ROUNDING = 1e-9
coordinate = st.floats(-0.3, 0.3)
boxes = st.builds(
    Box,
    x=coordinate,
    y=coordinate,
    yaw=st.floats(-4.0, 4.0),
    length=st.floats(0.01, 0.4),
    width=st.floats(0.01, 0.4),
    height=st.floats(0.01, 0.2),
)


def covers(box: Box, points: np.ndarray) -> np.ndarray:
    """Whether points (m, 2), as complex numbers in the box's frame, lie inside it."""
    local = ((points[:, 0] - box.x) + 1j * (points[:, 1] - box.y)) * np.exp(-1j * box.yaw)
    return (np.abs(local.real) < box.length / 2) & (np.abs(local.imag) < box.width / 2)


@given(st.lists(boxes, max_size=3), coordinate, coordinate, st.floats(-4.0, 4.0))
def test_a_sole_covers_the_boxes_that_any_of_its_points_covers(found, x, y, yaw):
    corners = sole_corners([x, y, yaw], 0.1, 0.06)
    u, v = np.meshgrid(np.linspace(0, 1, 41), np.linspace(0, 1, 41))
    points = corners[0] + np.stack([u.ravel(), v.ravel()], axis=1) @ np.array(
        [corners[1] - corners[0], corners[3] - corners[0]]
    )
    tops = [box.height for box in found if covers(box, points).any()]
    height = float(ground_below(tuple(found), corners))
    assert height >= max(tops, default=0.0)
    if height > max(tops, default=0.0):  # a sliver between the points of the grid
        box = next(box for box in found if box.height == height)
        assert rectangle_gap(corners, box.corners) > -0.004


@given(st.lists(boxes, min_size=2, max_size=5))
def test_many_gaps_at_once_are_those_of_each_pair(found):
    corners = np.array([box.corners for box in found])
    expected = [rectangle_gap(c, found[0].corners) for c in corners]
    assert_allclose(rectangle_gaps(corners, found[0].corners), expected, atol=ROUNDING)
    swapped = [rectangle_gap(found[0].corners, c) for c in corners]
    assert_allclose(expected, swapped, atol=ROUNDING)


SIDES = st.sampled_from([0.0123, 0.0617])  # no two boxes are exactly PLACE apart
squares = st.lists(
    st.builds(
        Box,
        x=st.integers(-20, 20).map(lambda n: 0.025 * n),
        y=st.integers(-20, 20).map(lambda n: 0.025 * n),
        yaw=st.just(0.0),
        length=SIDES,
        width=SIDES,
        height=st.just(0.01),
    ),
    min_size=MAX_CROWD,
    max_size=150,
)


@given(squares)
def test_boxes_are_crowded_where_a_square_touches_too_many_of_them(many: list[Box]):
    """Squares are tried at every place at which a box begins."""
    half = np.array([[box.length / 2, box.width / 2] for box in many])
    centre = np.array([[box.x, box.y] for box in many])
    low, high = centre - half, centre + half
    touched = [
        ((low[:, k] <= begin + PLACE) & (begin <= high[:, k]))
        for k in range(2)
        for begin in low[:, k]
    ]
    across, along = np.array(touched, dtype=int).reshape(2, len(many), len(many))
    assert is_crowded(many) == ((across @ along.T).max() > MAX_CROWD)
