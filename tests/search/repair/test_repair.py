"""Repair: its linear algebra against dense solutions, and motions damaged in all ways at once."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from damaged_motions import damaged, undamaged

from mgs.core.contact import Side
from mgs.core.errors import MgsError
from mgs.judge.audit.body import body_along
from mgs.motion.dynamics import zmp_at
from mgs.robot import leg_length
from mgs.search.repair import GOALS, figures_of, link_distance, repair
from mgs.search.repair.band import smooth, solve_blocks
from mgs.search.repair.constraints import Constraints
from mgs.search.repair.linear import Linear
from mgs.search.repair.ranges import bridged, clipped
from mgs.search.repair.stances import planar_places, stances_of, standing_soles


def test_blocks_are_solved_as_the_dense_matrix():
    rng, n, p = np.random.default_rng(0), 7, 3
    half = np.zeros((n * p, n * p))
    for k in range(n):
        for d in range(3):
            if k + d < n:
                half[(k + d) * p : (k + d + 1) * p, k * p : (k + 1) * p] = rng.normal(size=(p, p))
    A = half + half.T + 30.0 * np.eye(n * p)
    blocks = np.zeros((3, n, p, p))
    for d in range(3):
        for k in range(n - d):
            blocks[d, k] = A[(k + d) * p : (k + d + 1) * p, k * p : (k + 1) * p]
    g = rng.normal(size=(n, p))
    np.testing.assert_allclose(
        solve_blocks(blocks, g).ravel(), np.linalg.solve(A, g.ravel()), atol=1e-12
    )


def test_smoothing_is_the_least_squares_solution():
    values = np.random.default_rng(1).normal(size=(20, 2))
    D = np.diff(np.eye(20), n=3, axis=0)
    dense = np.linalg.solve(np.eye(20) + 5.0 * D.T @ D, values)
    np.testing.assert_allclose(smooth(values, 5.0), dense, atol=1e-12)


def test_jacobians_of_soles_and_corners_are_finite_differences():
    given = undamaged("melson/walk_practical", 50.0)
    given = dataclasses.replace(given, q=given.q[60:70])
    body = body_along(given, 0.0)
    stands = standing_soles(body, given.dt, leg_length(given.robot))
    constraints = Constraints(
        given.robot, stances_of(stands, planar_places(body.soles, body.turns)), given.dt
    )
    jacobians = constraints.jacobians(given.q)
    corners = constraints.corner_jacobians(jacobians, body)
    step = 1e-6
    for i in range(given.robot.model.nv):
        way = np.zeros(given.robot.model.nv)
        way[i] = step
        moved = np.array([pin.integrate(given.robot.model, q, way) for q in given.q])
        there = body_along(dataclasses.replace(given, q=moved), 0.0)
        found = (there.corners[..., 2] - body.corners[..., 2]) / step
        np.testing.assert_allclose(corners[..., i], found, atol=1e-5)
        found = (there.soles - body.soles) / step
        np.testing.assert_allclose(jacobians.soles[:, :, :3, i], found, atol=1e-5)


def test_jacobians_of_the_zmp_are_finite_differences():
    given = undamaged("melson/walk_practical", 50.0)
    given = dataclasses.replace(given, q=given.q[60:68])
    body, model = body_along(given, 0.0), given.robot.model
    stands = np.ones((given.n_samples, 2), dtype=bool)
    planar = planar_places(body.soles, body.turns)
    constraints = Constraints(given.robot, stances_of(stands, planar), given.dt)
    k, step = 4, 1e-6
    jacobians = constraints.zmp_jacobians(constraints.jacobians(given.q), body, np.array([k]))

    def zmp(q: np.ndarray) -> np.ndarray:
        there = body_along(dataclasses.replace(given, q=q), 0.0)
        return zmp_at(there.wrench, np.zeros(len(q)))[k]

    for neighbour, found in zip((-1, 0, 1), jacobians, strict=True):
        expected = np.empty((2, model.nv))
        for i in range(model.nv):
            way, q = np.zeros(model.nv), given.q.copy()
            way[i] = step
            q[k + neighbour] = pin.integrate(model, q[k + neighbour], way)
            expected[:, i] = (zmp(q) - zmp(given.q)) / step
        gap = np.linalg.norm(found[0] - expected) / np.linalg.norm(expected)
        assert gap < 1e-3  # the Jacobian takes the angular momentum at k for that of its sample


def test_a_step_counts_the_inequalities_that_it_would_violate():
    """The step is the solution of the quadratic program with its penalties, by its own residual."""
    given = undamaged("melson/walk_practical", 50.0)
    given = dataclasses.replace(given, q=given.q[60:72])
    body = body_along(given, 0.0)
    stands = standing_soles(body, given.dt, leg_length(given.robot))
    stances = stances_of(stands, planar_places(body.soles, body.turns))
    constraints = Constraints(given.robot, stances, given.dt)
    shifted = vars(constraints.residuals(given, body))
    linear = Linear(constraints, given.q, body, shifted)
    p = given.robot.model.nv
    blocks = np.zeros((3, given.n_samples, p, p))
    blocks[0] = np.eye(p)
    pull = np.zeros((given.n_samples, p))
    pull[:, 2] = 0.02  # down, so that the sole that swings would be below the floor
    weights = {"floor": 1e4, "range": 1e2, "speed": 1e2, "zmp": 1e-4}
    step = linear.step(blocks, pull, weights)

    def penalised(x: np.ndarray) -> float:
        values = linear.values(x)
        cost = 0.5 * float(np.sum(x**2)) + float(np.sum(pull * x))
        return cost + sum(
            0.5 * weights[name] * float(np.sum(np.maximum(r, 0.0) ** 2))
            for name, r in values.items()
        )

    least = penalised(step)
    rng = np.random.default_rng(0)
    for size in (1e-2, 1e-3, 1e-4):
        for _ in range(20):
            assert penalised(step + size * rng.normal(size=step.shape)) > least


def test_a_joint_is_bridged_over_its_whole_way_out_of_its_range():
    robot = undamaged("melson/squat", 50.0).robot
    t = np.linspace(0.0, 4.0, 201)
    meant = 0.05 * np.sin(t)
    bend = np.clip(1.0 - np.abs(t - 2.0) / 0.3, 0.0, 1.0)
    joints = np.tile(0.5 * (robot.lower + robot.upper), (len(t), 1))
    centre = joints[0, 0]
    joints[:, 0] = centre + meant
    wrong = joints.copy()
    wrong[:, 0] += (robot.upper[0] - centre + 0.1) * bend * bend * (3.0 - 2.0 * bend)
    found = bridged(robot, wrong)
    np.testing.assert_allclose(found[:, 1:], joints[:, 1:], atol=0.0)
    assert np.abs(found[:, 0] - joints[:, 0]).max() < 0.02
    assert np.abs(clipped(robot, wrong)[:, 0] - joints[:, 0]).max() > 0.3


def test_stances_are_found_under_a_base_that_sinks_and_slides():
    given = undamaged("melson/walk_arc", 50.0)
    q = given.q.copy()
    q[:, 2] -= 0.03
    q[:, 0] += 0.05 * given.dt * np.arange(len(q))
    wrong = dataclasses.replace(given, q=q)
    leg = leg_length(given.robot)
    expected = standing_soles(body_along(given), given.dt, leg)
    body = body_along(wrong)
    found = standing_soles(body, given.dt, leg)
    assert np.mean(found != expected) < 0.01
    places = stances_of(found, planar_places(body.soles, body.turns)).places
    true = planar_places(body_along(given).soles, body_along(given).turns)
    for side in Side:  # the sliding of 0.4 m is taken out but for a tenth, as the weights have it
        stand = found[:, side]
        gap = (places - true)[stand, side, :2]
        assert np.ptp(gap, axis=0).max() < 0.04


@pytest.mark.parametrize("name", ["melson/walk_practical", "melson/squat", "coman/bow"])
def test_a_motion_damaged_in_all_ways_holds_again(name: str):
    given = undamaged(name, 50.0)
    bad = damaged(given, np.random.default_rng(1))
    before = figures_of(bad)
    assert before.penetration > 0.025 and before.range_excess > 0.01 and before.jitter > 0.01
    result = repair(bad)
    after = result.after
    assert result.left == (), after
    assert after.penetration <= GOALS["penetration"] and after.slip <= GOALS["slip"]
    assert link_distance(result.motion, given) < 0.03
    assert link_distance(result.motion, given) < 0.5 * link_distance(bad, given)


def test_a_motion_that_holds_is_hardly_changed():
    given = undamaged("melson/walk_practical", 50.0)
    result = repair(given)
    assert result.left == () and result.moved < 2e-3


def test_a_robot_on_other_parts_than_its_soles_is_not_repaired():
    given = undamaged("melson/squat", 50.0)
    q = given.q.copy()
    q[:, 3:7], q[:, 2] = [0.7071067811865476, 0.0, 0.0, 0.7071067811865476], 0.04
    with pytest.raises(MgsError, match="other parts than the soles bear"):
        repair(dataclasses.replace(given, q=q))
