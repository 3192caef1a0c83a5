"""Strict priorities on a floating base, against pseudo-inverses, differences and finer steps."""

from __future__ import annotations

import json

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.com_generator import ComTrajectory
from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError, IkError, JointLimitError
from mgs.gait import Gait, load_gait
from mgs.ik_solver import JointTrajectory, solve_ik
from mgs.ik_solver.floating.constraints import (
    base_velocity,
    feasibility,
    handover_profile,
    refuse_infeasible,
)
from mgs.ik_solver.floating.jacobian_rate import JacobianRate
from mgs.ik_solver.floating.parts import (
    COM,
    COM_XY,
    COM_Z,
    LEFT_HAND,
    LEFT_SOLE,
    RIGHT_HAND,
    RIGHT_SOLE,
    SOLES,
    TORSO,
    Part,
)
from mgs.ik_solver.floating.priority_levels import PriorityLevels
from mgs.ik_solver.floating.tasks import BodyTasks, measure_tasks
from mgs.ik_solver.prioritized import PrioritizedIk, PrioritizedReport, PrioritizedRun
from mgs.judge.motion_checks import check_motion
from mgs.motion_planner import plan_motion
from mgs.pipeline import Stages, first_com, run_stages
from mgs.robot import Robot, load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories

PARTS = (*SOLES, COM_XY, LEFT_HAND, RIGHT_HAND, TORSO, COM_Z)
SIZES = (14, 6, 4)  # of the levels that PARTS make up
A, B, E = slice(0, 14), slice(14, 20), slice(20, 24)
SOLVERS = ["prioritized", "prioritized-acceleration"]
FORMS = ["tracking", "projected"]
BALANCES = ["coman/sway", "coman/hand_eight", "melson/sway", "melson/hand_eight"]


@pytest.fixture(scope="module")
def robots() -> dict[str, Robot]:
    return {name: load_robot(name) for name in ("coman", "coman_legs", "melson")}


def random_q(robot: Robot, rng: np.random.Generator, spread: float = 0.15) -> np.ndarray:
    return pin.integrate(robot.model, robot.standing_q, spread * rng.normal(size=robot.model.nv))


def jacobian(robot: Robot, q: np.ndarray, parts: tuple[Part, ...] = PARTS) -> np.ndarray:
    tasks = BodyTasks(robot, parts)
    tasks.update(q)
    return tasks.J.copy()


def inputs(robot: Robot, gait: Gait) -> tuple[TaskTrajectory, ComTrajectory]:
    tasks = plan_trajectories(plan_motion(robot, gait))
    return tasks, first_com(robot, gait, tasks)


def walk_through(robot: Robot, gait: Gait) -> PrioritizedRun:
    """A run that has taken all steps, without the checks at its end."""
    tasks, com = inputs(robot, gait)
    run = PrioritizedRun(PrioritizedIk.from_parameters(gait.ik), robot, tasks, com)
    run.start()
    for k in range(1, tasks.n_samples):
        run.step(k)
    return run


def frame_positions(robot: Robot, configurations: np.ndarray, frame: int) -> np.ndarray:
    data = robot.model.createData()
    places = []
    for q in configurations:
        pin.framesForwardKinematics(robot.model, data, q)
        places.append(data.oMf[frame].translation.copy())
    return np.array(places)


def worst(joints: JointTrajectory | Stages) -> dict[str, float]:
    found = joints.joints if isinstance(joints, Stages) else joints
    errors = found.report_of(PrioritizedReport).worst_errors
    return errors


# --- levels against numpy.linalg.pinv ---------------------------------------------------------


