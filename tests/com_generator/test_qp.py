"""The QP with the support polygon as bound: closed form, KKT conditions, polygons of its own."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import lsq_linear
from scipy.spatial import ConvexHull

from mgs.com_generator import ComTrajectory, generate_com
from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError, InfeasibleGaitError, MgsError, ZmpMarginError
from mgs.core.geometry import polygon_margins
from mgs.gait import ComParameters, load_gait
from mgs.gait.remedies import remedies_for
from mgs.motion_planner import plan_motion
from mgs.pipeline import run_stages
from mgs.robot import Robot, load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories
from tests.support.polygons import support_hull
from tests.support.strategies import numbers, walk_gait

GRAVITY = 9.81
WALKS = ["melson/walk_practical", "melson/walk_arc", "coman/walk"]
LEVEL = [0.0, 0.0, 0.0, 1.0]  # quaternion xyzw


def tasks_of(robot: Robot, **walk: object) -> TaskTrajectory:
    return plan_trajectories(plan_motion(robot, walk_gait(**walk)))


def bounded(robot: Robot, tasks: TaskTrajectory, **com: float) -> ComTrajectory:
    return generate_com(robot, tasks, ComParameters(generator="qp", **com))


def margins_of(robot: Robot, tasks: TaskTrajectory, zmp: np.ndarray) -> np.ndarray:
    """Distance (N,) of points (N, 2) to the edge of the polygon; its hull is Qhull's."""
    return np.array(
        [
            polygon_margins(point[None], support_hull(robot, tasks, k))[0]
            for k, point in enumerate(zmp)
        ]
    )


# --- a tiny problem, dense --------------------------------------------------------------------


def one_step(robot: Robot) -> TaskTrajectory:
    """Both soles, the left one, both soles: 36 samples of 50 ms; the ZMP reference jumps."""
    support = np.repeat([Support.DOUBLE, Support.LEFT, Support.DOUBLE], 12).astype(np.int8)
    n = len(support)
    soles = np.zeros((n, 2, 7))
    soles[..., 3:] = LEVEL
    soles[:, Side.LEFT, 1], soles[:, Side.RIGHT, 1] = 0.05, -0.05
    soles[24:, Side.RIGHT, 0] = 0.04
    zmp_ref = np.zeros((n, 2))
    zmp_ref[12:24, 1], zmp_ref[24:, 0] = 0.05, 0.02
    return TaskTrajectory(
        dt=0.05,
        support=support,
        root=np.zeros(n, np.int8),
        zmp_ref=zmp_ref,
        load_left=np.full(n, 0.5),
        soles=soles,
        hands=np.zeros((n, 2, 3)),
        com_height=np.full(n, 0.27),
        torso=np.tile(LEVEL, (n, 1)),
    )


