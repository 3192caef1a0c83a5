"""Tests of the arms of drafted robots: hands and thighs that get near each other in a step."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from mgs.gait import load_gait
from mgs.judge.motion_checks import check_motion
from mgs.pipeline import run_stages
from mgs.robot import Robot
from mgs.robot.init import DraftFolder, init_robot
from tests.support.bipeds import Biped


def gloves(width: float, mass: float = 0.1, height: float = 0.1, below: float = 0.2) -> list[str]:
    """Boxes on the forearms, below the elbows, that reach down to the thighs [m]."""
    return [
        f'<joint name="{side}_glove" type="fixed"><parent link="{side}_elbow_pitch_link"/>'
        f'<child link="{side}_glove_link"/><origin xyz="0 0 {-below}"/></joint>'
        f'<link name="{side}_glove_link"><inertial><mass value="{mass}"/>'
        f'<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial>'
        f'<collision><geometry><box size="{width} {width} {height}"/></geometry></collision></link>'
        for side in ("left", "right")
    ]


def drafted(folder: Path, biped: Biped) -> DraftFolder:
    (folder / "boxes.urdf").write_text(biped.urdf())
    return init_robot(folder / "boxes.urdf")


def arm_contacts(robot: Robot, angles: np.ndarray) -> set[str]:
    """Links that touch a forearm in MuJoCo, in the pelvis frame; neighbours never touch there."""
    model = mujoco.MjModel.from_xml_string(robot.urdf)
    data = mujoco.MjData(model)
    for name, angle in zip(robot.joint_names, angles, strict=True):
        data.qpos[model.jnt_qposadr[model.joint(name).id]] = angle
    mujoco.mj_forward(model, data)
    found = set()
    for contact in data.contact:
        names = {model.body(int(model.geom_bodyid[geom])).name for geom in contact.geom}
        if any("elbow" in name for name in names):
            found |= {name for name in names if "elbow" not in name}
    return found


@pytest.mark.parametrize("width", [0.08, 0.26])
def test_hands_keep_clear_of_thighs_in_a_step(width: float, tmp_path: Path):
    draft = drafted(tmp_path, Biped(extra=gloves(width)))
    robot = draft.robot
    hips = [i for i, name in enumerate(robot.joint_names) if "hip" in name or "knee" in name]
    rng = np.random.default_rng(5)  # other legs than those that the draft looked at
    for _ in range(30):
        angles = robot.posture.copy()
        angles[hips] += rng.uniform(-0.12, 0.12, len(hips))
        assert arm_contacts(robot, angles) == set()
    ignored = {frozenset(pair) for pair in robot.spec.ignore_collisions}
    thighs = ("left_hip_pitch_link", "left_knee_pitch_link", "pelvis")
    assert not any(frozenset((one, "left_elbow_pitch_link")) in ignored for one in thighs)
    assert any("held further out" in note for note in draft.notes) == (width > 0.1)


def test_hands_that_are_moved_are_clear_of_the_thighs_in_a_squat(tmp_path: Path):
    robot = drafted(tmp_path, Biped(extra=gloves(0.26, height=0.2, below=0.3))).robot
    hips = [i for i, name in enumerate(robot.joint_names) if "hip_pitch" in name]
    forward = np.sign(robot.posture[hips])  # the posture bends them
    for angle in np.linspace(0.03, 0.63, 7):
        angles = robot.posture.copy()
        angles[hips] += angle * forward
        assert arm_contacts(robot, angles) == set()


def test_the_default_walk_of_a_robot_with_wide_hands_touches_nothing(tmp_path: Path):
    robot = drafted(tmp_path, Biped(extra=gloves(0.26))).robot
    motion = run_stages(robot, load_gait("generic/walk"), "generic/walk").motion
    assert [check.name for check in check_motion(motion) if not check.ok] == []


def test_hands_too_heavy_to_be_held_out_stay_and_are_named(tmp_path: Path):
    biped = Biped(extra=gloves(0.26, mass=12.0), effort=60.0)
    draft = drafted(tmp_path, biped)
    told = [note for note in draft.notes if "may touch in a step" in note]
    assert len(told) == 1
    assert "left_elbow_pitch_link" in told[0]
    ignored = {frozenset(pair) for pair in draft.robot.spec.ignore_collisions}
    assert any(
        "left_elbow_pitch_link" in pair and "left_hip_pitch_link" in pair for pair in ignored
    )
