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
from mgs.robot import leg_length
from mgs.search.repair import GOALS, figures_of, link_distance, repair
from mgs.search.repair.band import smooth, solve_blocks
from mgs.search.repair.constraints import Constraints
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
