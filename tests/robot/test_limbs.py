"""Chains of joints and lengths of legs against the kinematic tree and forward kinematics."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.contact import Side
from mgs.robot import Robot, arm_mask, leg_length, leg_mask, load_robot
from mgs.robot.limbs import (
    arm_joints,
    hip_to_ankle_length,
    joint_chain,
    joints_to,
    leg_joints,
    stretched_length,
)
from tests.support.crooked import crooked_robot

SHIPPED = ["melson", "coman", "coman_legs"]


def ancestors(robot: Robot, frame: int) -> list[int]:
    """Joints that move a frame against the base, from the base outward, by way of their parents."""
    joint, found = int(robot.model.frames[frame].parentJoint), []
    while joint > 1:
        found.append(joint)
        joint = int(robot.model.parents[joint])
    return found[::-1]


@pytest.mark.parametrize("name", SHIPPED)
def test_a_chain_holds_the_joints_that_move_its_tip_and_not_its_root(name: str):
    robot = load_robot(name)
    torso = robot.torso_frame
    for tip in (*robot.sole_frames, *robot.hand_frames, torso):
        assert joint_chain(robot, tip) == ancestors(robot, tip)
        assert joints_to(robot.model, robot.model.frames[tip].parentJoint) == ancestors(robot, tip)
        shared = ancestors(robot, torso)
        expected = [joint for joint in ancestors(robot, tip) if joint not in shared]
        assert joint_chain(robot, tip, torso) == expected
    assert joint_chain(robot, torso, torso) == []


@pytest.mark.parametrize("name", ["melson", "coman"])
@pytest.mark.parametrize("side", list(Side))
def test_joints_of_legs_and_arms_are_the_groups_of_the_robot(name: str, side: Side):
    robot = load_robot(name)
    groups = robot.spec.groups
    names = robot.model.names
    assert [names[j] for j in leg_joints(robot, side)] == list(groups[f"{side.label}_leg"])
    assert [names[j] for j in arm_joints(robot, side)] == list(groups[f"{side.label}_arm"])


def test_a_robot_with_locked_arms_has_no_joints_in_them():
    robot = load_robot("coman_legs")
    assert [arm_joints(robot, side) for side in Side] == [[], []]
    assert not arm_mask(robot, Side.LEFT).any()
    assert leg_mask(robot).sum() == 12


@pytest.mark.parametrize(
    "robot", [load_robot("melson"), crooked_robot(seed=3)], ids=["melson", "crooked"]
)
def test_no_posture_makes_a_leg_longer_than_its_stretched_length(robot: Robot):
    """Oracle: distances of hip, ankle and sole by forward kinematics of random postures."""
    model, data = robot.model, robot.model.createData()
    hip, *_, ankle = leg_joints(robot, Side.LEFT)
    rng, sole, shank = np.random.default_rng(0), [], []
    for _ in range(200):
        joints = rng.uniform(robot.lower, robot.upper)
        q = np.concatenate([pin.neutral(model)[:7], joints])
        pin.framesForwardKinematics(model, data, q)
        place = data.oMf[robot.sole_frames[Side.LEFT]].translation
        sole.append(np.linalg.norm(place - data.oMi[hip].translation))
        shank.append(np.linalg.norm(data.oMi[ankle].translation - data.oMi[hip].translation))
    assert max(sole) <= leg_length(robot) + 1e-12
    straight = stretched_length(model, leg_joints(robot, Side.LEFT))
    assert max(shank) <= straight + 1e-12
    assert 0.0 < hip_to_ankle_length(robot) <= straight


def test_a_straight_leg_is_as_long_as_its_links():
    """At zero all links of Melson's legs hang straight down, one below the other."""
    robot = load_robot("melson")
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    hip, *_, ankle = leg_joints(robot, Side.LEFT)
    height = data.oMi[hip].translation[2] - data.oMi[ankle].translation[2]
    assert hip_to_ankle_length(robot) == pytest.approx(height, abs=1e-12)
    sole = data.oMf[robot.sole_frames[Side.LEFT]].translation
    below_ankle = np.linalg.norm(sole - data.oMi[ankle].translation)
    assert_allclose(leg_length(robot), height + below_ankle, atol=1e-12)