def dense_maps(n: int, dt: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    """ZMP (n, n-1) and last state (3, n-1) of one axis as linear maps of its jerks, from rest."""
    A = np.array([[1.0, dt, dt**2 / 2], [0.0, 1.0, dt], [0.0, 0.0, 1.0]])
    B = np.array([dt**3 / 6, dt**2 / 2, dt])
    state = np.zeros((3, n - 1))
    zmp = np.zeros((n, n - 1))
    for k in range(n - 1):
        state = A @ state
        state[:, k] += B
        zmp[k + 1] = state[0] - height / GRAVITY * state[2]
    return zmp, state


def both_axes(matrix: np.ndarray) -> np.ndarray:
    """The same map for x and y, of jerks (x, y, x, y, ...)."""
    return np.kron(matrix, np.eye(2))


def jerks_of(com: ComTrajectory, dt: float) -> np.ndarray:
    return (np.diff(com.acceleration[:, :2], axis=0) / dt).ravel()


def test_far_from_the_edges_it_is_the_equality_constrained_least_squares_optimum(melson: Robot):
    """Its KKT system in the jerks alone, solved as a dense matrix."""
    tasks, ratio = one_step(melson), 1e-4
    tasks.zmp_ref[:, 1] *= 0.2  # stays in the middle but for the single support
    tasks.support[:] = Support.DOUBLE
    tasks.soles[:, Side.RIGHT, 0] = 0.02
    com = bounded(melson, tasks, weight_jerk=ratio)
    assert margins_of(melson, tasks, com.zmp).min() > 5e-3  # no bound is met
    n = tasks.n_samples
    zmp, last = (both_axes(m) for m in dense_maps(n, tasks.dt, 0.27))
    ends = np.concatenate([tasks.zmp_ref[-1], np.zeros(4)])  # c, v, a of (x, y)
    H = zmp.T @ zmp + ratio * np.eye(2 * (n - 1))
    kkt = np.block([[H, last.T], [last, np.zeros((6, 6))]])
    jerk = np.linalg.solve(kkt, np.concatenate([zmp.T @ tasks.zmp_ref.ravel(), ends]))[: 2 * n - 2]
    assert_allclose(jerks_of(com, tasks.dt), jerk, atol=1e-5 * np.abs(jerk).max())
    assert_allclose(com.zmp.ravel(), zmp @ jerk, atol=1e-8)


@pytest.mark.parametrize("margin", [0.02, 0.029])
@pytest.mark.parametrize("ratio", [1e-6, 1e-4])
def test_with_bounds_met_it_fulfils_the_kkt_conditions(melson: Robot, margin: float, ratio: float):
    """The gradient in the jerks is a combination of equalities and, with one sign, active bounds.

    The problem is convex, so this proves the solution optimal, whoever found it.
    """
    tasks = one_step(melson)
    com = bounded(melson, tasks, weight_jerk=ratio, margin=margin)
    n, jerk = tasks.n_samples, jerks_of(com, tasks.dt)
    zmp, last = (both_axes(m) for m in dense_maps(n, tasks.dt, 0.27))
    assert_allclose(zmp @ jerk, com.zmp.ravel(), atol=1e-7)
    assert_allclose(last @ jerk, [*tasks.zmp_ref[-1], 0, 0, 0, 0], atol=1e-6)
    normals = []
    for k in range(n):
        corners = np.concatenate(
            [
                tasks.soles[k, side, :2] + 0.5 * np.array(melson_sole(melson)) * [i, j]
                for side in Support(tasks.support[k]).sides
                for i in (-1, 1)
                for j in (-1, 1)
            ]
        ).reshape(-1, 2)
        for a, b, c in {tuple(np.round(e, 9)) for e in ConvexHull(corners).equations}:
            gap = a * com.zmp[k, 0] + b * com.zmp[k, 1] + c + margin
            assert gap < 1e-6
            if gap > -1e-7:
                normals.append(a * zmp[2 * k] + b * zmp[2 * k + 1])
    assert normals  # it does touch the bounds
    gradient = zmp.T @ (com.zmp - tasks.zmp_ref).ravel() + ratio * jerk
    columns = np.column_stack([last.T, np.array(normals).T])
    free = np.repeat([-np.inf, 0.0], [6, len(normals)])
    scale = np.linalg.norm(columns, axis=0)
    left = lsq_linear(columns / scale, -gradient, (free, np.inf), tol=1e-14)
    assert np.linalg.norm(left.fun) < 1e-4 * np.linalg.norm(gradient)


def melson_sole(robot: Robot) -> tuple[float, float]:
    sole = robot.sole_spec(Side.LEFT)
    return sole.length, sole.width


# --- shipped walks ----------------------------------------------------------------------------


@pytest.mark.parametrize("name", WALKS)
@pytest.mark.parametrize("weight_jerk", [1e-8, 1e-4])
def test_the_zmp_keeps_its_margin_at_every_sample(name: str, weight_jerk: float):
    gait = load_gait(name)
    robot = load_robot(gait.robot)
    tasks = plan_trajectories(plan_motion(robot, gait))
    margin = 0.9 * 0.5 * robot.sole_spec(Side.LEFT).width
    com = bounded(robot, tasks, margin=margin, weight_jerk=weight_jerk)
    margins = margins_of(robot, tasks, com.zmp)
    assert margins.min() > margin - 1e-6
    if weight_jerk == 1e-4:
        assert margins.min() < margin + 1e-6  # it would like to go farther


def test_less_jerk_is_needed_where_the_margin_is_less(melson: Robot):
    tasks = plan_trajectories(plan_motion(melson, load_gait("melson/walk_practical")))
    jerk = [
        np.sqrt(np.mean(jerks_of(bounded(melson, tasks, margin=m, weight_jerk=1e-3), 0.01) ** 2))
        for m in (0.0, 0.01, 0.02, 0.029)
    ]
    assert jerk == sorted(jerk)


def test_it_moves_from_rest_to_rest_as_a_cart_on_a_table(melson: Robot):
    tasks = plan_trajectories(plan_motion(melson, load_gait("melson/walk_practical")))
    com, dt = bounded(melson, tasks, margin=0.02, weight_jerk=1e-4), tasks.dt
    for k in (0, -1):
        assert_allclose(com.position[k, :2], tasks.zmp_ref[k], atol=1e-8)
        assert_allclose(com.velocity[k], 0.0, atol=1e-7)
        assert_allclose(com.acceleration[k], 0.0, atol=1e-6)
    c, v, a = com.position[:, :2], com.velocity[:, :2], com.acceleration[:, :2]
    jerk = np.diff(a, axis=0) / dt
    assert_allclose(v[1:], v[:-1] + dt * a[:-1] + dt**2 / 2 * jerk, atol=1e-8)
    ahead = c[:-1] + dt * v[:-1] + dt**2 / 2 * a[:-1] + dt**3 / 6 * jerk
    assert_allclose(c[1:], ahead, atol=1e-9)
    assert_allclose(com.zmp, c - com.position[:, 2:] / GRAVITY * a, atol=1e-12)
    assert np.all(com.position[:, 2] == tasks.com_height)


def test_a_stiff_qp_and_a_stiff_preview_control_agree(melson: Robot):
    tasks = plan_trajectories(plan_motion(melson, load_gait("melson/walk_practical")))
    qp = bounded(melson, tasks, weight_jerk=1e-10)
    preview = generate_com(melson, tasks, ComParameters(weight_jerk=1e-10))
    assert_allclose(qp.position, preview.position, atol=5e-5)


def test_mirrored_steps_give_a_mirrored_com(melson: Robot):
    steps = {"n_steps": 4, "step_length": 0.04}
    left, right = (
        bounded(
            melson, tasks_of(melson, first_support=side, **steps), margin=0.02, weight_jerk=1e-4
        )
        for side in ("left", "right")
    )
    assert_allclose(left.position, right.position * [1.0, -1.0, 1.0], atol=1e-7)
    assert np.ptp(left.position[:, 1]) > 0.02


def test_it_matters_not_where_in_the_world_a_walk_begins(melson: Robot):
    here, there = (tasks_of(melson, step_length=0.05) for _ in range(2))
    shift = np.array([3.0, -5.0])
    there.zmp_ref[:] += shift
    there.soles[..., :2] += shift
    weights = {"margin": 0.02, "weight_jerk": 1e-4}
    moved = bounded(melson, there, **weights).position[:, :2]
    assert_allclose(moved - shift, bounded(melson, here, **weights).position[:, :2], atol=1e-7)


def test_the_same_problem_has_the_same_solution_bit_for_bit(melson: Robot):
    tasks = tasks_of(melson, step_length=0.05)
    first, second = (bounded(melson, tasks, margin=0.02, weight_jerk=1e-4) for _ in range(2))
    assert_array_equal(first.position, second.position)
    assert_array_equal(first.zmp, second.zmp)


def test_the_dynamic_filter_brings_the_whole_robots_zmp_to_that_of_the_qp(melson: Robot):
    """Not to the reference: where the QP leaves it, it does so on purpose."""
    sets = ("com.generator=qp", "com.margin=0.02", "com.weight_jerk=1e-5")
    gait = load_gait("melson/walk_practical", sets)
    stages = run_stages(melson, gait)
    planned = bounded(melson, stages.tasks, margin=0.02, weight_jerk=1e-5).zmp
    error = np.linalg.norm(stages.motion.zmp - planned, axis=1)
    report = stages.motion.provenance.zmp_error
    assert_allclose(error.mean(), report.after.mean, rtol=1e-9)
    assert error.mean() < report.before.mean / 15.0
    margins = margins_of(melson, stages.tasks, stages.motion.zmp)
    assert margins.min() > 0.02 - error.max()
    assert margins.min() > 0.0175


# --- refusals ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "half_width"), [("melson/walk_practical", 0.03), ("coman/walk", 0.05)]
)
def test_too_wide_a_margin_is_refused_with_the_time_and_the_widest(name: str, half_width: float):
    gait = load_gait(name)
    robot = load_robot(gait.robot)
    tasks = plan_trajectories(plan_motion(robot, gait))
    with pytest.raises(ZmpMarginError, match="left support no CoM motion") as caught:
        bounded(robot, tasks, margin=half_width + 1e-3)
    t, _, widest, advised = (float(x) for x in re.findall(r"\d+\.\d+", str(caught.value)))
    error = caught.value
    assert (
        t == pytest.approx(error.t) == pytest.approx(gait.walk.lead_in + gait.walk.double_support)
    )
    assert error.margin == half_width + 1e-3 and error.support == "left"
    assert widest == pytest.approx(1e3 * half_width, abs=0.05)
    assert half_width - 3e-4 < advised < half_width
    assert (
        margins_of(robot, tasks, bounded(robot, tasks, margin=advised).zmp).min() > advised - 1e-6
    )


def test_a_rest_outside_its_polygon_is_refused(melson: Robot):
    tasks = one_step(melson)
    tasks.zmp_ref[:] += [0.2, 0.0]
    refusal = pytest.raises(ZmpMarginError, match=r"t = 0.000 s: .* walk\.zmp_offset")
    with refusal as caught, remedies_for(walk_gait()):
        bounded(melson, tasks)
    assert caught.value.t == 0.0
    assert caught.value.widest == pytest.approx(
        -0.2 + 0.5 * melson.sole_spec(Side.LEFT).length, abs=1e-4
    )


@settings(max_examples=40)
@given(st.floats(-300.0, 12.0), st.floats(-300.0, 6.0), numbers(0.0, 0.05))
def test_any_weights_give_a_motion_within_bounds_or_a_refusal(error, jerk, margin):
    robot = load_robot("melson")
    tasks = one_step(robot)
    weights = {"weight_error": 10.0**error, "weight_jerk": 10.0**jerk, "margin": margin}
    try:
        com = bounded(robot, tasks, **weights)
    except MgsError as refusal:
        assert isinstance(refusal, ConfigError | InfeasibleGaitError)
    else:
        assert margins_of(robot, tasks, com.zmp).min() > margin - 1e-6
