"""Eqs. (7), (16), (17) and footnote 3 against a textbook implementation: NumPy's pseudo-inverses.

The oracle integrates whole motions with its own Jacobians from Pinocchio and its own task errors.
"""

from __future__ import annotations

import functools

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.com_generator import ComTrajectory
from mgs.core.contact import Side
from mgs.gait import load_gait
from mgs.ik_solver.floating.printed_levels import (
    DAMPING,
    PRINTED_FORMS,
    PrintedForm,
    printed_solution,
)
from mgs.ik_solver.prioritized import PrioritizedIk, PrioritizedRun
from mgs.motion_planner import plan_motion
from mgs.pipeline import first_com
from mgs.robot import load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories

A, B, E = slice(0, 14), slice(14, 17), slice(17, 21)
LEVELS = [A, B, E]
KAPPA = 0.5  # default feedback


def textbook(form: PrintedForm, J: np.ndarray, r: np.ndarray, levels=LEVELS) -> np.ndarray:
    """The equations with explicit pseudo-inverses and projectors."""
    a, b, e = levels
    pinv, one = np.linalg.pinv, np.eye(J.shape[1])
    if form == "equation_7":
        return pinv(J) @ r
    J_AB = J[: b.stop]
    N_A = one - pinv(J[a]) @ J[a]
    N_AB = one - pinv(J_AB) @ J_AB
    if form == "footnote_3":
        damped = J_AB.T @ np.linalg.inv(J_AB @ J_AB.T + DAMPING**2 * np.eye(len(J_AB)))
        N_AB = N_A @ (one - damped @ J_AB)
    return pinv(J[a]) @ r[a] + N_A @ pinv(J[b]) @ r[b] + N_AB @ pinv(J[e]) @ r[e]


@pytest.mark.parametrize("form", PRINTED_FORMS)
@pytest.mark.parametrize("seed", range(5))
def test_a_solution_equals_the_textbook(form: PrintedForm, seed: int):
    rng = np.random.default_rng(seed)
    J, r = rng.normal(size=(21, 29)), rng.normal(size=21)
    assert_allclose(printed_solution(form, J, r, LEVELS), textbook(form, J, r), atol=1e-10)


@pytest.mark.parametrize("form", ["equation_16", "footnote_3"])
def test_level_a_is_met_whatever_the_others_ask_for(form: PrintedForm):
    rng = np.random.default_rng(7)
    J, r = rng.normal(size=(21, 29)), 10.0 * rng.normal(size=21)
    assert_allclose(J[A] @ printed_solution(form, J, r, LEVELS), r[A], atol=1e-10)


def test_equation_7_meets_all_rows():
    rng = np.random.default_rng(8)
    J, r = rng.normal(size=(21, 29)), rng.normal(size=21)
    assert_allclose(J @ printed_solution("equation_7", J, r, LEVELS), r, atol=1e-10)


def test_dependent_rows_have_no_right_inverse():
    rng = np.random.default_rng(9)
    J = rng.normal(size=(21, 29))
    J[1] = J[0] = 0.0
    with pytest.raises(np.linalg.LinAlgError):
        printed_solution("equation_16", J, np.ones(21), LEVELS)


@functools.cache
def eight(form: PrintedForm) -> tuple[TaskTrajectory, ComTrajectory, PrioritizedRun]:
    """Tasks of the figure eight, and the run that has followed them."""
    settings = (
        f"ik.prioritized.null_space={form}",
        "balance.duration=4.0",
        "balance.rest=0.1",
        "balance.ease=0.5",
    )
    robot, gait = load_robot("coman"), load_gait("coman/hand_eight", settings)
    tasks = plan_trajectories(plan_motion(robot, gait))
    com = first_com(robot, gait, tasks)
    run = PrioritizedRun(PrioritizedIk.from_parameters(gait.ik), robot, tasks, com)
    run.start()
    for k in range(1, tasks.n_samples):
        run.step(k)
    return tasks, com, run


@pytest.mark.parametrize("form", PRINTED_FORMS)
def test_a_whole_motion_equals_the_textbook_within_a_microradian_per_second(form: PrintedForm):
    """Joint velocities of every sample, from the configuration at the sample before."""
    tasks, com_ref, run = eight(form)
    robot, dt = run.robot, tasks.dt
    model, data = robot.model, robot.model.createData()
    frames = (*robot.sole_frames, robot.hand_frames[Side.RIGHT], robot.torso_frame)

    def targets(k: int) -> tuple[list[pin.SE3], np.ndarray, np.ndarray, np.ndarray]:
        soles = [pin.XYZQUATToSE3(pose) for pose in tasks.soles[k]]
        torso = pin.Quaternion(*tasks.torso[k, [3, 0, 1, 2]]).matrix()
        hand = com_ref.position[k] + tasks.hands[k, Side.RIGHT]  # its offset from the CoM
        return soles, hand, torso, com_ref.position[k]

    def rates(k: int, places: list[pin.SE3], com: np.ndarray) -> np.ndarray:
        """Level rates for the step to sample k: reference step plus kappa times the error."""
        before, now = targets(k - 1), targets(k)
        rows = []
        for i in (0, 1):
            gap = before[0][i].translation - places[i].translation
            turn = pin.log3(before[0][i].rotation @ places[i].rotation.T)
            rows += [now[0][i].translation - before[0][i].translation + KAPPA * gap]
            rows += [pin.log3(now[0][i].rotation @ before[0][i].rotation.T) + KAPPA * turn]
        step, gap = now[3] - before[3], before[3] - com
        rows.append((step + KAPPA * gap)[:2])
        rows.append(now[1] - before[1] + KAPPA * (before[1] - places[2].translation))
        turn = pin.log3(before[2] @ places[3].rotation.T)
        rows.append(pin.log3(now[2] @ before[2].T) + KAPPA * turn)
        rows.append((step + KAPPA * gap)[2:])
        return np.concatenate(rows) / dt

    worst = 0.0
    for k in range(1, tasks.n_samples):
        q = run.configurations[k - 1]
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        J_com = pin.jacobianCenterOfMass(model, data, q)
        kind = pin.LOCAL_WORLD_ALIGNED
        J = [pin.getFrameJacobian(model, data, f, kind) for f in frames]
        stacked = np.vstack([J[0], J[1], J_com[:2], J[2][:3], J[3][3:], J_com[2:]])
        places = [data.oMf[f].copy() for f in frames]
        v = textbook(form, stacked, rates(k, places, data.com[0]))
        found = pin.difference(model, q, run.configurations[k]) / dt
        worst = max(worst, float(np.abs(found - v)[6:].max()))
    assert worst < 1e-6  # [rad/s]


def test_equation_16_degrades_the_hand_and_equation_7_does_not():
    """As the paper says: the hand works in the null space of level A and is less accurate."""
    errors = {}
    for form in PRINTED_FORMS:
        tasks, com, run = eight(form)
        model, data, worst = run.robot.model, run.robot.model.createData(), 0.0
        for q, hand in zip(
            run.configurations, com.position + tasks.hands[:, Side.RIGHT], strict=True
        ):
            pin.framesForwardKinematics(model, data, q)
            found = data.oMf[run.robot.hand_frames[Side.RIGHT]].translation
            worst = max(worst, float(np.linalg.norm(found - hand)))
        errors[form] = worst
    assert errors["equation_16"] > 0.005
    assert errors["footnote_3"] > 0.005
    assert errors["equation_7"] < 0.01 * errors["equation_16"]  # that of explicit steps of 10 ms
