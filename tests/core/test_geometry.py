"""Plane geometry against scipy, Pinocchio, complex numbers and brute force."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.optimize import linprog
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from mgs.core.geometry import (
    bump,
    compose_planar,
    convex_hull,
    cruise,
    polygon_margins,
    quat_multiply,
    quat_xyzw_from_rpy,
    quat_xyzw_from_yaw,
    quintic,
    rectangle_gap,
    rotate_planar,
    rotation_angles,
    rotations_from_quat_xyzw,
    sole_corners,
    wrap_angle,
    yaw_from_quat_xyzw,
)
from tests.support.strategies import numbers

ROUNDING = 1e-12  # a few hundred units in the last place of numbers near one
angles = numbers(-10.0, 10.0)
planar_poses = st.tuples(numbers(-2.0, 2.0), numbers(-2.0, 2.0), angles).map(np.array)
sizes = numbers(0.01, 0.5)


def random_quaternions(n: int, seed: int) -> np.ndarray:
    quat = np.random.default_rng(seed).normal(size=(n, 4))
    return quat / np.linalg.norm(quat, axis=1, keepdims=True)


# --- planar poses -----------------------------------------------------------------------------


@given(planar_poses, planar_poses)
def test_composing_planar_poses_is_multiplying_complex_numbers(pose, offset):
    place = complex(*pose[:2]) + np.exp(1j * pose[2]) * complex(*offset[:2])
    expected = [place.real, place.imag, pose[2] + offset[2]]
    assert_allclose(compose_planar(pose, offset), expected, atol=ROUNDING)


@given(planar_poses, planar_poses, planar_poses)
def test_composing_planar_poses_is_associative(a, b, c):
    left = compose_planar(compose_planar(a, b), c)
    right = compose_planar(a, compose_planar(b, c))
    assert_allclose(left, right, atol=ROUNDING)


def test_planar_functions_take_stacks_of_poses():
    rng = np.random.default_rng(0)
    poses, offset = rng.normal(size=(2, 5, 3)), rng.normal(size=3)
    stacked = compose_planar(poses, offset)
    assert stacked.shape == (2, 5, 3)
    assert_allclose(stacked[1, 3], compose_planar(poses[1, 3], offset), rtol=0)
    assert rotate_planar(poses[..., :2], poses[..., 2]).shape == (2, 5, 2)
    assert sole_corners(poses, 0.1, 0.06).shape == (2, 5, 4, 2)


def test_composing_leaves_its_arguments_alone():
    pose, offset = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])
    compose_planar(pose, offset)
    assert_allclose([pose, offset], [[1, 2, 3], [4, 5, 6]], rtol=0)


@given(angles)
def test_a_wrapped_angle_is_the_same_direction_within_half_a_turn(angle):
    wrapped = float(wrap_angle(angle))
    assert -np.pi <= wrapped < np.pi
    assert_allclose(np.exp(1j * wrapped), np.exp(1j * angle), atol=ROUNDING)


# --- rotations --------------------------------------------------------------------------------


def test_rotation_matrices_are_those_of_scipy():
    quat = random_quaternions(200, seed=1)
    expected = Rotation.from_quat(quat).as_matrix()
    assert_allclose(rotations_from_quat_xyzw(quat), expected, atol=ROUNDING)


@given(angles)
def test_a_yaw_becomes_the_quaternion_of_a_turn_about_z_and_comes_back(yaw):
    quat = quat_xyzw_from_yaw(yaw)
    turn = pin.utils.rotate("z", yaw)
    assert_allclose(rotations_from_quat_xyzw(quat), turn, atol=ROUNDING)
    assert_allclose(np.exp(1j * yaw_from_quat_xyzw(quat)), np.exp(1j * yaw), atol=ROUNDING)


def test_yaw_is_the_heading_of_the_turned_x_axis():
    quat = random_quaternions(200, seed=2)
    ahead = Rotation.from_quat(quat).apply([1.0, 0.0, 0.0])
    assert_allclose(yaw_from_quat_xyzw(quat), np.arctan2(ahead[:, 1], ahead[:, 0]), atol=1e-9)


def test_rotation_angles_are_the_lengths_of_pinocchio_logarithms():
    a, b = random_quaternions(200, seed=3), random_quaternions(200, seed=4)
    expected = [
        np.linalg.norm(pin.log3(Rotation.from_quat(p).as_matrix().T @ q))
        for p, q in zip(a, Rotation.from_quat(b).as_matrix(), strict=True)
    ]
    assert_allclose(rotation_angles(a, b), expected, atol=1e-7)  # log3 is that coarse near pi
    assert_allclose(rotation_angles(-a, b), rotation_angles(a, b), atol=ROUNDING)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-8, 1e-4, 1.0, 3.1])
def test_rotation_angles_keep_their_digits_near_zero(angle):
    a = random_quaternions(1, seed=5)[0]
    axis = np.array([1.0, -2.0, 2.0]) / 3.0
    b = (Rotation.from_quat(a) * Rotation.from_rotvec(angle * axis)).as_quat()
    # the quaternions themselves are rounded to 1e-16; an arc cosine would return 1e-8 here
    assert_allclose(rotation_angles(a, b), angle, rtol=1e-9, atol=1e-15)


def test_a_product_of_quaternions_is_that_of_scipy_and_of_pinocchio():
    a, b = random_quaternions(200, seed=6), random_quaternions(200, seed=7)
    found = quat_multiply(a, b)
    expected = (Rotation.from_quat(a) * Rotation.from_quat(b)).as_matrix()
    assert_allclose(Rotation.from_quat(found).as_matrix(), expected, atol=ROUNDING)
    for p, q, product in zip(a, b, found, strict=True):  # the sign too
        assert_allclose((pin.Quaternion(p) * pin.Quaternion(q)).coeffs(), product, atol=ROUNDING)


def test_a_product_of_quaternions_takes_stacks_beside_single_ones():
    stack, one = random_quaternions(6, seed=8).reshape(2, 3, 4), random_quaternions(1, seed=9)[0]
    assert quat_multiply(stack, one).shape == quat_multiply(one, stack).shape == (2, 3, 4)
    assert_allclose(quat_multiply(stack, one)[1, 2], quat_multiply(stack[1, 2], one), rtol=0)
    assert_allclose(quat_multiply(one, stack)[1, 2], quat_multiply(one, stack[1, 2]), rtol=0)


@given(angles, angles, angles)
def test_roll_pitch_and_yaw_turn_as_in_scipy_and_pinocchio(roll, pitch, yaw):
    quat = quat_xyzw_from_rpy([roll, pitch, yaw])
    assert np.linalg.norm(quat) == pytest.approx(1.0, abs=ROUNDING)
    found = Rotation.from_quat(quat).as_matrix()
    in_turn = Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_matrix()  # about turned axes
    assert_allclose(found, in_turn, atol=ROUNDING)
    assert_allclose(found, pin.rpy.rpyToMatrix(roll, pitch, yaw), atol=ROUNDING)


def test_a_yaw_alone_is_a_yaw_and_stacks_of_angles_are_turned_one_by_one():
    angles = np.random.default_rng(0).normal(size=(2, 5, 3))
    quat = quat_xyzw_from_rpy(angles)
    assert quat.shape == (2, 5, 4)
    assert_allclose(quat[1, 3], quat_xyzw_from_rpy(angles[1, 3]), rtol=0)
    assert_allclose(quat_xyzw_from_rpy([0.0, 0.0, 0.7]), quat_xyzw_from_yaw(0.7), atol=1e-15)


# --- blends -----------------------------------------------------------------------------------


@pytest.mark.parametrize(("blend", "ends"), [(quintic, (0.0, 1.0)), (bump, (0.0, 0.0))])
def test_a_blend_starts_and_ends_at_rest(blend, ends):
    """Its value leaves the end value like h^3, so that speed and acceleration vanish there."""
    for end, s, inward in ((ends[0], 0.0, 1.0), (ends[1], 1.0, -1.0)):
        for h in (1e-2, 1e-3):
            change = abs(float(blend(s + inward * h)) - end)
            assert change <= 64.0 * h**3  # the third derivative is 60 (quintic) and 384 (bump)


@pytest.mark.parametrize("blend", [quintic, bump])
def test_a_blend_stays_put_outside_its_interval(blend):
    assert_allclose(blend([-3.0, -1e-9]), float(blend(0.0)), rtol=0)
    assert_allclose(blend([1.0 + 1e-9, 7.0]), float(blend(1.0)), rtol=0)


def test_the_quintic_is_the_polynomial_of_its_six_boundary_conditions():
    powers = np.arange(6)

    def row(s: float, derivative: int) -> np.ndarray:
        factors = np.prod([powers - i for i in range(derivative)] or [np.ones(6)], axis=0)
        return factors * s ** np.maximum(powers - derivative, 0)

    conditions = np.array([row(s, d) for s in (0.0, 1.0) for d in range(3)])
    coefficients = np.linalg.solve(conditions, [0, 0, 0, 1, 0, 0])
    s = np.linspace(0.0, 1.0, 101)
    assert_allclose(quintic(s), np.polynomial.polynomial.polyval(s, coefficients), atol=1e-12)
    assert np.all(np.diff(quintic(s)) > 0.0)


@given(st.floats(0.05, 0.5))
def test_a_cruise_is_the_integral_of_its_trapezoid_with_smooth_flanks(ramp: float):
    s = np.linspace(0.0, 1.0, 20001)
    x = np.minimum(np.minimum(s, 1.0 - s) / ramp, 1.0)
    speed = x**2 * (3.0 - 2.0 * x) / (1.0 - ramp)
    integral = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) * s[1]
    assert_allclose(cruise(s, ramp), integral, atol=1e-6)
    assert_allclose(np.diff(cruise(s, ramp)).max() / s[1], 1.0 / (1.0 - ramp), rtol=1e-3)
    assert_allclose(cruise([-1.0, 0.0, 0.5, 1.0, 2.0], ramp), [0.0, 0.0, 0.5, 1.0, 1.0])


def test_the_bump_peaks_at_one_in_the_middle_and_is_symmetric():
    s = np.linspace(0.0, 1.0, 101)
    assert float(bump(0.5)) == 1.0 == bump(s).max()
    assert_allclose(bump(s), bump(1.0 - s), atol=ROUNDING)
    assert np.all(np.diff(bump(s[:51])) > 0.0)


# --- soles and hulls --------------------------------------------------------------------------


@given(planar_poses, sizes, sizes)
def test_sole_corners_are_the_rectangle_placed_in_the_plane(pose, length, width):
    corners = sole_corners(pose, length, width)
    placed = pin.SE3(pin.utils.rotate("z", pose[2]), np.array([*pose[:2], 0.0]))
    expected = [
        (placed * np.array([0.5 * sx * length, 0.5 * sy * width, 0.0]))[:2]
        for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))
    ]
    assert_allclose(corners, expected, atol=ROUNDING)
    x, y = corners.T
    shoelace = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    assert_allclose(shoelace, length * width, atol=ROUNDING)  # positive: counter-clockwise


@pytest.mark.parametrize("seed", range(20))
def test_the_hull_is_the_one_of_qhull(seed):
    points = np.random.default_rng(seed).normal(size=(4 + 3 * seed, 2))
    hull = convex_hull(points)
    expected = points[ConvexHull(points).vertices]  # counter-clockwise in the plane, too
    start = int(np.argmin(np.linalg.norm(expected - hull[0], axis=1)))
    assert_allclose(hull, np.roll(expected, -start, axis=0), rtol=0)


@given(st.lists(st.tuples(st.integers(-3, 3), st.integers(-3, 3)), min_size=1, max_size=25))
def test_a_hull_has_only_true_corners_and_holds_every_point(points):
    """Small whole numbers: collinear and repeated points abound, cross products are exact."""
    hull = convex_hull(points)
    if np.linalg.matrix_rank(np.subtract(points, points[0])) < 2:
        assert len(hull) <= 2
        assert {tuple(p) for p in hull} <= {tuple(map(float, p)) for p in points}
        return
    edges = np.roll(hull, -1, axis=0) - hull
    turns = edges[:, 0] * np.roll(edges[:, 1], -1) - edges[:, 1] * np.roll(edges[:, 0], -1)
    assert np.all(turns > 0.0)
    assert np.all(polygon_margins(points, hull) >= 0.0)
    area = ConvexHull(points).volume
    x, y = hull.T
    assert_allclose(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)), area, rtol=1e-12)


@pytest.mark.parametrize("points", [[[1, 2]], [[1, 2], [1, 2]], [[0, 0], [2, 2], [1, 1], [0, 0]]])
def test_the_hull_of_points_on_a_line_is_its_ends(points):
    expected = {(1.0, 2.0)} if points[0] == [1, 2] else {(0.0, 0.0), (2.0, 2.0)}
    assert {tuple(p) for p in convex_hull(points)} == expected


# --- margins and gaps -------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(10))
def test_margins_are_the_distances_to_the_edge(seed):
    """Inside by the half planes of Qhull, outside by the nearest of many points on the edge."""
    rng = np.random.default_rng(seed)
    cloud = rng.normal(size=(12, 2))
    polygon, half_planes = convex_hull(cloud), ConvexHull(cloud).equations
    points = rng.uniform(-3.0, 3.0, size=(300, 2))
    signed = -(points @ half_planes[:, :2].T + half_planes[:, 2]).max(axis=1)
    margins = polygon_margins(points, polygon)
    inside = signed >= 0.0
    assert inside.any()
    assert_allclose(margins[inside], signed[inside], atol=1e-12)
    s = np.linspace(0.0, 1.0, 4001)[:, None, None]
    edge = ((1.0 - s) * polygon + s * np.roll(polygon, -1, axis=0)).reshape(-1, 2)
    nearest = np.array([np.linalg.norm(edge - p, axis=1).min() for p in points[~inside]])
    # points 1.5 mm apart on an edge miss the nearest by less than that
    assert_allclose(-margins[~inside], nearest, atol=2e-3)
    assert np.all(-margins[~inside] <= nearest + 1e-12)


@given(planar_poses, sizes, sizes, planar_poses)
def test_a_margin_belongs_to_the_point_and_not_to_the_world(sole, length, width, world):
    rng = np.random.default_rng(0)
    points = rng.uniform(-2.5, 2.5, size=(20, 2))
    moved = compose_planar(world, sole)
    placed = world[:2] + rotate_planar(points, world[2])
    here = polygon_margins(points, sole_corners(sole, length, width))
    there = polygon_margins(placed, sole_corners(moved, length, width))
    assert_allclose(there, here, atol=1e-11)


@given(sizes, sizes, sizes, sizes, numbers(-1.0, 1.0), numbers(-1.0, 1.0))
def test_the_gap_of_two_upright_rectangles_is_the_wider_of_the_two_axes(la, wa, lb, wb, x, y):
    a, b = sole_corners([0.0, 0.0, 0.0], la, wa), sole_corners([x, y, 0.0], lb, wb)
    expected = max(abs(x) - 0.5 * (la + lb), abs(y) - 0.5 * (wa + wb))
    assert_allclose(rectangle_gap(a, b), expected, atol=ROUNDING)


@pytest.mark.parametrize("seed", range(40))
def test_the_gap_is_negative_exactly_when_the_rectangles_share_a_point(seed):
    """The oracle asks a linear programme for one point in both."""
    rng = np.random.default_rng(seed)
    a = sole_corners(rng.uniform(-0.1, 0.1, 3), *rng.uniform(0.05, 0.2, 2))
    b = sole_corners([*rng.uniform(-0.15, 0.15, 2), rng.uniform(-3, 3)], *rng.uniform(0.05, 0.2, 2))
    planes = np.concatenate([ConvexHull(a).equations, ConvexHull(b).equations])
    shared = linprog([0, 0], A_ub=planes[:, :2], b_ub=-planes[:, 2], bounds=(None, None))
    gap = rectangle_gap(a, b)
    assert (gap < 0.0) == shared.success
    assert_allclose(rectangle_gap(b, a), gap, atol=ROUNDING)
    if gap > 0.0:  # no corner of one is nearer to the other than the gap
        assert -polygon_margins(a, b).max() >= gap - ROUNDING
        assert -polygon_margins(b, a).max() >= gap - ROUNDING
