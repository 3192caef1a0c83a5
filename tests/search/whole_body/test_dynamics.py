"""Dynamics along a motion and their derivatives, against forward dynamics and differences."""

from __future__ import annotations

import itertools

import numpy as np
import pinocchio as pin
import pytest

import mgs
from mgs.core.arrays import Array
from mgs.core.constants import GRAVITY
from mgs.core.contact import Side
from mgs.search.whole_body.dynamics import Point, offsets, point_at, slopes_at, soles_of
from mgs.search.whole_body.problem import Problem, Weights, bearing
from mgs.search.whole_body.unknowns import N_PRESS, unknowns_of

PART = slice(95, 125, 3)  # of a walk: single support, then double support
STEP = 1e-6


@pytest.fixture(scope="module")
def problem() -> Problem:
    motion = mgs.generate("melson", "melson/walk_practical", walk__n_steps=2, walk__lead_in=0.3)
    support = motion.support[PART]
    assert len(set(support)) == 2
    return Problem(
        motion.robot, 3 * motion.dt, motion.q[PART], motion.soles[PART], bearing(support),
        Weights(), margin=0.005,
    )  # fmt: skip


@pytest.fixture(scope="module")
def point(problem: Problem) -> Point:
    """A motion apart from the plan, with its soles in place."""
    rng = np.random.default_rng(5)
    step = 0.05 * rng.standard_normal((problem.n_samples, problem.nv))
    step[[0, -1]] = 0.0
    q = [pin.integrate(problem.robot.model, a, d) for a, d in zip(problem.plan, step, strict=True)]
    return point_at(problem, np.array(q))


def moved(problem: Problem, q: Array, direction: Array, size: float) -> Array:
    model = problem.robot.model
    return np.array([
        pin.integrate(model, a, size * d) for a, d in zip(q, direction, strict=True)
    ])  # fmt: skip


def test_forward_dynamics_by_torques_and_wrenches_give_the_accelerations(
    problem: Problem, point: Point
):
    robot = problem.robot
    model = robot.model.copy()
    model.armature = np.concatenate([np.zeros(6), robot.armature])
    data = model.createData()
    for k in range(problem.n_samples):
        external = [pin.Force.Zero() for _ in range(model.njoints)]
        for side in Side:
            frame = model.frames[robot.sole_frames[side]]
            external[frame.parentJoint] = frame.placement.act(pin.Force(point.w[k, side]))
        tau = np.concatenate([np.zeros(6), point.torque[k]])
        a = pin.aba(model, data, point.q[k], point.v[k], tau, external)
        np.testing.assert_allclose(a, point.a[k], atol=1e-6 * np.abs(point.a).max())


def test_soles_are_in_place_and_those_in_the_air_bear_nothing(problem: Problem, point: Point):
    assert np.abs(soles_of(problem, point.q)[0]).max() < 1e-7
    assert not point.w[~problem.bears].any()
    assert np.abs(point.q[1:-1] - problem.plan[1:-1]).max() > 1e-2


def test_slopes_are_those_of_differences(problem: Problem, point: Point):
    rng = np.random.default_rng(6)
    direction = rng.standard_normal((problem.n_samples, problem.nv))
    slopes = slopes_at(problem, point)

    def at(size: float) -> tuple[Array, Array, Array, Array]:
        """Forces with the wrenches of `point`, offsets of torso and hands, and of the soles."""
        q = moved(problem, point.q, direction, size)
        force = lacking_force(problem, q, point.w)
        _, torso, hands = offsets(problem, q)
        return force, torso, hands, soles_of(problem, q)[0]

    differences = [(b - a) / (2 * STEP) for a, b in zip(at(-STEP), at(STEP), strict=True)]
    force = np.einsum("kij,kj->ki", slopes.force[1], direction)
    force[1:] += np.einsum("kij,kj->ki", slopes.force[0, 1:], direction[:-1])
    force[:-1] += np.einsum("kij,kj->ki", slopes.force[2, :-1], direction[1:])
    for value, J in (
        (differences[1], slopes.torso), (differences[2], slopes.hands),
        (differences[3], slopes.soles),
    ):  # fmt: skip
        np.testing.assert_allclose(np.einsum("k...j,kj->k...", J, direction), value, atol=1e-5)
    np.testing.assert_allclose(force, differences[0], atol=2e-6 * np.abs(force).max())


