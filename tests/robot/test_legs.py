"""Tests of legs with five joints: the missing rotation, and motions that need it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.core.plugins import IK_SOLVERS
from mgs.gait import load_gait
from mgs.motion_planner import plan_motion
from mgs.pipeline import run_stages
from mgs.robot import Robot, leg_joints, load_robot
from mgs.robot.init import init_robot
from mgs.robot.legs import missing_turn
from mgs.robot.soundness import check_robot
from tests.support.bipeds import FULL_LEG, Biped


def robot_with(leg: tuple[str, ...], folder: Path) -> Robot:
    path = folder / "boxes.urdf"
    path.write_text(Biped(leg=leg, waist=("waist_roll", "waist_pitch")).urdf())
    return init_robot(path).robot


@pytest.mark.parametrize("name", ["melson", "coman", "coman_legs"])
def test_the_shipped_legs_have_no_missing_rotation(name: str):
    assert missing_turn(load_robot(name)) is None


@pytest.mark.parametrize(
    ("leg", "turn"),
    [
        (FULL_LEG, None),
        (FULL_LEG[1:], "yaw"),
        (FULL_LEG[:-1], "roll"),
        ((FULL_LEG[1], FULL_LEG[0], *FULL_LEG[2:5]), "roll"),
    ],
)
def test_the_missing_rotation_is_identified(leg: tuple[str, ...], turn: str | None, tmp_path: Path):
    robot = robot_with(leg, tmp_path)
    assert missing_turn(robot) == turn
    assert [str(robot.model.names[j]) for j in leg_joints(robot, Side.RIGHT)] == [
        f"right_{name}" for name in leg
    ]
    figure = next(f.figure for f in check_robot(robot) if f.name == "legs")
    words = {"yaw": "no hip yaw", "roll": "no ankle roll"}
    assert [word for word in words.values() if word in figure] == ([words[turn]] if turn else [])


def test_a_leg_without_pitch_at_the_hip_is_unsound(tmp_path: Path):
    robot = robot_with(tuple(name for name in FULL_LEG if name != "hip_pitch"), tmp_path)
    finding = next(f for f in check_robot(robot) if f.name == "legs")
    assert not finding.ok
    with pytest.raises(ConfigError, match="cannot keep a sole level"):
        missing_turn(robot)


@pytest.mark.parametrize(
    ("leg", "assignment"),
    [
        (FULL_LEG[1:], "walk.step_yaw=0.1"),
        (FULL_LEG[:-1], "walk.step_yaw=0.1"),
        (FULL_LEG[:-1], "walk.lateral=0.02"),
        (FULL_LEG[:-1], "walk.step_width=0.2"),
    ],
)
def test_steps_that_need_the_missing_rotation_are_refused(
    leg: tuple[str, ...], assignment: str, tmp_path: Path
):
    robot = robot_with(leg, tmp_path)
    with pytest.raises(ConfigError, match=r"which the legs of boxes lack"):
        plan_motion(robot, load_gait("walk", (assignment,)))


@pytest.mark.parametrize("solver", [name for name in IK_SOLVERS.own if name != "clik"])
def test_only_clik_accepts_legs_with_five_joints(solver: str, tmp_path: Path):
    robot = robot_with(FULL_LEG[1:], tmp_path)
    with pytest.raises(ConfigError, match="use clik"):
        run_stages(robot, load_gait("walk", (f"ik.solver={solver}", "walk.n_steps=1")))


@pytest.mark.parametrize(("leg", "axes"), [(FULL_LEG[1:], (1,)), (FULL_LEG[:-1], (0, 2))])
def test_the_pelvis_is_constrained_instead_of_the_missing_rotation(
    leg: tuple[str, ...], axes: tuple[int, ...], tmp_path: Path
):
    """Soles follow all six coordinates of their references although legs have five joints."""
    robot = robot_with(leg, tmp_path)
    motion = run_stages(robot, load_gait("walk", ("walk.n_steps=2",))).motion
    apart = np.linalg.norm(motion.soles[..., :3] - motion.soles_ref[..., :3], axis=-1)
    assert apart.max() < 1e-4
    turns = [
        pin.log3(pin.XYZQUATToSE3(a).rotation.T @ pin.XYZQUATToSE3(b).rotation)
        for a, b in zip(motion.soles[:, 1], motion.soles_ref[:, 1], strict=True)
    ]
    assert np.abs(turns).max() < 1e-4
    base = np.array([pin.log3(pin.XYZQUATToSE3(q[:7]).rotation) for q in motion.q])
    assert np.abs(base[:, list(axes)]).max() < 1e-3
