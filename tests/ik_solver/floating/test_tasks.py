"""Tasks of the floating-base robot: Jacobian, error and steps against forward kinematics alone."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.com_generator import follow_com, generate_com
from mgs.core.contact import Side
from mgs.gait import BalanceGait, Gait, load_gait
from mgs.ik_solver.floating.parts import (
    COM,
    COM_XY,
    COM_Z,
    LEFT_HAND,
    LEFT_SOLE,
    RIGHT_HAND,
    RIGHT_SOLE,
    TORSO,
    Part,
    parts_of,
)
from mgs.ik_solver.floating.targets import body_targets
from mgs.ik_solver.floating.tasks import BodyTasks
from mgs.motion_planner import plan_motion
from mgs.robot import Robot, load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories

SIZES = {
    COM: 3, COM_XY: 2, COM_Z: 1, TORSO: 3,
    LEFT_SOLE: 6, RIGHT_SOLE: 6, LEFT_HAND: 3, RIGHT_HAND: 3,
}  # fmt: skip
PARTS = (COM, LEFT_SOLE, TORSO, RIGHT_HAND, COM_XY, RIGHT_SOLE, LEFT_HAND, COM_Z)


@pytest.fixture(scope="module", params=["melson", "coman_legs"])
def robot(request: pytest.FixtureRequest) -> Robot:
    return load_robot(request.param)


def any_configuration(robot: Robot, rng: np.random.Generator) -> np.ndarray:
    """Random joint angles within their ranges, random position and orientation of the base."""
    quat = rng.normal(size=4)
    joints = rng.uniform(robot.lower, robot.upper)
    return np.concatenate([rng.uniform(-1.0, 1.0, 3), quat / np.linalg.norm(quat), joints])


def places(robot: Robot, q: np.ndarray) -> dict[Part, tuple[np.ndarray, np.ndarray | None]]:
    """Position and rotation of every part, straight from forward kinematics."""
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, q)
    com = pin.centerOfMass(model, data, q).copy()
    out: dict[Part, tuple[np.ndarray, np.ndarray | None]] = {
        COM: (com, None),
        COM_XY: (com[:2], None),
        COM_Z: (com[2:], None),
        TORSO: (np.empty(0), data.oMf[robot.torso_frame].rotation.copy()),
    }
    for part, side in ((LEFT_SOLE, Side.LEFT), (RIGHT_SOLE, Side.RIGHT)):
        sole = data.oMf[robot.sole_frames[side]]
        out[part] = (sole.translation.copy(), sole.rotation.copy())
    for part, side in ((LEFT_HAND, Side.LEFT), (RIGHT_HAND, Side.RIGHT)):
        out[part] = (data.oMf[robot.hand_frames[side]].translation.copy(), None)
    return out


def displacement(robot: Robot, parts: tuple[Part, ...], q0: np.ndarray, q1: np.ndarray):
    """Change (m,) of the tasks from q0 to q1; turns as rotation vectors in the world."""
    before, after = places(robot, q0), places(robot, q1)
    rows = []
    for part in parts:
        rows.append(after[part][0] - before[part][0])
        R0, R1 = before[part][1], after[part][1]
        if R0 is not None and R1 is not None:
            rows.append(pin.log3(R1 @ R0.T))
    return np.concatenate(rows)


def plan(robot: Robot, gait: Gait) -> TaskTrajectory:
    return plan_trajectories(plan_motion(robot, gait))


def balance(*channels: dict[str, object], dt: float = 0.01) -> BalanceGait:
    return BalanceGait.model_validate(
        {
            "mgs": 1,
            "motion": "balance",
            "dt": dt,
            "balance": {"duration": 2.0, "rest": 0.2, "ease": 0.4, "channels": list(channels)},
        }
    )


# --- Jacobian ---------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_the_jacobian_is_the_central_difference_along_the_manifold(robot: Robot, seed: int):
    rng, h = np.random.default_rng(seed), 1e-5
    q = any_configuration(robot, rng)
    tasks = BodyTasks(robot, PARTS)
    tasks.update(any_configuration(robot, rng))  # no data of an earlier update may remain
    tasks.update(q)
    for j in range(robot.model.nv):
        v = np.zeros(robot.model.nv)
        v[j] = h
        ahead, behind = (pin.integrate(robot.model, q, s * v) for s in (1.0, -1.0))
        difference = displacement(robot, PARTS, behind, ahead) / (2.0 * h)
        # h^2 of the truncation and 1e-16 / h of the rounding leave about 1e-10
        assert_allclose(tasks.J[:, j], difference, atol=1e-8)


@pytest.mark.parametrize("seed", range(3))
def test_the_derivative_of_the_com_velocity_is_its_central_difference(robot: Robot, seed: int):
    """J_com(q) v along the manifold, at constant velocities of base and joints."""
    rng, h = np.random.default_rng(seed), 1e-5
    q, v = any_configuration(robot, rng), rng.normal(size=robot.model.nv)
    tasks = BodyTasks(robot, PARTS)
    tasks.update(q)
    J = tasks.J.copy()
    derivative = np.array(tasks.com_velocity_derivative(q, v))
    data = robot.model.createData()
    for j in range(robot.model.nv):
        step = np.zeros(robot.model.nv)
        step[j] = h
        ahead, behind = (
            pin.jacobianCenterOfMass(robot.model, data, pin.integrate(robot.model, q, s * step)) @ v
            for s in (1.0, -1.0)
        )
        assert_allclose(derivative[:, j], (ahead - behind) / (2.0 * h), atol=1e-8)
    assert np.array_equal(tasks.J, J)  # the Jacobian does not change


def test_rows_are_the_parts_in_their_order(robot: Robot):
    tasks = BodyTasks(robot, PARTS)
    q = any_configuration(robot, np.random.default_rng(9))
    tasks.update(q)
    found = places(robot, q)
    end = 0
    for part in PARTS:
        assert tasks.rows[part] == slice(end, end + SIZES[part])
        end += SIZES[part]
        position = found[part][0]
        assert_allclose(tasks.f[tasks.rows[part]][: len(position)], position, atol=1e-12)
        assert not tasks.f[tasks.rows[part]][len(position) :].any()  # rotations
    assert tasks.m == end == len(tasks.J)


# --- error ------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_the_error_is_target_minus_actual_however_far_apart(robot: Robot, seed: int):
    """Positions differ by the error; turning R by the error, in the world, gives R_ref."""
    rng = np.random.default_rng(seed)
    q, goal = any_configuration(robot, rng), any_configuration(robot, rng)
    tasks = BodyTasks(robot, PARTS)
    tasks.update(goal)
    wanted = places(robot, goal)
    x = tasks.f.copy()
    rotations = np.array([R for part in PARTS if (R := wanted[part][1]) is not None])
    tasks.update(q)
    error = np.full(tasks.m, np.nan)
    tasks.error(x, rotations, error)
    actual = places(robot, q)
    for part in PARTS:
        rows, position = tasks.rows[part], actual[part][0]
        n = len(position)
        assert_allclose(position + error[rows][:n], wanted[part][0], atol=1e-12)
        R, R_ref = actual[part][1], wanted[part][1]
        if R is not None:
            assert_allclose(pin.exp3(error[rows][n:]) @ R, R_ref, atol=1e-7)  # log near pi


def test_a_step_of_J_pinv_times_the_error_comes_closer(robot: Robot):
    """Error and Jacobian have consistent signs: Newton's method converges quadratically."""
    q = robot.standing_q.copy()
    goal = pin.integrate(
        robot.model, q, np.random.default_rng(1).normal(scale=0.03, size=robot.model.nv)
    )
    parts = (LEFT_SOLE, RIGHT_SOLE, TORSO, COM)
    tasks = BodyTasks(robot, parts)
    tasks.update(goal)
    x = tasks.f.copy()
    wanted = places(robot, goal)
    rotations = np.array([R for part in parts if (R := wanted[part][1]) is not None])
    error, sizes = np.empty(tasks.m), []
    for _ in range(4):
        tasks.update(q)
        tasks.error(x, rotations, error)
        sizes.append(np.abs(error).max())
        q = pin.integrate(robot.model, q, np.linalg.pinv(tasks.J) @ error)
    assert sizes[0] > 1e-2
    assert sizes[1] < 0.2 * sizes[0]
    assert sizes[-1] < 1e-6


