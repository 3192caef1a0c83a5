"""IK of the whole trajectory: tasks are met, its cost is a minimum and below closed-loop IK."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.contact import Side
from mgs.core.errors import ConfigError, JointLimitError
from mgs.gait import BalanceGait, IkParameters, WalkGait
from mgs.gait.ik import TrajectoryParameters
from mgs.ik_solver.banded import band_matrix, coupling, second_differences, solve_band
from mgs.ik_solver.clik import ClosedLoopIk
from mgs.ik_solver.limit_barrier import DELTA, limit_barrier
from mgs.ik_solver.whole_motion import (
    PINNED,
    Point,
    Problem,
    TrajectoryIk,
    TrajectoryReport,
    minimise,
)
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot, load_robot
from tests.support.strategies import balance_gait, constant, sine, walk_gait

SHORT = {
    "n_steps": 2, "step_length": 0.05, "step_yaw": 0.1, "first_support": "left",
    "double_support": 0.4, "single_support": 0.6,
}  # fmt: skip
GAINS = {"gamma_joint": 0.35, "gamma_grav": 1.6}

RESTS = {"lead_in": 1.8, "lead_out": 1.8}  # [s] in which joints settle


def walk(solver: str = "trajectory", **trajectory: float | str) -> WalkGait:
    """A walk with the same CoM motion for all solvers, without the dynamic filter."""
    ik = {"solver": solver, **GAINS, "trajectory": trajectory}
    return walk_gait(**SHORT, **RESTS, com={"passes": 0}, ik=ik)


def squat(solver: str = "trajectory") -> BalanceGait:
    ik = {"solver": solver, **GAINS}
    return balance_gait(sine("com_z", 0.02), com_height=0.51, ik=ik)


@pytest.fixture(scope="module")
def coman() -> Robot:
    return load_robot("coman")


@pytest.fixture(scope="module")
def closed_loop(melson: Robot) -> Stages:
    return run_stages(melson, walk("clik"))


@pytest.fixture(scope="module")
def whole(melson: Robot) -> Stages:
    return run_stages(melson, walk())


def problem_of(robot: Robot, stages: Stages, ik: IkParameters) -> Problem:
    return Problem(TrajectoryIk.from_parameters(ik), robot, stages.tasks, stages.com)


def objective_of(robot: Robot, stages: Stages, ik: IkParameters) -> dict[str, float]:
    """Parts of the objective, from joint angles and the torques of inverse dynamics at rest."""
    q, dt = stages.joints.angles, stages.tasks.dt
    width = robot.upper - robot.lower
    middle = 0.5 * (robot.upper + robot.lower)
    joint = 0.5 * dt * np.sum(((q - middle) / width) ** 2)
    scale = 0.70 / (robot.mass * stages.tasks.com_height[0])
    grav = 0.5 * dt * scale**2 * np.sum(static_torques(robot, stages) ** 2)
    rested = np.concatenate([q[:1], q, q[-1:]])
    bend = np.sum(np.diff(rested, 2, axis=0) ** 2) / dt**3
    tuning = ik.trajectory
    return {
        "cost": tuning.weight_joint * joint + tuning.weight_grav * grav,
        "bend": tuning.weight_acceleration * bend,
    }


def static_torques(robot: Robot, stages: Stages) -> np.ndarray:
    """Joint torques (N, n) at rest, by rnea and the contact Jacobians of the floating base."""
    model, data, tasks = robot.model, robot.model.createData(), stages.tasks
    out, rest = np.empty_like(stages.joints.angles), np.zeros(robot.model.nv)
    weight = robot.mass * 9.81
    for k, q in enumerate(stages.motion.q):
        tau = pin.rnea(model, data, q, rest, rest)[6:].copy()
        com = stages.com.position[k]
        shares = (tasks.load_left[k], 1.0 - tasks.load_left[k])
        centre = shares[0] * tasks.soles[k, 0, :2] + shares[1] * tasks.soles[k, 1, :2]
        pin.computeJointJacobians(model, data, q)
        for side in Side:
            x, y = tasks.soles[k, side, :2] + com[:2] - centre
            J = pin.getFrameJacobian(model, data, robot.sole_frames[side], pin.WORLD)[:, 6:]
            fz = shares[side] * weight
            tau -= J.T @ np.array([0.0, 0.0, fz, y * fz, -x * fz, 0.0])
        out[k] = tau
    return out


# --- what it is for ---------------------------------------------------------------------------


def test_objective_and_secondary_tasks_are_lower_than_those_of_the_closed_loop_ik(
    melson: Robot, closed_loop: Stages, whole: Stages
):
    """Measured by inverse dynamics and differences of the angles."""
    ik = walk().ik
    before, after = (objective_of(melson, s, ik) for s in (closed_loop, whole))
    assert after["cost"] < 0.95 * before["cost"]
    assert sum(after.values()) < 0.95 * sum(before.values())


def test_the_cost_is_that_of_inverse_dynamics(melson: Robot, whole: Stages):
    problem = problem_of(melson, whole, walk().ik)
    expected = objective_of(melson, whole, walk().ik)
    assert problem.cost(whole.joints.angles) == pytest.approx(expected["cost"], rel=1e-5)


@pytest.mark.parametrize("sharing", ["off", "optimal"])
def test_the_objective_falls_with_other_options_for_double_support(melson: Robot, sharing: str):
    ik = {"solver": "trajectory", **GAINS, "double_support": sharing}
    joints = run_stages(melson, walk_gait(**SHORT, ik=ik)).joints
    history = joints.report_of(TrajectoryReport).objective
    assert history[-1] < 0.97 * history[0]


def test_a_squat_with_free_hands_costs_less(coman: Robot):
    """The null space has twenty dimensions per sample; both soles stay on the ground."""
    before, after = (run_stages(coman, squat(solver)) for solver in ("clik", "trajectory"))
    costs = [objective_of(coman, s, squat().ik)["cost"] for s in (before, after)]
    assert costs[1] < 0.97 * costs[0]
    assert np.abs(after.motion.com - after.motion.com_ref).max() < 1e-4
    assert np.abs(after.motion.soles - after.motion.soles_ref).max() < 1e-4


# --- tasks, limits, ends ----------------------------------------------------------------------


def test_tasks_are_met_at_every_sample(whole: Stages):
    """Forward kinematics of the floating-base robot; the walk uses both roots of the tree."""
    motion = whole.motion
    assert len(set(whole.tasks.root)) == 2
    assert np.abs(motion.com - motion.com_ref).max() < 1e-5
    assert np.abs(motion.soles - motion.soles_ref).max() < 1e-5
    assert np.abs(motion.hands[..., :3] - motion.hands_ref).max() < 1e-5


@pytest.mark.parametrize("start", ["free", "posture"])
def test_a_motion_starts_and_ends_at_rest(melson: Robot, start: str):
    stages = run_stages(melson, walk(start=start))
    q, dt = stages.joints.angles, stages.tasks.dt
    for speed in (q[1] - q[0], q[-1] - q[-2]):
        assert np.abs(speed).max() / dt < 5e-3  # [rad/s]


def test_on_request_the_motion_starts_as_with_closed_loop_ik(melson: Robot, closed_loop: Stages):
    q = run_stages(melson, walk(start="posture")).joints
    assert np.array_equal(q.angles[:PINNED], closed_loop.joints.angles[:PINNED])
    history = q.report_of(TrajectoryReport).objective
    assert history[-1] < 0.97 * history[0]


def test_a_motion_with_free_ends_ends_in_the_posture_of_its_start(melson: Robot):
    """The soles are abreast at both ends, so that motions can follow each other."""
    gait = walk_gait(n_steps=2, **RESTS, ik={"solver": "trajectory", **GAINS})
    q = run_stages(melson, gait).joints.angles
    assert np.abs(q[-1] - q[0]).max() < 0.01  # [rad]


def test_joints_do_not_jump_where_the_root_changes(whole: Stages):
    bends = np.abs(np.diff(whole.joints.angles, 2, axis=0)).max(axis=1)
    switches = np.flatnonzero(np.diff(whole.tasks.root)) + 1
    assert len(switches)
    for k in switches:
        assert bends[k - 2 : k + 1].max() <= np.delete(bends, np.arange(k - 5, k + 4)).max()


def test_the_barrier_keeps_joint_limits_that_least_torque_would_exceed(melson: Robot):
    """Without the barrier the least torque turns a hip beyond its range."""

    def quick(**trajectory: float) -> WalkGait:
        ik = {"solver": "trajectory", **GAINS, "trajectory": trajectory}
        return walk_gait(**SHORT, com={"passes": 0}, ik=ik)

    with pytest.raises(JointLimitError):
        run_stages(melson, quick(weight_limit=0.0, weight_joint=0.0, iterations=6))
    held = run_stages(melson, quick(weight_joint=0.0, iterations=6)).joints.angles
    assert np.all((held > melson.lower) & (held < melson.upper))


def test_a_joint_that_the_tasks_move_beyond_its_limit_is_refused_or_recorded(melson: Robot):
    raised = SHORT | {"step_height": 0.2}  # too high for a knee that bends by 130 deg
    ik = {"solver": "trajectory", "gamma_joint": 0.0, "trajectory": {"iterations": 2}}
    with pytest.raises(JointLimitError):
        run_stages(melson, walk_gait(**raised, ik=ik))
    angles = run_stages(melson, walk_gait(**raised, ik=ik | {"on_limit": "record"})).joints.angles
    assert np.any((angles < melson.lower) | (angles > melson.upper))


def test_a_gait_that_turns_the_torso_is_refused(melson: Robot):
    with pytest.raises(ConfigError, match=r"ik\.solver: trajectory leaves the torso free"):
        run_stages(melson, balance_gait(constant("torso_yaw", 0.01), ik={"solver": "trajectory"}))


# --- the minimum ------------------------------------------------------------------------------


def test_the_objective_falls_in_every_iteration(whole: Stages):
    report = whole.joints.report_of(TrajectoryReport)
    history = np.array(report.objective)
    assert len(history) == report.iterations + 1 > 3
    assert np.all(np.diff(history) < 0.0)


def test_at_the_end_the_gradient_in_the_null_spaces_is_zero(melson: Robot, whole: Stages):
    """Null spaces by singular values; compared with the other part and with the start."""
    tuning = TrajectoryIk.from_parameters(walk(tolerance=1e-10, iterations=80).ik)
    problem = Problem(tuning, melson, whole.tasks, whole.com)
    start = problem.at(tuning.closed_loop.solve(melson, whole.tasks, whole.com).angles)
    end, _ = minimise(problem, start.q)
    inside, outside = [], []
    for point in (start, end):
        _, J = problem.batch.tasks_at(point.q)
        null = np.linalg.svd(J)[2][:, J.shape[1] :]
        g = problem.gradient(point)
        part = np.einsum("kpn,kn->kp", null, g)
        inside.append(np.abs(part).max())
        outside.append(np.sqrt(np.sum(g**2) - np.sum(part**2)))
    assert inside[1] < 2e-3 * inside[0]
    assert inside[1] < 1e-3 * outside[1]


def test_the_gradient_is_that_of_finite_differences(melson: Robot, whole: Stages):
    problem = problem_of(melson, whole, walk().ik)
    q, dtau = whole.joints.angles, None
    rng = np.random.default_rng(4)

    def value(x: np.ndarray) -> float:
        return problem._objective(x, problem.batch.torques_at(x)[0])

    tau, dtau = problem.batch.torques_at(q)
    gradient = problem.gradient(Point(q, q, q, tau, dtau, 0.0))
    for _ in range(4):
        direction = 1e-5 * rng.normal(size=q.shape)
        slope = 0.5 * (value(q + direction) - value(q - direction))
        assert np.sum(gradient * direction) == pytest.approx(slope, rel=1e-4)


def test_the_banded_step_equals_the_dense_one_on_a_short_motion(melson: Robot, whole: Stages):
    """The oracle writes down the whole matrix: second differences as a matrix, blocks of curvature.

    It takes its null spaces by singular values: other bases, the same step.
    """
    problem = problem_of(melson, whole, walk().ik)
    point = problem.at(whole.joints.angles)
    rng = np.random.default_rng(3)
    n_samples, n, p = 12, melson.n, 4
    q = whole.joints.angles[:n_samples]
    _, J = problem.batch.tasks_at(point.q)
    J = J[100 : 100 + n_samples]
    bases = [np.linalg.svd(J)[2][:, 15:].transpose(0, 2, 1), None]
    bases[1] = np.linalg.qr(J.transpose(0, 2, 1), mode="complete").Q[:, :, 15:]
    C = rng.normal(size=(n_samples, n, n))
    C = C @ C.transpose(0, 2, 1)
    g, c = rng.normal(size=(n_samples, n)), 0.7
    D = np.diff(np.concatenate([np.eye(n_samples)[:1], np.eye(n_samples), np.eye(n_samples)[-1:]]),
                n=2, axis=0)  # fmt: skip
    assert_allclose(second_differences(q), D @ q, atol=1e-12)
    full = c * np.kron(D.T @ D, np.eye(n))
    for k in range(n_samples):
        full[k * n : (k + 1) * n, k * n : (k + 1) * n] += C[k]
    dense = np.zeros((n_samples * n, (n_samples - PINNED) * p))
    for k in range(PINNED, n_samples):
        dense[k * n : (k + 1) * n, (k - PINNED) * p : (k - PINNED + 1) * p] = bases[0][k]
    expected = dense @ np.linalg.solve(dense.T @ full @ dense, -dense.T @ g.ravel())
    Z = np.ascontiguousarray(bases[1])
    B = Z.transpose(0, 2, 1) @ C @ Z
    z = solve_band(band_matrix(B, Z, c, PINNED), np.einsum("kn,knp->kp", g, Z)[PINNED:])
    step = np.einsum("knp,kp->kn", Z[PINNED:], z)
    assert_allclose(step.ravel(), expected[PINNED * n :], atol=1e-9)
    assert_allclose(expected[: PINNED * n], 0.0)


@pytest.mark.parametrize("n_samples", [4, 5, 30])
def test_coupling_contains_the_diagonals_of_the_squared_second_differences(n_samples: int):
    D = second_differences(np.eye(n_samples))
    square = D.T @ D
    for d, diagonal in enumerate(coupling(n_samples)):
        assert_allclose(diagonal[: n_samples - d], np.diag(square, -d), atol=1e-12)


def test_the_derivatives_of_the_barrier_are_those_of_finite_differences():
    lower, upper = np.array([-1.0, 0.0]), np.array([2.0, 0.5])
    for room in (0.5, 0.01, 2e-3, 3e-5, -0.01):
        for q in (lower + room * (upper - lower), upper - room * (upper - lower)):
            h = 1e-7 * (upper - lower)
            at = [limit_barrier(q + s * h * e, lower, upper) for e in np.eye(2) for s in (1, -1)]
            _, slope, bend = limit_barrier(q, lower, upper)
            values = np.array([x[0] for x in at]).reshape(2, 2)
            slopes = np.array([[x[1][i // 2] for i, x in enumerate(at)]]).reshape(2, 2)
            assert_allclose(slope, (values[:, 0] - values[:, 1]) / (2.0 * h), rtol=1e-3, atol=1e-6)
            assert_allclose(bend, (slopes[:, 0] - slopes[:, 1]) / (2.0 * h), rtol=1e-3, atol=1e-5)
    assert limit_barrier(0.5 * (lower + upper), lower, upper)[0] == pytest.approx(0.0, abs=1e-12)


def test_the_barrier_is_smooth_where_it_is_continued():
    lower, upper = np.zeros(1), np.ones(1)
    here, there = (limit_barrier(np.array([DELTA + s]), lower, upper) for s in (-1e-12, 1e-12))
    for a, b in zip(here, there, strict=True):
        assert_allclose(a, b, rtol=1e-6)


# --- the rest ---------------------------------------------------------------------------------


def test_the_solution_is_the_same_bit_for_bit_twice(melson: Robot, whole: Stages):
    again = run_stages(melson, walk()).joints
    assert again.angles.tobytes() == whole.joints.angles.tobytes()
    assert again.report == whole.joints.report


def test_the_settings_of_a_gait_file_reach_the_solver():
    ik = IkParameters.model_validate(
        {
            "solver": "trajectory", "gamma_grav": 2.0, "on_limit": "record",
            "trajectory": {"start": "posture", "weight_joint": 1.0, "iterations": 5},
        }
    )  # fmt: skip
    found = TrajectoryIk.from_parameters(ik)
    assert found.tuning == TrajectoryParameters(start="posture", weight_joint=1.0, iterations=5)
    assert found.closed_loop == ClosedLoopIk.from_parameters(ik)
    assert not found.keep_limits
    refusing = TrajectoryIk.from_parameters(IkParameters(on_limit="refuse"))
    assert refusing.keep_limits
    assert refusing.closed_loop.on_limit == "record"  # the first trajectory may leave limits


def test_zero_iterations_return_the_closed_loop_ik_on_its_tasks(melson: Robot, closed_loop: Stages):
    angles = run_stages(melson, walk(iterations=0)).joints.angles
    assert_allclose(angles, closed_loop.joints.angles, atol=1e-3)  # Newton steps from 1e-5 m