@pytest.mark.parametrize("name", ["coman", "melson"])
def test_projectors_are_symmetric_idempotent_and_annihilate_the_levels_above(
    robots: dict[str, Robot], name: str
) -> None:
    rng = np.random.default_rng(1)
    for _ in range(5):
        J = jacobian(robots[name], random_q(robots[name], rng))
        levels = PriorityLevels(SIZES, J.shape[1], size=0.3)
        levels.solve(J, rng.normal(size=24), np.zeros(J.shape[1]))
        for level, above in [(0, J[:0]), (1, J[A]), (2, J[:20]), (3, J)]:
            N = levels.projector(level)
            oracle = np.eye(J.shape[1]) - np.linalg.pinv(above) @ above
            assert_allclose(N, oracle, atol=1e-9)  # rounding by the condition of J_A, 1e2
            assert_allclose(N, N.T, atol=1e-14)
            assert_allclose(N @ N, N, atol=1e-9)
            assert_allclose(above @ N, 0.0, atol=1e-9)


@pytest.mark.parametrize("name", ["coman", "melson"])
def test_projected_form_is_equation_16(robots: dict[str, Robot], name: str) -> None:
    rng = np.random.default_rng(2)
    for _ in range(10):
        J = jacobian(robots[name], random_q(robots[name], rng))
        nv = J.shape[1]
        rates, free = rng.normal(size=24), rng.normal(size=nv)
        pinv, eye = np.linalg.pinv, np.eye(nv)
        N_A = eye - pinv(J[A]) @ J[A]
        N_AB = eye - pinv(J[:20]) @ J[:20]
        v = pinv(J[A]) @ rates[A] + N_A @ pinv(J[B]) @ rates[B] + N_AB @ pinv(J[E]) @ rates[E]
        v += (eye - pinv(J) @ J) @ free
        levels = PriorityLevels(SIZES, nv, size=0.3, projected=True)
        assert_allclose(levels.solve(J, rates, free), v, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("name", ["coman", "melson"])
def test_tracking_form_is_the_sequence_of_restricted_pseudo_inverses(
    robots: dict[str, Robot], name: str
) -> None:
    """Where all levels can be met, it is also the shortest velocity that meets them."""
    rng = np.random.default_rng(3)
    for _ in range(10):
        J = jacobian(robots[name], random_q(robots[name], rng))
        nv = J.shape[1]
        rates, pinv, eye = rng.normal(size=24), np.linalg.pinv, np.eye(nv)
        v = pinv(J[A]) @ rates[A]
        v += pinv(J[B] @ (eye - pinv(J[A]) @ J[A]), rcond=1e-10) @ (rates[B] - J[B] @ v)
        v += pinv(J[E] @ (eye - pinv(J[:20]) @ J[:20]), rcond=1e-10) @ (rates[E] - J[E] @ v)
        found = PriorityLevels(SIZES, nv, size=0.3).solve(J, rates, np.zeros(nv))
        assert_allclose(found, v, rtol=1e-7, atol=1e-7)
        assert_allclose(found, pinv(J) @ rates, rtol=1e-7, atol=1e-7)
        assert_allclose(J @ found, rates, atol=1e-9)


@pytest.mark.parametrize("projected", [False, True])
def test_level_a_is_met_exactly_whatever_lower_levels_demand(
    robots: dict[str, Robot], projected: bool
) -> None:
    """B demands the opposite motion of a sole and E repeats B: no velocity meets them."""
    robot, rng = robots["coman"], np.random.default_rng(4)
    for _ in range(20):
        J = jacobian(robot, random_q(robot, rng))
        J[B], J[E] = J[2:8], J[B][:4] + 1e-9 * rng.normal(size=(4, J.shape[1]))
        rates = 10.0 ** rng.uniform(-2, 2) * rng.normal(size=24)
        levels = PriorityLevels(SIZES, J.shape[1], 0.5, projected)
        v = levels.solve(J, rates, rng.normal(size=J.shape[1]), 1.0)
        assert np.isfinite(v).all()
        assert_allclose(J[A] @ v, rates[A], atol=1e-10 * np.abs(rates).max())
        assert_allclose(J[A] @ levels.projector(3), 0.0, atol=1e-10)


def test_solutions_are_continuous_where_a_conflict_arises(robots: dict[str, Robot]) -> None:
    """A row of B turns into one of A: the solution stays bounded, and exact far from conflict."""
    robot = robots["coman"]
    J, nv = jacobian(robot, robot.standing_q), robot.model.nv
    rates, row = np.ones(24), J[14].copy()
    found = []
    for share in np.linspace(0.0, 1.0, 2001):
        J[14] = (1.0 - share) * row + share * J[12]
        levels = PriorityLevels(SIZES, nv, 0.5)
        v = levels.solve(J, rates, np.zeros(nv), 1.0)
        assert_allclose(J[A] @ v, rates[A], atol=1e-11)
        if share < 0.9:
            assert_allclose(J @ v, rates, atol=1e-9)
        found.append(v)
    found_array = np.array(found)
    assert np.abs(np.diff(found_array, axis=0)).max() < 0.1 * np.abs(found_array).max()
    assert np.abs(found_array).max() < 200.0  # 1 / (2 lambda) = 50 for each of few rows


def test_a_level_that_lags_is_bounded(robots: dict[str, Robot]) -> None:
    robot = robots["coman"]
    J, nv = jacobian(robot, robot.standing_q), robot.model.nv
    rates = np.zeros(24)
    rates[B] = 100.0
    levels = PriorityLevels(SIZES, nv, 0.5)
    swift = levels.solve(J, rates, np.zeros(nv), 1.0)
    slow = levels.solve(J, rates, np.zeros(nv), 1.0, (0.0, 1.0, 0.0))
    assert np.abs(swift).max() > 10.0
    assert_allclose(J[B] @ slow, rates[B] * (J[B] @ slow)[0] / rates[B][0], atol=1e-9)
    assert np.abs(slow).max() < 3.0  # B adds 1, E holds its tasks against that


def test_a_first_level_that_contradicts_itself_is_refused(robots: dict[str, Robot]) -> None:
    J = jacobian(robots["melson"], robots["melson"].standing_q)
    J[1] = J[0]
    with pytest.raises(np.linalg.LinAlgError, match="first level"):
        PriorityLevels(SIZES, J.shape[1], 0.3).solve(J, np.ones(24), np.zeros(J.shape[1]))


# --- constraints ------------------------------------------------------------------------------


@pytest.mark.parametrize("soles", [(LEFT_SOLE,), SOLES], ids=["one", "both"])
def test_equation_10_recovers_the_base_velocity(
    robots: dict[str, Robot], soles: tuple[Part, ...]
) -> None:
    robot, rng = robots["coman"], np.random.default_rng(5)
    for _ in range(10):
        J_C = jacobian(robot, random_q(robot, rng), soles)
        v = rng.normal(size=J_C.shape[1])
        v -= np.linalg.pinv(J_C) @ J_C @ v  # any motion that keeps the constraints
        assert_allclose(base_velocity(J_C, v[6:]), v[:6], atol=1e-9)


def point_rows(robot: Robot, side: Side, local: tuple[float, float]) -> np.ndarray:
    """Velocity rows (3, 6 + n) of a point of a sole, by differences of its position."""
    model, data, q = robot.model, robot.model.createData(), robot.standing_q

    def place(v: np.ndarray) -> np.ndarray:
        pin.framesForwardKinematics(model, data, pin.integrate(model, q, v))
        return data.oMf[robot.sole_frames[side]].act(np.array([*local, 0.0]))

    h = 1e-5
    columns = [(place(h * e) - place(-h * e)) / (2.0 * h) for e in np.eye(model.nv)]
    return np.array(columns).T


def test_two_edges_suffice_unless_they_are_collinear(robots: dict[str, Robot]) -> None:
    """Six rows: a point, a second one across its edge, and the height of a point of the other."""
    robot = robots["coman"]
    heel = [point_rows(robot, Side.LEFT, (-0.1, y)) for y in (-0.05, 0.05)]
    other_heel = point_rows(robot, Side.RIGHT, (-0.1, 0.05))
    other_toe = point_rows(robot, Side.RIGHT, (0.1, 0.05))
    first = [heel[0], heel[1][[0, 2]]]  # edges run along y
    apart = np.concatenate([*first, other_toe[2:]])
    in_line = np.concatenate([*first, other_heel[2:]])
    one = np.concatenate(heel)
    assert len(apart) == len(in_line) == len(one) == 6
    assert feasibility(apart) == (6, 6)
    assert feasibility(in_line)[1] == 5
    assert feasibility(one)[1] == 5
    refuse_infeasible(0.0, apart, apart)
    for rows in (in_line, one):
        with pytest.raises(ConfigError, match=r"t = 1\.500 s is under-constrained: 6 .* hold 5 of"):
            refuse_infeasible(1.5, rows, rows)
        with pytest.raises(np.linalg.LinAlgError, match="under-constrained"):
            base_velocity(rows, np.zeros(robot.n))


def test_dependent_constraint_rows_are_refused(robots: dict[str, Robot]) -> None:
    J = jacobian(robots["coman"], robots["coman"].standing_q)
    with pytest.raises(ConfigError, match="over-constrained: 13 constraint rows have rank 12"):
        refuse_infeasible(0.0, np.concatenate([J[:12], J[:1]]), J[A])
    with pytest.raises(ConfigError, match="over-constrained: 15 critical rows have rank 14"):
        refuse_infeasible(0.0, J[:12], np.concatenate([J[A], J[:1]]))


def test_straight_knees_are_not_singular_for_level_a(robots: dict[str, Robot]) -> None:
    robot = robots["coman"]
    legs = [robot.joint_names.index(name) for group in ("left_leg", "right_leg")
            for name in robot.spec.groups[group]]  # fmt: skip
    q = robot.standing_q.copy()
    q[7:][legs] = 0.0
    smallest = [
        np.linalg.svd(jacobian(robot, q, PARTS[:3]), compute_uv=False)[-1]
        for q in (q, robot.standing_q)
    ]
    assert smallest[0] > 0.03
    assert smallest[0] > 0.3 * smallest[1]


@pytest.mark.parametrize("name", ["coman", "coman_legs", "melson"])
def test_jdot_v_is_the_change_of_j_v(robots: dict[str, Robot], name: str) -> None:
    robot, rng = robots[name], np.random.default_rng(6)
    tasks = BodyTasks(robot, (COM, *PARTS))
    rate = JacobianRate(robot, tasks)
    for _ in range(5):
        q, v = random_q(robot, rng, 0.4), rng.normal(size=robot.model.nv)
        found, h = np.empty(tasks.m), 1e-5
        rate.product(q, v, found)
        moved = [pin.integrate(robot.model, q, s * h * v) for s in (1.0, -1.0)]
        ahead, behind = (jacobian(robot, p, tasks.parts) @ v for p in moved)
        assert_allclose(found, (ahead - behind) / (2.0 * h), atol=1e-6)


# --- feedback ---------------------------------------------------------------------------------


@pytest.mark.parametrize("solver", SOLVERS)
def test_errors_decay_with_the_poles_of_the_feedback(robots: dict[str, Robot], solver: str) -> None:
    """All targets move by a small step at one instant, without a reference velocity."""
    gait = load_gait("melson/sway", (f"ik.solver={solver}", "ik.prioritized.feedback=0.4"))
    tasks, com = inputs(robots["melson"], gait)
    run = PrioritizedRun(PrioritizedIk.from_parameters(gait.ik), robots["melson"], tasks, com)
    run.start()
    com_x, sole_x = run.tasks.rows[COM_XY].start, run.tasks.rows[RIGHT_SOLE].start
    run.targets.x[:, [com_x, sole_x]] += 1e-6
    run._measure(0)
    errors = [run.error.copy()]
    for k in range(1, 20):  # still at rest
        run.step(k)
        errors.append(run.error.copy())
    found = np.array(errors)[:, [com_x, sole_x]] / 1e-6
    single = 0.6 ** np.arange(20)
    double = [1.0, 1.0]  # e[k] = 2 p e[k-1] - p^2 e[k-2], the first without speed
    while len(double) < 21:
        double.append(2.0 * 0.6 * double[-1] - 0.36 * double[-2])
    expected = single if solver == "prioritized" else np.array(double[1:])
    assert_allclose(found[:, 0], expected, atol=1e-3)  # the curvature at steps of 1e-6 m
    assert_allclose(found[:, 1], single, atol=1e-3)


@pytest.mark.parametrize("name", ["coman_legs", "coman"])
def test_acceleration_form_is_the_finely_integrated_velocity_form(
    robots: dict[str, Robot], name: str
) -> None:
    """The legs of COMAN have no redundancy: only the order of the integration differs.

    With waist and arms the acceleration form takes on null-space motion with a lag of 0.1 s.
    """
    settings = ("balance.duration=5.0", "balance.ease=1.0")
    fine = ("balance.duration=5.0", "balance.ease=1.0", "dt=0.001")
    oracle = walk_through(robots[name], load_gait("coman/sway", fine)).configurations[::10, 7:]
    gait = load_gait("coman/sway", (*settings, "ik.solver=prioritized-acceleration"))
    found = walk_through(robots[name], gait).configurations[:, 7:]
    moved = np.abs(oracle - oracle[0]).max()
    assert moved > 0.1
    assert np.abs(found - oracle).max() < (1e-5 if name == "coman_legs" else 0.05 * moved)


# --- motions ----------------------------------------------------------------------------------


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("gait_name", BALANCES)
def test_soles_do_not_drift(
    robots: dict[str, Robot], gait_name: str, form: str, solver: str
) -> None:
    """All critical tasks are met to 1e-4, the constraints to 1e-5 m at dt = 0.01."""
    settings = (f"ik.solver={solver}", f"ik.prioritized.null_space={form}", "balance.duration=7.0")
    gait = load_gait(gait_name, settings)
    robot = robots[gait.robot or ""]
    run = walk_through(robot, gait)
    assert run.corrections == 0
    for side in Side:
        places = frame_positions(robot, run.configurations, robot.sole_frames[side])
        assert np.linalg.norm(places - run_sole(robot, side), axis=1).max() < 1e-5
    critical = measure_tasks(run.tasks, run.targets, run.configurations)[:, : run.m_critical]
    assert np.abs(critical).max() < 1e-4


def run_sole(robot: Robot, side: Side) -> np.ndarray:
    """Position (3,) of a sole in the half-sitting posture."""
    return frame_positions(robot, robot.standing_q[None], robot.sole_frames[side])[0]


@pytest.mark.parametrize("gait_name", ["coman/hand_eight", "melson/hand_eight"])
def test_only_the_tracking_form_meets_the_hand(robots: dict[str, Robot], gait_name: str) -> None:
    errors = {}
    for form in FORMS:
        gait = load_gait(gait_name, (f"ik.prioritized.null_space={form}",))
        robot = robots[gait.robot or ""]
        tasks, com = inputs(robot, gait)
        errors[form] = worst(solve_ik(robot, tasks, com, gait.ik))
        assert errors[form]["com xy"] < 1e-4
        assert max(errors[form]["left sole"], errors[form]["right sole"]) < 1e-4
    assert errors["tracking"]["right hand"] < 1e-4  # [m]
    assert errors["projected"]["right hand"] > 1e-2


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("gait_name", [*BALANCES, "melson/walk_5cm"])
def test_motions_pass_every_static_check(
    robots: dict[str, Robot], gait_name: str, solver: str
) -> None:
    shorter = ("balance.duration=6.0",) if gait_name in BALANCES else ()
    gait = load_gait(gait_name, (f"ik.solver={solver}", *shorter))
    stages = run_stages(robots[gait.robot or ""], gait)
    assert [check for check in check_motion(stages.motion) if not check.ok] == []
    json.dumps(stages.joints.report_of(PrioritizedReport).to_dict(), allow_nan=False)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", ["coman", "coman_legs"])
def test_coman_walks(robots: dict[str, Robot], name: str, solver: str) -> None:
    """Tasks and ranks are checked; the servos would need a slower gait."""
    gait = load_gait("melson/walk_5cm", (f"ik.solver={solver}", "walk.single_support=1.0"))
    joints = solve_ik(robots[name], *inputs(robots[name], gait), gait.ik)
    assert all(error < 1e-4 for error in worst(joints).values())
    phases = joints.report_of(PrioritizedReport).phases
    seen = [(p.support, p.rows, p.rank, p.base_rank, p.count) for p in phases]
    assert seen == [("double", 12, 12, 6, 3), ("left", 6, 6, 6, 1), ("right", 6, 6, 6, 1)]
    assert [p.start for p in phases] == [0.0, 3.0, 5.2]


def test_a_hand_out_of_reach_disturbs_no_critical_task(robots: dict[str, Robot]) -> None:
    """The hand lags, its arm stays slow, and the hand returns when it is within reach again."""
    channels = "[{task: right_hand_x, wave: sine, amplitude: 0.6, frequency: 0.1}]"
    for solver in SOLVERS:
        settings = (f"balance.channels={channels}", f"ik.solver={solver}", "ik.on_limit=record")
        gait = load_gait("coman/hand_eight", (*settings, "balance.duration=10.0"))
        run = walk_through(robots["coman"], gait)
        errors = np.abs(measure_tasks(run.tasks, run.targets, run.configurations))
        assert errors[:, : run.m_critical].max() < 1e-4
        hand = np.linalg.norm(errors[:, run.tasks.rows[RIGHT_HAND]], axis=1)
        assert hand.max() > 0.05
        assert hand[-1] < 1e-3
        assert worst(run.finish())["right hand"] == pytest.approx(hand.max())


# --- support switches -------------------------------------------------------------------------


def test_handover_rises_after_lift_off_and_falls_before_landing() -> None:
    support = np.repeat([Support.DOUBLE, Support.LEFT, Support.DOUBLE, Support.RIGHT], 40)
    factor = handover_profile(support.astype(np.int8), 0.01, 0.1)
    assert factor[support == Support.DOUBLE].max() == 0.0
    for start, end in [(40, 80), (120, 160)]:
        assert factor[start] == 0.0
        assert_allclose(factor[start + 10 : end - 9], 1.0)
        assert_allclose(factor[start + 1 : end], factor[start + 1 : end][::-1])
        assert (np.diff(factor[start : start + 11]) > 0.0).all()
    assert_allclose(handover_profile(support, 0.01, 0.0), support != Support.DOUBLE)
    long = handover_profile(support, 0.01, 1.0)  # half the phase at most
    assert long[60] == 1.0
    assert (long[40:80] < 1.0).sum() == 39


def test_a_phase_of_one_sample_has_no_handover_time() -> None:
    support = np.array([0, 0, 1, 0, 0], np.int8)
    assert_allclose(handover_profile(support, 0.01, 0.1), [0, 0, 1, 0, 0])


def test_a_blend_meets_the_constraints_common_to_both_sets(robots: dict[str, Robot]) -> None:
    settings = ("ik.solver=prioritized", "ik.prioritized.null_space=projected")
    gait = load_gait("melson/walk_5cm", (*settings, "ik.on_limit=record"))
    run, rng = walk_through(robots["melson"], gait), np.random.default_rng(7)
    run.rates[:] = rng.normal(size=len(run.rates))
    k = int(np.flatnonzero(run.support == Support.LEFT)[0]) + 4
    assert 0.0 < run.handover[k] < 1.0
    v = run._blend(k)
    for part in (LEFT_SOLE, COM_XY):
        rows = run.tasks.rows[part]
        assert_allclose(run.tasks.J[rows] @ v, run.rates[rows], atol=1e-9)
    swing = run.tasks.rows[RIGHT_SOLE]  # level B in one of the two
    assert np.abs(run.tasks.J[swing] @ v - run.rates[swing]).max() > 0.01


def test_joints_do_not_jump_at_a_switch(robots: dict[str, Robot]) -> None:
    """In the projected form the two sets differ: without a handover time the joints jump."""
    near, far = {}, {}
    for handover in (0.0, 0.3):
        gait = load_gait(
            "melson/s3",
            ("ik.solver=prioritized", "ik.prioritized.null_space=projected",
             f"ik.prioritized.handover={handover}", "ik.on_limit=record"),
        )  # fmt: skip
        run = walk_through(robots["melson"], gait)
        bend = np.abs(np.diff(run.configurations[:, 7:], 2, axis=0)).max(axis=1) / gait.dt**2
        switches = np.flatnonzero(np.diff(run.support)) + 1
        is_near = np.zeros(len(bend), bool)
        for k in switches:
            is_near[k - 3 : k + 2] = True
        near[handover], far[handover] = bend[is_near].max(), bend[~is_near].max()
        errors = measure_tasks(run.tasks, run.targets, run.configurations)
        for side in Side:  # the sole that both sets have in common
            stands = run.support == Support.single(side)
            assert np.abs(errors[stands][:, run.tasks.rows[SOLES[side]]]).max() < 1e-5
    assert near[0.3] <= far[0.3]
    assert near[0.0] > 3.0 * near[0.3]


# --- the rest ---------------------------------------------------------------------------------


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_same_input_gives_the_same_joints(robots: dict[str, Robot], solver: str) -> None:
    gait = load_gait("coman/hand_eight", (f"ik.solver={solver}", "balance.duration=5.0"))
    tasks, com = inputs(robots["coman"], gait)
    calls: list[tuple[int, int]] = []
    first = solve_ik(robots["coman"], tasks, com, gait.ik)
    second = solve_ik(robots["coman"], tasks, com, gait.ik, lambda *done: calls.append(done))
    assert np.array_equal(first.angles, second.angles)
    assert first.report == second.report
    assert calls
    assert all(total == tasks.n_samples for _, total in calls)


def test_a_motion_starts_and_ends_at_rest(robots: dict[str, Robot]) -> None:
    """Redundant joints begin at the equilibrium of the pull to the posture."""
    run = walk_through(robots["coman"], load_gait("coman/hand_eight"))
    speed = np.abs(np.diff(run.configurations[:, 7:], axis=0)) / 0.01
    assert speed[:40].max() < 1e-5  # [rad/s]
    assert speed[-1].max() < 0.025  # half of what the check of rest allows


@pytest.mark.parametrize("solver", SOLVERS)
def test_critical_tasks_out_of_reach_are_refused(robots: dict[str, Robot], solver: str) -> None:
    settings = (f"ik.solver={solver}", "ik.prioritized.critical=[soles, com]",
                "ik.prioritized.extraneous=[torso]", "balance.com_height=0.7")  # fmt: skip
    gait = load_gait("coman/sway", settings)
    with pytest.raises(IkError) as caught:
        solve_ik(robots["coman"], *inputs(robots["coman"], gait), gait.ik)
    error = caught.value
    assert error.task.startswith(("com", "left sole", "right sole"))
    assert error.tolerance < error.residual < 1.0  # a distance, not infinity


def test_a_joint_beyond_its_limit_is_refused_or_recorded(robots: dict[str, Robot]) -> None:
    channels = "[{task: torso_pitch, wave: ramp, value: 1.2, start: 1.0, end: 4.0}]"
    settings = (f"balance.channels={channels}", "balance.com_height=0.5")
    gait = load_gait("coman/sway", settings)
    tasks, com = inputs(robots["coman"], gait)
    with pytest.raises(JointLimitError):
        solve_ik(robots["coman"], tasks, com, gait.ik)
    gait = load_gait("coman/sway", (*settings, "ik.on_limit=record"))
    joints = solve_ik(robots["coman"], tasks, com, gait.ik)
    robot = robots["coman"]
    assert ((joints.angles < robot.lower) | (joints.angles > robot.upper)).any()