# --- targets ----------------------------------------------------------------------------------


def assert_steps_lead_along(parts: tuple[Part, ...], tasks: TaskTrajectory) -> None:
    walk = load_gait("melson/walk_5cm")
    com = (
        generate_com(load_robot("melson"), tasks, walk.com)
        if tasks.com is None
        else follow_com(tasks.com, tasks.dt)
    )
    targets = body_targets(parts, tasks, com)
    assert not targets.steps[0].any()
    start, turning = 0, 0
    for part in parts:
        rows = slice(start, start + SIZES[part])
        start = rows.stop
        steps, x = targets.steps[:, rows], targets.x[:, rows]
        if part in (TORSO, LEFT_SOLE, RIGHT_SOLE):
            R_ref = targets.rotations[:, turning]
            turning += 1
            R = R_ref[0]
            for k in range(1, len(R_ref)):
                R = pin.exp3(steps[k, -3:]) @ R
                assert_allclose(R, R_ref[k], atol=1e-10)
            assert not x[:, -3:].any()
            steps, x = steps[:, :-3], x[:, :-3]
        assert_allclose(x[0] + np.cumsum(steps, axis=0), x, atol=1e-12)
    assert turning == targets.rotations.shape[1]
    assert start == targets.x.shape[1]


def test_steps_add_up_to_the_references_of_a_turning_walk():
    robot = load_robot("melson")
    gait = load_gait("melson/walk_arc", ("walk.n_steps=3",))
    tasks = plan(robot, gait)
    assert np.ptp(tasks.soles[:, :, 6]) > 1e-3  # the soles do turn
    assert_steps_lead_along((LEFT_SOLE, COM_Z, RIGHT_SOLE, TORSO, COM), tasks)


