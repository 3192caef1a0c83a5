"""Arrays over time against Pinocchio, one sample after the other."""

from __future__ import annotations

from types import SimpleNamespace

import coal
import numpy as np
import pinocchio as pin
import pytest
from clean_motions import shipped
from numpy.typing import NDArray

from mgs.judge.audit import given_by
from mgs.judge.audit.body import body_along
from mgs.judge.audit.contacts import AWAY, NEAR, find_contacts
from mgs.judge.audit.hulls import distance_outside
from mgs.judge.audit.joints import joint_torques
from mgs.judge.audit.rates import steps
from mgs.judge.audit.shapes import lowest_points
from mgs.judge.audit.smoothness import jump_sizes, noise
from mgs.judge.audit.tree import centre_of_mass, frame_poses, joint_poses
from mgs.motion import Motion
from mgs.robot import Robot, load_robot


@pytest.fixture(scope="module", params=["melson", "coman"])
def robot(request: pytest.FixtureRequest) -> Robot:
    return load_robot(request.param)


@pytest.fixture(scope="module")
def walk() -> Motion:
    return shipped("melson/walk_practical")


def random_q(robot: Robot, n: int) -> NDArray[np.float64]:
    rng = np.random.default_rng(1)
    q = np.zeros((n, 7 + robot.n))
    q[:, :3], q[:, 3:7] = rng.uniform(-1.0, 1.0, (n, 3)), rng.normal(size=(n, 4))
    q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1, keepdims=True)
    q[:, 7:] = rng.uniform(robot.lower, robot.upper, (n, robot.n))
    return q


def test_poses_and_centre_of_mass_are_those_of_pinocchio(robot: Robot):
    q = random_q(robot, 5)
    poses, data = joint_poses(robot, q), robot.model.createData()
    com = centre_of_mass(robot, poses)
    for k, row in enumerate(q):
        pin.framesForwardKinematics(robot.model, data, row)
        for joint in range(1, robot.model.njoints):
            np.testing.assert_allclose(poses.R[joint, k], data.oMi[joint].rotation, atol=1e-12)
            np.testing.assert_allclose(poses.p[joint, k], data.oMi[joint].translation, atol=1e-12)
        for frame in robot.sole_frames:
            R, p = frame_poses(robot, poses, frame)
            np.testing.assert_allclose(R[k], data.oMf[frame].rotation, atol=1e-12)
            np.testing.assert_allclose(p[k], data.oMf[frame].translation, atol=1e-12)
        np.testing.assert_allclose(com[k], pin.centerOfMass(robot.model, data, row), atol=1e-12)


def test_steps_are_pinocchios_differences_to_third_order(robot: Robot):
    q = random_q(robot, 1)[[0, 0]]
    step = 0.02 * np.random.default_rng(2).normal(size=robot.model.nv)
    q[1] = pin.integrate(robot.model, q[0], step)
    # the largest angle is about 0.05 rad; its fourth power, which is left out, is 6e-6 of a step
    np.testing.assert_allclose(steps(q)[0], step, atol=1e-6)


def test_the_lowest_point_of_a_shape_is_that_of_its_corners(robot: Robot):
    """All shapes of these robots are boxes, whose corners are known."""
    q = random_q(robot, 3)
    heights = lowest_points(robot, joint_poses(robot, q))
    data, placed = robot.model.createData(), robot.geometry.createData()
    for k, row in enumerate(q):
        pin.updateGeometryPlacements(robot.model, data, robot.geometry, placed, row)
        for g, item in enumerate(robot.geometry.geometryObjects):
            half = item.geometry.halfSide
            signs = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
            corners = [placed.oMg[g].act(half * sign)[2] for sign in signs]
            assert heights[k, g] == pytest.approx(min(corners), abs=1e-12)


@pytest.mark.parametrize(
    ("shape", "lowest"),
    [
        (coal.Sphere(0.2), -0.2),
        (coal.Capsule(0.1, 0.6), -0.4),
        (coal.Cylinder(0.1, 0.6), -0.3),
    ],
)
def test_round_shapes_have_the_lowest_points_of_their_forms(shape: object, lowest: float):
    robot = load_robot("melson")
    item = pin.GeometryObject("round", 1, 0, pin.SE3.Identity(), shape)
    only = pin.GeometryModel()
    only.addGeometryObject(item)
    q = np.zeros((1, 7 + robot.n))
    q[0, 6] = 1.0
    poses = joint_poses(robot, q)
    alone = SimpleNamespace(geometry=only)
    assert lowest_points(alone, poses)[0, 0] == pytest.approx(lowest)


def test_distances_from_a_hull_are_those_of_a_square():
    corners = np.broadcast_to([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], (4, 4, 2))
    points = np.array([[0.5, 0.5], [1.5, 0.5], [2.0, 2.0], [0.5, 0.9]])
    used = np.ones((4, 4), dtype=bool)
    expected = [-0.5, 0.5, np.sqrt(2.0), -0.1]
    np.testing.assert_allclose(distance_outside(points, corners, used), expected, rtol=2e-3)
    assert distance_outside(points, corners, np.zeros((4, 4), dtype=bool)).max() == -np.inf


def test_contacts_are_those_that_were_planned(walk: Motion):
    """A swing foot skims the floor before and after its swing, which counts as contact."""
    given = given_by(walk)
    body = body_along(given)
    contacts = find_contacts(given, body)
    planned = np.stack([walk.support != 2, walk.support != 1], axis=1)
    assert not np.any(planned & ~contacts.soles)
    assert body.clearance.min(axis=2)[contacts.soles & ~planned].max() < AWAY
    assert body.clearance.min(axis=2)[~contacts.soles].min() > NEAR
    bears = np.stack([walk.support == 1, walk.support == 2], axis=1)
    late = np.flatnonzero((bears & ~contacts.bearing).any(axis=1))
    assert len(late) < 0.02 * len(walk.support)


def test_torques_in_single_support_are_those_of_the_plan(walk: Motion):
    """The plan has Jacobians of Pinocchio; in double support it shares the load in its own way."""
    given = given_by(walk)
    body = body_along(given, smoothing=0.0)
    torque = joint_torques(given, body, find_contacts(given, body))
    single = (walk.support != 0) & (find_contacts(given, body).soles.sum(axis=1) == 1)
    single[[0, -1]] = False
    assert single.sum() > 100
    np.testing.assert_allclose(torque[single], walk.torque[single], atol=1e-6)


def test_noise_is_told_from_a_smooth_motion():
    rng, t = np.random.default_rng(3), 0.01 * np.arange(1000)
    smooth = np.sin(2.0 * np.pi * 2.0 * t)[:, None]
    assert noise(np.diff(smooth, axis=0), 0.01).max() == 0.0
    rough = smooth + rng.normal(0.0, 0.01, smooth.shape)
    found = noise(np.diff(rough, axis=0), 0.01)
    assert np.median(found) == pytest.approx(0.01, rel=0.1)


def test_a_jump_is_measured_on_top_of_the_motion():
    t = 0.01 * np.arange(300)
    q = np.sin(2.0 * np.pi * t)[:, None]
    q[150:] += 0.2
    sizes, ratios = jump_sizes(np.diff(q, axis=0))
    assert sizes[149, 0] == pytest.approx(0.2, abs=1e-3)
    assert np.flatnonzero(ratios[:, 0] * (sizes[:, 0] > 0.01) > 5.0).tolist() == [149]
