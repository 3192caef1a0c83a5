"""Roles of joints, against the names that robots' makers chose and against forward kinematics."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yaml

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.errors import ConfigError
from mgs.robot import Robot, load_robot
from mgs.robot.init import init_robot
from mgs.robot.role_names import ROLES
from mgs.robot.roles import find_roles
from tests.support.bipeds import Biped

SYLLABLES = {  # how COMAN's maker names what the roles name
    "hip_roll": "HipLat", "hip_pitch": "HipSag", "hip_yaw": "HipYaw", "knee": "KneeSag",
    "ankle_roll": "AnkLat", "ankle_pitch": "AnkSag", "shoulder_roll": "ShLat",
    "shoulder_pitch": "ShSag", "shoulder_yaw": "ShYaw", "elbow": "Elbj",
}  # fmt: skip


def test_roles_of_melson_are_its_names():
    robot = load_robot("melson")
    found = {role: robot.joint_names[at.joint] for role, at in find_roles(robot).items()}
    assert sorted(found.values()) == sorted(robot.joint_names)
    for role, name in found.items():
        assert name in (role, f"{role}_pitch")


def test_roles_of_coman_are_what_its_names_mean():
    robot = load_robot("coman")
    found = {role: robot.joint_names[at.joint] for role, at in find_roles(robot).items()}
    for side in ("left", "right"):
        for role, syllable in SYLLABLES.items():
            assert found[f"{side}_{role}"] == f"{side[0].upper()}{syllable}"
    assert [found[f"waist_{turn}"] for turn in ("roll", "pitch", "yaw")] == [
        "WaistLat", "WaistSag", "WaistYaw",
    ]  # fmt: skip


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (1, 0, 2, 3), (0, 2, 1, 3)])
def test_roles_do_not_rest_on_names_or_order(order: tuple[int, ...], tmp_path: Path):
    arm = tuple(Biped().arm[i] for i in order)
    urdf = Biped(arm=arm, head=("head_yaw", "head_pitch")).urdf()
    names = ["shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow_pitch", "knee_pitch"]
    coded = {name: f"j{i}_" for i, name in enumerate(names)}
    for name, code in coded.items():
        urdf = urdf.replace(name, code)
    path = tmp_path / "coded.urdf"
    path.write_text(urdf)
    robot = init_robot(path).robot
    found = {role: robot.joint_names[at.joint] for role, at in find_roles(robot).items()}
    for side in ("left", "right"):
        assert found[f"{side}_elbow"] == f"{side}_{coded['elbow_pitch']}"
        assert found[f"{side}_knee"] == f"{side}_{coded['knee_pitch']}"
        for turn in ("pitch", "roll"):
            assert found[f"{side}_shoulder_{turn}"] == f"{side}_{coded[f'shoulder_{turn}']}"
    assert found["head_yaw"] == "head_yaw" and found["head_pitch"] == "head_pitch"


@pytest.mark.parametrize("name", ["melson", "coman"])
def test_a_positive_angle_turns_the_outer_link_about_its_axis_of_the_body(name: str):
    robot = load_robot(name)
    axes = {"roll": [1.0, 0.0, 0.0], "pitch": [0.0, 1.0, 0.0], "yaw": [0.0, 0.0, 1.0]}
    for role, (joint, sign) in find_roles(robot).items():
        before, after = (placed(robot, joint, angle) for angle in (0.0, 0.1 * sign))
        turn = pin.log3(after.rotation @ before.rotation.T)
        axis = axes.get(role.rpartition("_")[2], axes["pitch"])
        assert turn @ axis > 0.5 * np.linalg.norm(turn), role


def test_knees_and_elbows_bend_by_the_sign_of_their_role():
    for name in ("melson", "coman"):
        robot = load_robot(name)
        roles = find_roles(robot)
        for side in (0, 1):
            word = ("left", "right")[side]
            for role, tip, bends in (
                ("knee", robot.sole_frames[side], 1.0),
                ("elbow", robot.hand_frames[side], -1.0),
            ):
                joint, sign = roles[f"{word}_{role}"]
                still, bent = (reach(robot, joint, a, tip) for a in (0.0, 0.1 * sign * bends))
                assert bent < still


def placed(robot: Robot, joint: int, angle: float) -> pin.SE3:
    """Placement of the link that a joint moves, in the half-sitting posture but for one angle."""
    q = robot.standing_q.copy()
    q[FLOATING_BASE_NQ + joint] += angle
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    return data.oMi[joint + 2].copy()


def reach(robot: Robot, joint: int, angle: float, tip: int) -> float:
    """Distance of a frame from the first joint of its limb [m]."""
    q = robot.standing_q.copy()
    q[FLOATING_BASE_NQ + joint] += angle
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    limb = list(robot.model.supports[joint + 2])[2:]
    trunk = robot.model.frames[robot.torso_frame].parentJoint
    first = next(j for j in limb if j not in robot.model.supports[trunk])
    return float(np.linalg.norm(data.oMf[tip].translation - data.oMi[first].translation))


def test_robot_yaml_replaces_roles(tmp_path: Path):
    folder = copied(tmp_path, {"roles": {"left_elbow": "left_shoulder_roll"}})
    robot = load_robot(folder)
    found = {role: robot.joint_names[at.joint] for role, at in find_roles(robot).items()}
    assert found["left_elbow"] == "left_shoulder_roll"
    assert "left_shoulder_roll" not in found
    assert list(found) == [role for role in ROLES if role in found]


@pytest.mark.parametrize(
    ("roles", "words"),
    [
        ({"left_kne": "left_knee_pitch"}, "did you mean 'left_knee'?"),
        ({"tail": "left_knee_pitch"}, "'tail' is no role of a joint; roles: left_hip_roll, "),
        ({"left_knee": "shank"}, "roles: robot.urdf has no joint 'shank'"),
    ],
)
def test_wrong_roles_are_refused(roles: dict[str, str], words: str, tmp_path: Path):
    with pytest.raises(ConfigError) as caught:
        load_robot(copied(tmp_path, {"roles": roles}))
    assert words in str(caught.value)


def copied(folder: Path, changes: dict[str, object]) -> Path:
    """A copy of Melson's folder with other entries in robot.yaml."""
    robot = load_robot("melson")
    spec = yaml.safe_load(robot.yaml) | changes
    (folder / "robot.yaml").write_text(yaml.safe_dump(spec))
    (folder / "robot.urdf").write_text(robot.urdf)
    return folder
