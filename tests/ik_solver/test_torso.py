"""The torso kept upright by the closed-loop IK, below soles, hands and CoM."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.contact import Side
from mgs.core.geometry import quat_multiply, quat_xyzw_from_rpy, rotations_from_quat_xyzw
from mgs.gait import WalkGait, load_gait
from mgs.ik_solver.tree.least_norm import LeastNorm
from mgs.ik_solver.tree.targets import torso_targets
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot, load_robot
from mgs.robot.init import init_robot
from tests.support.bipeds import FULL_LEG, Biped
from tests.support.strategies import walk_gait

WALKS = ["melson/walk_practical", "melson/walk_5cm", "melson/turn_in_place", "coman/walk"]


def walked(name: str, *settings: str) -> Stages:
    gait = load_gait(name, settings)
    return run_stages(load_robot(gait.robot or "melson"), gait, name)


def tilt_deg(stages: Stages) -> np.ndarray:
    """Angle (N,) between the torso's z axis and the vertical [deg]."""
    z = rotations_from_quat_xyzw(stages.motion.torso[:, 3:])[..., 2, 2]
    return np.degrees(np.arccos(np.clip(z, -1.0, 1.0)))


@pytest.mark.parametrize("name", WALKS)
def test_an_upright_torso_stays_within_a_fifth_of_a_degree(name: str):
    stages = walked(name, "ik.torso=upright")
    assert tilt_deg(stages).max() < 0.2
    errors = stages.motion.soles - stages.motion.soles_ref
    assert np.abs(errors[..., :3]).max() < 1e-4  # [m], the tolerance of the soles
    assert np.abs(stages.motion.com - stages.motion.com_ref).max() < 2e-4


def test_a_free_torso_leans():
    """Otherwise the test above would show nothing."""
    assert tilt_deg(walked("melson/walk_5cm", "ik.torso=free")).max() > 20.0


def test_hold_keeps_the_lean_of_the_half_sitting_posture(melson: Robot):
    """Seen on a rest orientation that leans: the reference is turned by roll and pitch."""
    tasks = run_stages(melson, walk_gait(n_steps=2, step_yaw=0.2)).tasks
    lean = quat_xyzw_from_rpy([0.1, 0.2, 0.0])
    tasks = dataclasses.replace(tasks, torso=quat_multiply(tasks.torso, lean))
    held = torso_targets(melson, tasks, "hold")
    upright = torso_targets(melson, tasks, "upright")
    assert held is not None and upright is not None
    assert_allclose(held, rotations_from_quat_xyzw(tasks.torso))
    assert_allclose(upright[:, 2], np.tile([0.0, 0.0, 1.0], (len(upright), 1)), atol=1e-12)
    heading = np.arctan2(held[:, 1, 0], held[:, 0, 0])
    assert_allclose(np.arctan2(upright[:, 1, 0], upright[:, 0, 0]), heading, atol=1e-12)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
@pytest.mark.parametrize("quarters", [0, 1, 2, 3])
def test_upright_does_not_depend_on_how_the_torso_frame_is_named(
    melson: Robot, axis: str, quarters: int
):
    """The same body with its frame turned by quarters of a turn has the same target."""
    tasks = run_stages(melson, walk_gait(n_steps=2, step_yaw=0.2)).tasks
    lean = quat_multiply(tasks.torso, quat_xyzw_from_rpy([0.05, 0.1, 0.0]))
    turn = [0.5 * np.pi * quarters * (name == axis) for name in "xyz"]
    renamed = quat_multiply(lean, quat_xyzw_from_rpy(turn))
    plain = torso_targets(melson, dataclasses.replace(tasks, torso=lean), "upright")
    found = torso_targets(melson, dataclasses.replace(tasks, torso=renamed), "upright")
    assert plain is not None and found is not None
    body = found @ rotations_from_quat_xyzw(np.array(quat_xyzw_from_rpy(turn))[None])[0].T
    # which horizontal axis gives the heading depends on the frame: a product of both leans
    assert_allclose(body, plain, atol=0.05 * 0.1)
    assert_allclose(np.abs(body[:, 2, 2]), 1.0, atol=1e-12)


def test_legs_that_hold_the_pelvis_leave_the_torso_free(melson: Robot, tmp_path: Path):
    path = tmp_path / "boxes.urdf"
    path.write_text(Biped(leg=FULL_LEG[1:]).urdf())
    tasks = run_stages(melson, walk_gait(n_steps=1)).tasks
    assert torso_targets(init_robot(path).robot, tasks, "upright") is None


def random_problem(seed: int, m: int, low: int, n: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(m + 1, n))
    return rows, rng.normal(size=m), rng.normal(size=(low, n)), rng.normal(size=low)


@pytest.mark.parametrize("seed", range(20))
def test_the_lower_task_is_met_in_the_null_space_of_the_upper_one(seed: int):
    """Oracle: projectors and pseudo-inverses by SVD."""
    rows, error, J_low, error_low = random_problem(seed, m=12, low=3, n=19)
    J, v0 = rows[:-1].copy(), rows[-1].copy()
    solver = LeastNorm(rows, damping=0.0)
    step = solver.add_below(solver.step(error), J_low, error_low, damping=0.0)
    N = np.eye(19) - np.linalg.pinv(J) @ J
    upper = v0 + np.linalg.pinv(J) @ (error - J @ v0)
    expected = upper + np.linalg.pinv(J_low @ N) @ (error_low - J_low @ upper)
    assert_allclose(step, expected, atol=1e-9)
    assert_allclose(J @ step, error, atol=1e-9)
    assert_allclose(J_low @ step, error_low, atol=1e-9)


def test_a_lower_task_that_cannot_be_met_changes_no_upper_one():
    """The upper task leaves no null space: the step is the upper task's own."""
    rows, error, J_low, error_low = random_problem(0, m=6, low=3, n=6)
    solver = LeastNorm(rows, damping=0.0)
    upper = solver.step(error).copy()
    below = solver.add_below(upper, J_low, 1e3 * error_low, damping=0.02)
    assert_allclose(below, upper, atol=1e-6)


def test_the_error_of_the_torso_is_the_slope_along_its_jacobian(melson: Robot):
    """Oracle: central differences of the torso's rotation."""
    tree = TreeTasks(melson, Side.LEFT)
    q, h = melson.posture[tree.order] + 0.05, 1e-6
    tree.update(q)
    J = tree.torso_error(np.eye(3))[0].copy()
    for j in range(melson.n):
        turned = []
        for sign in (1.0, -1.0):
            moved = q.copy()
            moved[j] += sign * h
            tree.update(moved)
            turned.append(tree.data.oMf[tree.tree.torso].rotation.copy())
        slope = pin.log3(turned[0] @ turned[1].T) / (2.0 * h)
        assert_allclose(J[:, j], slope, atol=1e-7)


def test_walks_may_name_the_mode():
    gait = load_gait("melson/walk_5cm", ("ik.torso=hold",))
    assert isinstance(gait, WalkGait)
    assert gait.ik.torso == "hold"
