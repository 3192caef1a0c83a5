"""Motions whose sizes are relative to the robot, and the generic gaits on robots of two sizes."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from mgs.core.errors import ConfigError
from mgs.gait import list_gaits, load_gait, parse_gait
from mgs.judge.motion_checks import check_motion
from mgs.motion_planner import for_robot
from mgs.pipeline import run_stages
from mgs.robot import Robot, leg_length, load_robot
from mgs.robot.init import init_robot
from mgs.robot.roles import find_roles
from tests.support.bipeds import Biped

GENERIC = [name for name in list_gaits() if name.startswith("generic/")]


@pytest.fixture(scope="module")
def biped(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """A biped of boxes with arms of four joints, 1.6 times as tall as Melson."""
    path = tmp_path_factory.mktemp("biped") / "boxes.urdf"
    path.write_text(Biped(size=0.5).urdf())
    return init_robot(path).robot


@pytest.fixture(scope="module", params=["melson", "boxes"])
def robot(request: pytest.FixtureRequest, biped: Robot) -> Robot:
    return load_robot("melson") if request.param == "melson" else biped


@pytest.mark.parametrize("name", GENERIC)
def test_generic_gaits_pass_their_static_checks(name: str, robot: Robot):
    gait = load_gait(name)
    assert gait.robot is None
    motion = run_stages(robot, gait, name).motion
    assert [str(check) for check in check_motion(motion) if not check.ok] == []


def test_there_is_a_gait_for_each_kind_of_motion():
    kinds = {name: load_gait(name).motion for name in GENERIC}
    assert set(kinds.values()) == {"walk", "kick", "keyframes", "balance", "pick_up"}
    assert len(kinds) >= 11


def test_hands_are_measured_from_the_shoulder_in_arm_lengths(robot: Robot):
    point = np.array([0.6, -0.35, -0.35])
    text = f"""
mgs: 1
motion: keyframes
keyframes:
  sizes: relative
  keys: [{{time: 3.0, hold: 0.5, right_hand: {point.tolist()}}}]
"""
    motion = run_stages(robot, parse_gait(text, "a.yaml")).motion
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, motion.q[round(3.2 / motion.dt)])
    hand = data.oMf[robot.hand_frames[1]].translation.copy()
    pin.framesForwardKinematics(model, data, robot.standing_q)
    first, *outer = [
        j
        for j in model.supports[model.frames[robot.hand_frames[1]].parentJoint]
        if j not in model.supports[model.frames[robot.torso_frame].parentJoint]
    ]
    del first
    shoulder = data.oMi[outer[0]].translation
    stretched = sum(float(np.linalg.norm(model.jointPlacements[j].translation)) for j in outer[1:])
    stretched += float(np.linalg.norm(model.frames[robot.hand_frames[1]].placement.translation))
    assert hand == pytest.approx(shoulder + stretched * point, abs=2e-4)


def test_angles_of_roles_are_measured_from_the_posture_and_kept_in_range(robot: Robot):
    text = """
mgs: 1
motion: keyframes
keyframes:
  sizes: relative
  keys: [{time: 3.0, posture: {left_elbow: -0.2, right_elbow: -6.0}}]
"""
    gait = for_robot(parse_gait(text, "a.yaml"), robot)
    (key,) = gait.keyframes.keys
    roles = find_roles(robot)
    left, right = roles["left_elbow"], roles["right_elbow"]
    assert key.posture[robot.joint_names[left.joint]] == pytest.approx(
        robot.posture[left.joint] - 0.2 * left.sign
    )
    end = robot.lower if right.sign > 0 else robot.upper
    assert abs(key.posture[robot.joint_names[right.joint]] - end[right.joint]) == pytest.approx(
        0.05
    )
    assert for_robot(gait, robot) is gait  # resolved


def test_lengths_are_multiples_of_the_leg_length(robot: Robot):
    leg = leg_length(robot)
    walk = for_robot(load_gait("generic/sideways"), robot).walk
    assert walk.lateral == pytest.approx(0.06 * leg, abs=1e-4)
    sway = for_robot(load_gait("generic/sway"), robot).balance
    assert sway.channels[0].amplitude == pytest.approx(0.08 * leg)
    pick_up = for_robot(load_gait("generic/pick_up", ("pick_up.payload=0.01",)), robot).pick_up
    assert pick_up.object == pytest.approx([0.40 * leg, -0.2 * leg, 0.6 * leg])
    assert pick_up.payload == pytest.approx(0.01 * robot.mass)
    assignments = ("kick.height=0.1", "kick.ball.radius=0.2", "kick.ball.mass=0.3", "kick.lift=0.7")
    kick = for_robot(load_gait("generic/kick", assignments), robot).kick
    assert kick.height == pytest.approx(0.1 * leg)
    assert kick.ball.radius == pytest.approx(0.2 * leg)
    assert kick.ball.mass == 0.3 and kick.lift == 0.7


def test_a_robot_without_arms_needs_no_angles_of_arms():
    ready = for_robot(load_gait("generic/get_ready"), load_robot("coman_legs"))
    assert ready.keyframes.keys[0].posture == {}


def test_a_missing_role_or_hand_is_told():
    legs = load_robot("coman_legs")
    keys = "{sizes: relative, keys: [{time: 2.0, posture: {waist_yaw: 0.1}}]}"
    turned = f"mgs: 1\nmotion: keyframes\nkeyframes: {keys}\n"
    with pytest.raises(ConfigError, match=r"posture\.waist_yaw: coman_legs has no joint of this"):
        for_robot(parse_gait(turned, "turned.yaml"), legs)
    with pytest.raises(ConfigError, match=r"keys\.0\.right_hand: coman_legs cannot move this hand"):
        for_robot(load_gait("generic/wave"), legs)
    with pytest.raises(ConfigError, match="relative is for motions with balance: on"):
        for_robot(load_gait("melson/get_up", ("keyframes.sizes=relative",)), legs)
