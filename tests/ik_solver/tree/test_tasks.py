"""Task values and Jacobians against finite differences and the floating-base robot."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.contact import Side
from mgs.ik_solver.tree.tasks import COM, LEFT_HAND, N_TASKS, RIGHT_HAND, SWING, TURN, TreeTasks
from mgs.robot import Robot

STEP = 1e-6  # [rad]
T_WORLD_SOLE = pin.SE3(pin.utils.rotate("z", -0.4), np.array([0.5, 0.1, 0.0]))

pytestmark = pytest.mark.parametrize("side", list(Side), ids=lambda side: side.label)


def placed_tasks(robot: Robot, side: Side) -> TreeTasks:
    tasks = TreeTasks(robot, side)
    tasks.place(T_WORLD_SOLE)
    return tasks


def random_angles(robot: Robot, n: int = 4) -> np.ndarray:
    return np.random.default_rng(5).uniform(robot.lower, robot.upper, size=(n, robot.n))


def test_the_jacobian_is_the_difference_quotient_of_the_tasks(any_robot: Robot, side: Side):
    tasks = placed_tasks(any_robot, side)
    for q in random_angles(any_robot):
        columns = []
        for j in range(any_robot.n):
            values = []
            for sign in (1.0, -1.0):
                moved = q.copy()
                moved[j] += sign * STEP
                tasks.update(moved)
                values.append((tasks.f.copy(), tasks.R.copy()))
            (f_ahead, R_ahead), (f_behind, R_behind) = values
            turn = pin.log3(R_ahead @ R_behind.T)  # in the world frame
            columns.append(np.concatenate([f_ahead - f_behind, turn]) / (2.0 * STEP))
        tasks.update(q)
        # truncation STEP^2, rounding 1e-16 / STEP
        assert_allclose(tasks.J, np.column_stack(columns), atol=1e-8)


def test_the_task_values_are_those_of_the_floating_robot(any_robot: Robot, side: Side):
    model, tasks = any_robot.model, placed_tasks(any_robot, side)
    data = model.createData()
    for joints in random_angles(any_robot):
        q = np.concatenate([pin.neutral(model)[:7], joints])
        pin.framesForwardKinematics(model, data, q)
        T_sole_base = data.oMf[any_robot.sole_frames[side]].inverse()
        q[:7] = pin.SE3ToXYZQUAT(T_WORLD_SOLE * T_sole_base)
        pin.framesForwardKinematics(model, data, q)
        tasks.update(joints[tasks.order])
        swing = data.oMf[any_robot.sole_frames[side.other]]
        assert_allclose(tasks.f[SWING], swing.translation, atol=1e-12)
        assert_allclose(tasks.R, swing.rotation, atol=1e-12)
        left, right = (data.oMf[frame].translation for frame in any_robot.hand_frames)
        assert_allclose(tasks.f[LEFT_HAND], left, atol=1e-12)
        assert_allclose(tasks.f[RIGHT_HAND], right, atol=1e-12)
        assert_allclose(tasks.f[COM], pin.centerOfMass(model, data, q), atol=1e-12)


def test_the_error_vanishes_at_the_target_and_points_to_it(any_robot: Robot, side: Side):
    """A small joint motion dq changes the tasks by J dq, which is the error before the motion."""
    tasks, error = placed_tasks(any_robot, side), np.empty(N_TASKS)
    rng = np.random.default_rng(2)
    for q in random_angles(any_robot):
        dq = 1e-5 * rng.normal(size=any_robot.n)
        tasks.update(q + dq)
        target, R_target = tasks.f.copy(), tasks.R.copy()
        tasks.error(target, R_target, error)
        assert_allclose(error, 0.0, atol=1e-14)
        tasks.update(q)
        tasks.error(target, R_target, error)
        assert_allclose(error, tasks.J @ dq, atol=1e-8)  # second order: |dq|^2 is 2e-9


def test_the_orientation_error_is_a_rotation_vector(melson: Robot, side: Side):
    """Turning the sole by the error about world axes gives its target, at any distance."""
    tasks, error = placed_tasks(melson, side), np.empty(N_TASKS)
    tasks.update(melson.posture[tasks.order])
    R_target = pin.utils.rotate("y", 1.2) @ pin.utils.rotate("x", -1.0)
    tasks.error(tasks.f, R_target, error)
    assert_allclose(pin.exp3(error[TURN]) @ tasks.R, R_target, atol=1e-12)


def test_the_tasks_are_independent_in_the_posture(melson: Robot, side: Side):
    """Fifteen tasks for nineteen joints have full row rank, far from any singularity."""
    tasks = placed_tasks(melson, side)
    tasks.update(melson.posture[tasks.order])
    assert tasks.J.shape == (15, 19)
    assert np.linalg.svd(tasks.J, compute_uv=False).min() > 1e-2


@pytest.mark.parametrize("asked", [(False, True), (True, False), (False, False)])
def test_rows_of_a_free_hand_are_zero_and_the_others_do_not_change(
    any_robot: Robot, side: Side, asked: tuple[bool, bool]
):
    free, whole = TreeTasks(any_robot, side, asked), placed_tasks(any_robot, side)
    free.place(T_WORLD_SOLE)
    rows = np.ones(N_TASKS, dtype=bool)
    for is_asked, row in zip(asked, (LEFT_HAND, RIGHT_HAND), strict=True):
        rows[row] = is_asked
    for q in random_angles(any_robot, 2):
        errors = []
        for tasks in (free, whole):
            tasks.update(q[tasks.order])
            errors.append(np.empty(N_TASKS))
            positions = np.where(rows[:12] | (tasks is whole), 0.3, np.nan)
            tasks.error(positions, pin.utils.rotate("x", 0.1), errors[-1])
        assert_allclose(free.J, np.where(rows[:, None], whole.J, 0.0), atol=0)
        assert_allclose(errors[0], np.where(rows, errors[1], 0.0), atol=0)
        assert np.array_equal(free.f, whole.f)
