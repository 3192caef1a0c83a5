"""Joints held at the limits of their range and speed by the closed-loop IK."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin
import piqp
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import minimize

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.errors import IkError, JointLimitError, JointSpeedError
from mgs.gait import WalkGait
from mgs.ik_solver import solve_ik
from mgs.ik_solver.clik import ClosedLoopReport
from mgs.ik_solver.residuals import TaskRows
from mgs.ik_solver.tree.joint_bounds import JointBounds
from mgs.ik_solver.tree.targets import tree_targets
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.motion_planner import plan_motion
from mgs.pipeline import Stages, first_com, run_stages
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories
from tests.support.strategies import walk_gait

SHORT = {"n_steps": 2, "step_length": 0.05, "first_support": "left", "double_support": 0.5}


def narrowed(robot: Robot, **limits: np.ndarray) -> Robot:
    """The robot with other `lower`, `upper` or `speed_limit` (n,)."""
    return dataclasses.replace(robot, **limits)


def gait(on_limit: str = "hold", torso: str = "free", **walk: Any) -> WalkGait:
    ik = {"on_limit": on_limit, "torso": torso, "gamma_joint": 0.0}
    return walk_gait(**{**SHORT, **walk}, ik=ik, com={"passes": 0})


def steps(stages: Stages) -> np.ndarray:
    """Joint speeds (N - 1, n) between samples [rad/s]."""
    return np.diff(stages.joints.angles, axis=0) / stages.gait.dt


def held_steps(stages: Stages) -> int:
    return stages.joints.report_of(ClosedLoopReport).held_steps


def assert_tasks_met(stages: Stages) -> None:
    """Soles and CoM of the floating-base robot, which the solver does not use."""
    motion = stages.motion
    assert np.abs(motion.soles[..., :3] - motion.soles_ref[..., :3]).max() < 1e-4
    assert np.abs(motion.com - motion.com_ref).max() < 2e-4


# --- one step ---------------------------------------------------------------------------------


def bounds_of(robot: Robot, rows: int, dt: float = 0.01) -> JointBounds:
    return JointBounds(robot, np.arange(robot.n), np.arange(rows), dt)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), lower_task=st.booleans())
def test_a_step_is_the_nearest_within_the_bounds(melson: Robot, seed: int, lower_task: bool):
    """The same problem by PIQP, an interior-point solver."""
    rng = np.random.default_rng(seed)
    n, m, dt = melson.n, 6, 0.01
    bounds = bounds_of(melson, m, dt)
    q = rng.uniform(melson.lower, melson.upper)
    J, J_low = rng.normal(size=(m, n)), rng.normal(size=(3, n))
    stride = melson.speed_limit * dt
    low = np.maximum(-stride, melson.lower - q)
    high = np.minimum(stride, melson.upper - q)
    inside = low + rng.uniform(0.2, 0.8, n) * (high - low)
    error = J @ inside  # so that a step within the bounds exists
    dq = inside + rng.normal(size=n) * stride
    step = bounds.limit(dq, q, q, J, error, J_low if lower_task else None)
    assert np.all(step >= low - 1e-12) and np.all(step <= high + 1e-12)
    assert_allclose(J @ step, error, atol=1e-8)

    gentle = 0.1  # dt over the time in which a joint approaches its limit
    ranges = (melson.lower - q, melson.upper - q)
    boxes = [
        (np.maximum(-stride, share * ranges[0]), np.minimum(stride, share * ranges[1]))
        for share in (gentle, 1.0)
    ]
    H = np.eye(n) + (J_low.T @ J_low if lower_task else 0.0)
    for box in boxes:
        solver = piqp.DenseSolver()
        solver.settings.eps_abs = solver.settings.eps_rel = 1e-11
        solver.setup(H, -H @ dq, A=J, b=error, x_l=box[0], x_u=box[1])
        if solver.solve() == piqp.PIQP_SOLVED:
            assert_allclose(step, solver.result.x, atol=1e-6)
            return
    pytest.fail("PIQP finds no step within the bounds")


def test_a_step_within_the_bounds_is_left_alone(melson: Robot):
    q, dq = melson.posture, np.full(melson.n, 1e-3)
    J = np.random.default_rng(0).normal(size=(6, melson.n))
    bounds = bounds_of(melson, 6)
    assert bounds.limit(dq, q, q, J, J @ dq, None) is dq
    assert bounds.held == 0


def test_tasks_out_of_reach_are_met_as_far_as_the_bounds_permit(melson: Robot):
    """Every joint moves at its top speed towards the error."""
    q, J = melson.posture, np.eye(melson.n)
    far = np.full(melson.n, 1.0)
    step = bounds_of(melson, melson.n).limit(far, q, q, J, far, None)
    room = np.minimum(melson.speed_limit * 0.01, melson.upper - q)
    assert_allclose(step, room, rtol=1e-6)


# --- walks ------------------------------------------------------------------------------------


def test_a_walk_within_its_limits_is_the_one_without_hard_limits(melson: Robot):
    free, held = (run_stages(melson, gait(mode)) for mode in ("record", "hold"))
    assert_array_equal(free.joints.angles, held.joints.angles)
    assert held_steps(held) == 0


@pytest.mark.parametrize("torso", ["free", "upright"])
@pytest.mark.parametrize("joint", ["left_hip_roll", "right_knee_pitch", "left_ankle_roll"])
def test_a_joint_is_held_at_its_range(melson: Robot, joint: str, torso: str):
    free = run_stages(melson, gait("record", torso))
    j = melson.joint_names.index(joint)
    lowest, highest = free.joints.angles[:, j].min(), free.joints.angles[:, j].max()
    upper = melson.upper.copy()
    upper[j] = highest - 0.1 * (highest - lowest)
    robot = narrowed(melson, upper=upper)
    with pytest.raises(JointLimitError):
        run_stages(robot, gait("refuse", torso))
    stages = run_stages(robot, gait("hold", torso))
    assert stages.joints.angles[:, j].max() <= upper[j] + 1e-9
    assert held_steps(stages) > 0
    assert_tasks_met(stages)


def test_a_joint_is_held_at_its_speed(melson: Robot):
    """The legs of the robot have one joint more than the soles need: the pelvis gives way."""
    free = run_stages(melson, gait("record"))
    j = melson.joint_names.index("left_ankle_pitch")
    speed = melson.speed_limit.copy()
    speed[j] = 0.8 * np.abs(steps(free)[:, j]).max()
    stages = run_stages(narrowed(melson, speed_limit=speed), gait("hold"))
    assert np.abs(steps(stages)).max(axis=0)[j] <= speed[j]
    assert np.abs(steps(stages)[:, j]).max() > 0.99 * speed[j]
    assert_tasks_met(stages)


def test_a_walk_starts_within_the_ranges(melson: Robot):
    """With the CoM below that of the half-sitting posture, an ankle bends beyond its range."""
    low = {"com_height": 0.19}
    free = run_stages(melson, gait("record", **low)).joints.angles[0]
    j = melson.joint_names.index("left_ankle_pitch")
    lower = melson.lower.copy()
    lower[j] = 0.7 * free[j] + 0.3 * melson.posture[j]
    assert free[j] < lower[j] < melson.posture[j]
    stages = run_stages(narrowed(melson, lower=lower), gait("hold", **low))
    assert stages.joints.angles[0, j] >= lower[j]
    assert_tasks_met(stages)


def test_limits_that_tasks_cannot_keep_refuse_the_gait_and_name_the_joint(melson: Robot):
    """A knee that hardly bends: the swing sole cannot rise."""
    knees = [melson.joint_names.index(f"{side.label}_knee_pitch") for side in Side]
    upper = melson.upper.copy()
    upper[knees] = melson.posture[knees] + 0.02
    with pytest.raises(JointLimitError, match="knee_pitch"):
        run_stages(narrowed(melson, upper=upper), gait("hold", step_height=0.05))


def missed_tasks(robot: Robot, walk: WalkGait) -> tuple[int, Array, TaskTrajectory, ComTrajectory]:
    """First sample at which a refused walk misses a task, its joint angles, and its tasks."""
    tasks = plan_trajectories(plan_motion(robot, walk))
    com = first_com(robot, walk, tasks)
    seen: list[int] = []

    def record(rows: Sequence[TaskRows], errors: Array, _: float, start: int) -> None:
        ratios = np.max([row.sizes(errors) / row.tolerance for row in rows], axis=0)
        seen.extend(start + np.flatnonzero(ratios > 1.0))

    with pytest.MonkeyPatch.context() as patch:  # the same motion, with the misses left in it
        patch.setattr("mgs.ik_solver.clik.refuse_misses", record)
        angles = solve_ik(robot, tasks, com, walk.ik).angles
    return min(seen), angles, tasks, com


def nearest_miss(robot: Robot, walk: WalkGait) -> float:
    """Least error that SLSQP finds there, with joints that the sample before can reach."""
    k, angles, tasks, com = missed_tasks(robot, walk)
    side, last = Side(int(tasks.root[k])), angles[max(k - 1, 0)]
    tree = TreeTasks(robot, side, tasks.hands_asked)
    tree.place(pin.XYZQUATToSE3(tasks.soles[k, side]))
    (x,), (R,) = tree_targets(tasks, com.position, k, k + 1)
    stride = robot.speed_limit * walk.dt
    low = np.maximum(robot.lower, last - stride)[tree.order]
    high = np.minimum(robot.upper, last + stride)[tree.order]
    error = np.empty(tree.n_rows)

    def miss(q: np.ndarray) -> np.ndarray:
        tree.update(q)
        tree.error(x, R, error)
        return error.copy()

    def slope(q: np.ndarray) -> np.ndarray:
        tree.update(q)
        return -tree.J.copy()

    start = np.clip(last[tree.order], low, high)
    found = minimize(
        lambda q: 0.5 * np.sum((q - start) ** 2),
        start,
        jac=lambda q: q - start,
        bounds=list(zip(low, high, strict=True)),
        constraints={"type": "eq", "fun": miss, "jac": slope},
        method="SLSQP",
    )
    return float(np.abs(miss(found.x)).max())


@settings(max_examples=8, deadline=None)
@given(data=st.data())
def test_limits_hold_and_tasks_are_met_where_a_solution_exists(melson: Robot, data: st.DataObject):
    """Random walks with up to three narrowed ranges or speeds.

    Either all limits hold to 1e-9 and all tasks are met, or the gait is refused at a sample where
    SLSQP, too, finds no joint angles within the limits that can be reached from the sample before.
    """
    walk = {
        "step_length": data.draw(st.floats(0.0, 0.07)),
        "step_height": data.draw(st.floats(0.01, 0.04)),
        "single_support": data.draw(st.floats(0.4, 1.0)),
    }
    torso = data.draw(st.sampled_from(["free", "upright"]))
    free = run_stages(melson, gait("record", torso, **walk))
    angles, fastest = free.joints.angles, np.abs(steps(free)).max(axis=0)
    lower, upper, speed = melson.lower.copy(), melson.upper.copy(), melson.speed_limit.copy()
    for j in data.draw(st.lists(st.integers(0, melson.n - 1), min_size=1, max_size=3, unique=True)):
        share, width = data.draw(st.floats(0.0, 0.3)), np.ptp(angles[:, j])
        match data.draw(st.sampled_from(["lower", "upper", "speed"])):
            case "lower":
                lower[j] = min(angles[:, j].min() + share * width, melson.posture[j] - 1e-3)
            case "upper":
                upper[j] = max(angles[:, j].max() - share * width, melson.posture[j] + 1e-3)
            case _:
                speed[j] = max(0.05, (1.0 - share) * fastest[j])
    assume(np.all((lower < melson.posture) & (melson.posture < upper)))
    robot = narrowed(melson, lower=lower, upper=upper, speed_limit=speed)
    try:
        stages = run_stages(robot, gait("hold", torso, **walk))
    except (IkError, JointLimitError, JointSpeedError):
        least = 1e-4 / np.sqrt(3.0)  # [m], largest entry of an error as long as the tolerance
        assert nearest_miss(robot, gait("hold", torso, **walk)) > 0.9 * least
        return
    q = stages.joints.angles
    assert np.all(q >= lower - 1e-9) and np.all(q <= upper + 1e-9)
    assert np.all(np.abs(steps(stages)) <= speed + 1e-9)
    assert_tasks_met(stages)
