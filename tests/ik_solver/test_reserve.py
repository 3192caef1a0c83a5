"""The reserve of ik4 and ik5: knees that bend ahead of a sample which no step could meet.

Hard rows and the CoM are measured with Pinocchio alone. The motion is task C of Faraji and
Ijspeert, a squat above reach with roll and pitch of the torso.
"""

from __future__ import annotations

import functools

import numpy as np
import pinocchio as pin
import pytest

from mgs.core.errors import IkError
from mgs.gait import BalanceGait
from mgs.ik_solver import JointTrajectory, solve_ik
from mgs.ik_solver.floating.hard_soft_report import FarajiReport
from mgs.ik_solver.floating.reserve import FIRST, HOLD, LARGEST, RAMP, Reserve
from mgs.ik_solver.floating.safety_region import SafetyRegion
from mgs.motion_planner import plan_motion
from mgs.pipeline import first_com
from mgs.robot import load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories
from tests.ik_solver.test_hard_soft import TILTING, squat

SPEED = 4.0


def task_c(dt: float, method: str, duration: float, reserve: bool = True) -> BalanceGait:
    tuning = {"damping": 1e-2, "speed_max": SPEED, "gamma": 10.0, "reserve": reserve}
    ik = {"solver": method, "faraji": tuning}
    gait = squat(-0.03, *TILTING, dt=dt, duration=duration, ik=ik)
    return gait


@functools.cache
def solved(
    dt: float, method: str, duration: float, reserve: bool
) -> tuple[TaskTrajectory, np.ndarray, JointTrajectory]:
    robot = load_robot("coman_legs")
    gait = task_c(dt, method, duration, reserve)
    tasks = plan_trajectories(plan_motion(robot, gait))
    com = first_com(robot, gait, tasks)
    return tasks, com.position, solve_ik(robot, tasks, com, gait.ik)


def misses(tasks: TaskTrajectory, com: np.ndarray, joints: JointTrajectory) -> tuple[float, float]:
    """Largest miss of the right sole and the torso [m, rad], and of the horizontal CoM [m].

    The left sole is put where its reference is, so that its miss shows in the other tasks.
    """
    robot = load_robot("coman_legs")
    data, worst, sideways = robot.model.createData(), 0.0, 0.0
    left, right = robot.sole_frames
    for k, angles in enumerate(joints.angles):
        q = pin.neutral(robot.model)
        q[7:] = angles
        pin.framesForwardKinematics(robot.model, data, q)
        base = pin.XYZQUATToSE3(tasks.soles[k, 0]) * data.oMf[left].inverse()
        sole = base * data.oMf[right]
        torso = base.rotation @ data.oMf[robot.torso_frame].rotation
        wanted = pin.XYZQUATToSE3(tasks.soles[k, 1])
        asked = pin.Quaternion(*tasks.torso[k, [3, 0, 1, 2]]).matrix()
        turn = pin.log3(asked @ torso.T)
        gap = np.abs(np.concatenate([pin.log6(wanted.actInv(sole)).vector, turn])).max()
        centre = base.act(pin.centerOfMass(robot.model, data, q))
        worst = max(worst, float(gap))
        sideways = max(sideways, float(np.linalg.norm((centre - com[k])[:2])))
    return worst, sideways


def report(joints: JointTrajectory) -> FarajiReport:
    return joints.report_of(FarajiReport)


def test_without_a_reserve_task_c_misses_its_hard_rows_at_2_ms():
    tasks, com, joints = solved(0.002, "ik4", 3.0, False)
    hard, sideways = misses(tasks, com, joints)
    assert report(joints).elastic_samples > 10
    assert hard > 1e-3
    assert sideways > 0.02


@pytest.mark.parametrize("dt", [0.01, 0.005, 0.002])
def test_with_a_reserve_task_c_holds_at_every_period(dt: float):
    tasks, com, joints = solved(dt, "ik4", 3.0, True)
    hard, sideways = misses(tasks, com, joints)
    assert hard < 1e-4  # [m] and [rad]
    assert sideways < 5e-3
    assert report(joints).elastic_samples == 0


@pytest.mark.slow
@pytest.mark.parametrize("method", ["ik4", "ik5"])
@pytest.mark.parametrize("dt", [0.01, 0.005, 0.002, 0.001])
def test_the_whole_of_task_c_holds_at_every_period(dt: float, method: str):
    hard, sideways = misses(*solved(dt, method, 7.0, True))
    assert hard < 1e-4
    assert sideways < 5e-3


def test_the_reserve_keeps_the_safety_region():
    robot = load_robot("coman_legs")
    _, _, joints = solved(0.002, "ik4", 3.0, True)
    assert report(joints).returns > 0
    region = SafetyRegion(
        robot.lower, robot.upper, np.minimum(SPEED, robot.speed_limit), 0.002, "ellipse"
    )
    assert region.excess(joints.angles[:-1], joints.angles[1:]).max() < 1e-9


def test_a_motion_without_misses_is_not_changed():
    with_reserve, without = (solved(0.01, "ik4", 3.0, r)[2] for r in (True, False))
    assert report(with_reserve).returns == 0
    np.testing.assert_array_equal(with_reserve.angles, without.angles)


def test_a_motion_that_stays_infeasible_is_refused_and_the_cause_named():
    robot = load_robot("coman_legs")
    gait = task_c(0.002, "ik4", 3.0, reserve=False)
    ik = gait.ik.model_copy(update={"on_limit": "refuse"})
    tasks = plan_trajectories(plan_motion(robot, gait))
    with pytest.raises(IkError, match="safety region of the joints meets all hard tasks"):
        solve_ik(robot, tasks, first_com(robot, gait, tasks), ik)


def test_the_bound_rises_smoothly_and_grows_with_every_return():
    reserve = Reserve(1001, 0.002)
    assert reserve.back_from(500) == 500 - round((HOLD + RAMP) / 0.002)
    first = reserve.bend.copy()
    assert first.max() == pytest.approx(FIRST)
    assert np.flatnonzero(first)[0] == 500 - round((HOLD + RAMP) / 0.002) + 1
    # a cosine of half a period over RAMP has this largest slope
    assert np.abs(np.diff(first)).max() / 0.002 <= FIRST * np.pi / (2 * RAMP) + 1e-6
    levels = [first[500]]
    while reserve.back_from(500) is not None:
        levels.append(reserve.bend[500])
    assert np.all(np.diff(levels) > 0.0)
    assert levels[-1] <= LARGEST


def test_the_bound_never_leaves_the_interval_of_a_joint():
    reserve = Reserve(11, 0.1)
    reserve.back_from(5)
    low, high = np.array([0.0, -0.05]), np.array([0.03, 0.0])
    reserve.apply(5, np.zeros(2), np.array([1.0, -1.0]), low, high)
    np.testing.assert_allclose(low, [0.03, -0.05])
    np.testing.assert_allclose(high, [0.03, -0.05])
