"""Motion files for the tests of the commands."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from mgs.com_generator import generate_com
from mgs.core.geometry import quintic
from mgs.gait import load_gait
from mgs.ik_solver import solve_ik
from mgs.motion_file import write_motion
from mgs.motion_planner import plan_motion
from mgs.pipeline import assemble
from mgs.robot import load_robot
from mgs.trajectory_planner import plan_trajectories
from tests.support.commands import SHORT_WALK, run


@pytest.fixture(scope="session")
def walk_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short walk that passes every check."""
    path = tmp_path_factory.mktemp("walk") / "walk.mcap"
    assert run("generate", *SHORT_WALK, "-o", path).exit_code == 0
    return path


@pytest.fixture(scope="session")
def falling_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Steps on the spot with a CoM 70 mm in front of its reference, outside the soles."""
    path = tmp_path_factory.mktemp("fall") / "fall.mcap"
    robot = load_robot("melson")
    assignments = [word for word in SHORT_WALK[1:] if word != "--set"]
    gait = load_gait(SHORT_WALK[0], (*assignments, "walk.step_length=0.0"))
    plan = plan_motion(robot, gait)
    tasks = plan_trajectories(plan)
    com = generate_com(robot, tasks, gait.com)
    lean = 0.07 * quintic(np.clip(np.arange(tasks.n_samples) * gait.dt, 0.0, 1.0))
    com = dataclasses.replace(com, position=com.position + np.outer(lean, [1.0, 0.0, 0.0]))
    joints = solve_ik(robot, tasks, com, gait.ik)
    write_motion(assemble(robot, gait, "fall", plan, tasks, com, joints), path)
    return path