def lacking_force(problem: Problem, q: Array, w: Array) -> Array:
    """Inverse dynamics less the wrenches, sample by sample."""
    robot, h = problem.robot, problem.h
    model, data = robot.model, robot.model.createData()
    v = np.zeros((len(q) + 1, problem.nv))
    v[1:-1] = [pin.difference(model, a, b) / h for a, b in itertools.pairwise(q)]
    a = np.diff(v, axis=0) / h
    force = np.empty((len(q), problem.nv))
    for k in range(len(q)):
        external = [pin.Force.Zero() for _ in range(model.njoints)]
        for side in Side:
            frame = model.frames[robot.sole_frames[side]]
            external[frame.parentJoint] = frame.placement.act(pin.Force(w[k, side]))
        force[k] = pin.rnea(model, data, q[k], v[k], a[k], external)
        force[k, 6:] += robot.armature * a[k, 6:]
    return force


def test_moves_keep_the_soles_and_the_dynamics_of_the_base(problem: Problem, point: Point):
    """Torques are those of inverse dynamics too, all to first order in the unknowns."""
    rng = np.random.default_rng(8)
    unknowns = unknowns_of(problem, point, slopes_at(problem, point))
    y = rng.standard_normal((problem.n_samples, unknowns.moves.count))
    s = rng.standard_normal((problem.n_samples, N_PRESS))
    y[[0, -1]] = 0.0
    less = point.w.reshape(-1, 12) / unknowns.wrench_units - unknowns.wrench.constant
    s_now = (unknowns.wrench.by_press.transpose(0, 2, 1) @ less[..., None])[..., 0]
    unit = problem.robot.mass * GRAVITY * problem.leg

    def at(size: float) -> tuple[Array, Array]:
        """What the base lacks and how torques differ, and how far soles are from their places."""
        q = moved(problem, point.q, unknowns.moves.changes(y), size)
        w = unknowns.wrench.at(size * y, s_now + size * s) * unknowns.wrench_units
        force = lacking_force(problem, q, w.reshape(-1, 2, 6))
        force[:, 6:] -= unit * unknowns.torque.at(size * y, s_now + size * s)
        assert not w.reshape(-1, 2, 6)[~problem.bears].any()
        return force, soles_of(problem, q)[0]

    force, off = ((b - a) / (2 * STEP) for a, b in zip(at(-STEP), at(STEP), strict=True))
    low, high = (
        lacking_force(problem, moved(problem, point.q, unknowns.moves.changes(y), d), point.w)
        for d in (-STEP, STEP)
    )
    size = np.abs(high - low).max() / (2 * STEP)
    np.testing.assert_allclose(force, 0.0, atol=2e-6 * size)
    np.testing.assert_allclose(off, 0.0, atol=1e-5)
    np.testing.assert_allclose(at(0.0)[0], 0.0, atol=1e-9 * unit)


def test_distances_of_links_change_as_their_rows_say(problem: Problem):
    rng = np.random.default_rng(7)
    q = problem.plan.copy()
    arm = [i for i, name in enumerate(problem.robot.joint_names) if "shoulder" in name]
    q[:, [7 + i for i in arm]] *= 0.2  # hands nearer to the thighs
    direction = rng.standard_normal((len(q), problem.nv))
    found = problem.clearance.along(q)
    low, high = (
        problem.clearance.along(moved(problem, q, direction, size)) for size in (-1e-5, 1e-5)
    )
    assert len(found.distance) == len(low.distance) == len(high.distance) > 10
    slope = np.sum(found.rows * direction[found.samples], axis=1)
    differences = (high.distance - low.distance) / 2e-5
    smooth = np.abs(high.distance + low.distance - 2 * found.distance) < 1e-9  # not at an edge
    assert smooth.sum() > 5
    np.testing.assert_allclose(slope[smooth], differences[smooth], atol=1e-3)
