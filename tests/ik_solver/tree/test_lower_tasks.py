"""Angular momentum in the null space: against Pinocchio's, against the tasks above, on a walk."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.contact import Side
from mgs.core.geometry import quat_xyzw_from_yaw
from mgs.gait import load_gait
from mgs.ik_solver.tree.least_norm import LeastNorm
from mgs.ik_solver.tree.lower_tasks import MOMENTUM_DAMPING, LowerTasks
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.judge.motion_checks import Check, check_motion
from mgs.motion import Motion
from mgs.motion.dynamics import place_on_soles
from mgs.motion_planner import plan_motion
from mgs.pipeline import run_stages
from mgs.robot import Robot, load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories

FREE = ("walk.hands=free", "walk.arm_swing=0", "ik.gamma_momentum=1")
HELD = ("walk.hands=held", "ik.gamma_momentum=0")
EYE = np.eye(3)


@pytest.mark.parametrize("side", list(Side))
def test_the_row_gives_the_angular_momentum_of_the_robot_that_stands_on_a_sole(
    any_robot: Robot, side: Side
):
    rng, step, robot = np.random.default_rng(5), 1e-5, any_robot
    tree = TreeTasks(robot, side)
    sole = np.concatenate([[0.3, -0.2, 0.1], quat_xyzw_from_yaw(0.8)])
    tree.place(pin.XYZQUATToSE3(sole))
    middle = robot.posture + 0.1 * rng.normal(size=robot.n)
    speed = rng.normal(size=robot.n)
    around = middle + np.array([[-0.5], [0.0], [0.5]]) * step * speed
    q = place_on_soles(robot, around, np.full(3, side, np.int8), np.tile(sole, (3, 2, 1)))
    v = pin.difference(robot.model, q[0], q[2]) / step
    expected = pin.computeCentroidalMomentum(robot.model, robot.model.createData(), q[1], v)
    found = tree.yaw_momentum(middle[tree.order]) @ speed[tree.order]
    assert found == pytest.approx(expected.angular[2], abs=1e-7)


def planned(robot: Robot) -> TaskTrajectory:
    return plan_trajectories(plan_motion(robot, load_gait("melson/walk_practical", FREE)))


@pytest.mark.parametrize("torso", ["free", "upright"])
def test_momentum_is_taken_away_and_no_task_above_notices(melson: Robot, torso: str):
    tasks, rng = planned(melson), np.random.default_rng(2)
    assert tasks.hands_asked == (False, False)
    tree = TreeTasks(melson, Side.LEFT, tasks.hands_asked)
    tree.place(pin.XYZQUATToSE3(tasks.soles[0, Side.LEFT]))
    q = melson.posture[tree.order]
    tree.update(q)
    solver = LeastNorm(tree.rows, 1e-6)
    solver.v[:] = 0.0
    error = np.zeros(tree.n_rows)
    error[tree.asked_rows] = 0.01 * rng.normal(size=len(tree.asked_rows))
    step = solver.step(error)
    above, below = (
        LowerTasks(melson, tasks, torso, gamma).add(tree, solver, step, q, 0) for gamma in (0, 1)
    )
    assert_allclose(tree.J @ below, tree.J @ above, atol=1e-9)
    J_torso, _ = tree.torso_error(EYE)
    if torso == "upright":  # up to the damping, which matters where the torso has little room
        change = J_torso @ (below - above)
        assert np.linalg.norm(change) < 0.02 * np.linalg.norm(below - above)
    J = tree.J[tree.asked_rows]
    stack = J if torso == "free" else np.vstack([J, J_torso])
    momentum = tree.yaw_momentum(q)
    momentum /= np.linalg.norm(momentum)
    room = np.linalg.norm(momentum - momentum @ np.linalg.pinv(stack, rcond=1e-6) @ stack)
    left = MOMENTUM_DAMPING**2 / (room**2 + MOMENTUM_DAMPING**2)
    assert left < 0.5
    assert momentum @ below == pytest.approx(left * momentum @ above, rel=0.05)


def test_no_lower_task_is_no_work(melson: Robot):
    tasks = planned(melson)
    assert not LowerTasks(melson, tasks, "free", 0.0)
    assert LowerTasks(melson, tasks, "free", 0.5)
    assert LowerTasks(melson, tasks, "upright", 0.0)


def yaw_friction(motion: Motion) -> Check:
    return next(check for check in check_motion(motion) if check.name == "yaw_friction")


@pytest.mark.parametrize(
    ("name", "held"),
    [("melson/walk_fastest", (*HELD, "walk.arm_swing=0.35")), ("coman/walk_fastest", HELD)],
)
def test_free_arms_spare_the_fastest_walks_half_of_their_yaw_friction(
    name: str, held: tuple[str, ...]
):
    with_free, with_held = (
        run_stages(load_robot(gait.robot or "melson"), gait, "arms").motion
        for gait in (load_gait(name, settings) for settings in (FREE, held))
    )
    assert [check.name for check in check_motion(with_free) if not check.ok] == []
    freed, bound = yaw_friction(with_free), yaw_friction(with_held)
    assert freed.value < 0.5 * bound.value
    assert freed.value / freed.limit < 0.5 * bound.value / bound.limit


def test_hands_that_are_free_do_not_swing_by_a_rule():
    with pytest.raises(Exception, match=r"arm_swing = 0\.4 .* hands: held"):
        load_gait("melson/walk_swinging", ("walk.hands=free",))