def test_steps_add_up_to_the_references_of_a_balance_motion():
    tasks = plan(
        load_robot("melson"),
        balance(
            {"task": "torso_yaw", "wave": "sine", "amplitude": 0.5, "frequency": 1.0},
            {"task": "torso_pitch", "wave": "constant", "value": 0.3},
            {"task": "com_z", "wave": "sine", "amplitude": 0.02, "frequency": 2.0},
            {"task": "left_hand_x", "wave": "constant", "value": 0.02},
        ),
    )
    assert_steps_lead_along((COM, TORSO, LEFT_SOLE, RIGHT_SOLE, LEFT_HAND), tasks)


def test_targets_are_those_of_the_stages_before():
    """References come as positions of the CoM, soles, and hands in the world."""
    robot = load_robot("melson")
    gait = load_gait("melson/walk_5cm")
    tasks = plan(robot, gait)
    com = generate_com(robot, tasks, gait.com)
    targets = body_targets((RIGHT_HAND, LEFT_SOLE, COM_XY, COM_Z, TORSO), tasks, com)
    for k in (0, 300, 600, len(targets.x) - 1):
        x = targets.x[k]
        assert_allclose(x[:3], tasks.hands[k, Side.RIGHT] + com.position[k], atol=1e-15)
        assert_allclose(x[3:6], tasks.soles[k, Side.LEFT, :3], atol=1e-15)
        assert_allclose(x[9:12], com.position[k], atol=1e-15)
        for R, quat in zip(
            targets.rotations[k], (tasks.soles[k, Side.LEFT, 3:], tasks.torso[k]), strict=True
        ):
            assert_allclose(R, pin.Quaternion(quat).matrix(), atol=1e-12)


# --- parts ------------------------------------------------------------------------------------


def test_free_hands_are_left_out():
    robot = load_robot("melson")
    tasks = plan(robot, balance({"task": "left_hand_z", "wave": "constant", "value": 0.02}))
    assert tasks.hands_asked == (True, False)
    assert parts_of(["hands", "com"], tasks) == (LEFT_HAND, COM)
    tasks = plan(robot, balance({"task": "com_x", "wave": "constant", "value": 0.01}))
    assert parts_of(["soles", "torso", "hands"], tasks) == (LEFT_SOLE, RIGHT_SOLE, TORSO)
    walking = plan(robot, load_gait("melson/walk_5cm"))
    assert parts_of(["hands", "soles"], walking) == (LEFT_HAND, RIGHT_HAND, LEFT_SOLE, RIGHT_SOLE)
