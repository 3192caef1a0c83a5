"""Joints that stretch a limb, against distances by forward kinematics."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side
from mgs.ik_solver.floating.stretched_joints import stretched_joints
from mgs.robot import Robot, load_robot

KNEES = {
    "melson": ("left_knee_pitch", "right_knee_pitch"),
    "coman": ("LKneeSag", "RKneeSag"),
    "coman_legs": ("LKneeSag", "RKneeSag"),
}


def leg_ends(robot: Robot, side: Side) -> tuple[int, int]:
    """First and last joint of a leg."""
    last = first = robot.model.frames[robot.sole_frames[side]].parentJoint
    while robot.model.parents[first] > 1:
        first = robot.model.parents[first]
    return first, last


def lengths(robot: Robot, joint: int, angles: np.ndarray, pair: tuple[int, int]) -> np.ndarray:
    """Distance of two joints by forward kinematics while one joint turns and all others are 0."""
    model, data = robot.model, robot.model.createData()
    out = np.empty(len(angles))
    for k, angle in enumerate(angles):
        q = pin.neutral(model)
        q[FLOATING_BASE_NQ + joint] = angle
        pin.forwardKinematics(model, data, q)
        out[k] = np.linalg.norm(data.oMi[pair[0]].translation - data.oMi[pair[1]].translation)
    return out


@pytest.mark.parametrize("name", KNEES)
def test_knees_are_found_and_straight_at_0(name: str):
    robot = load_robot(name)
    joints, angles = stretched_joints(robot)
    found = {robot.joint_names[j]: float(angle) for j, angle in zip(joints, angles, strict=True)}
    assert set(KNEES[name]) <= set(found)
    for knee in KNEES[name]:
        assert abs(found[knee]) < 1e-6


@pytest.mark.parametrize("name", KNEES)
def test_the_distance_from_hip_to_ankle_is_largest_at_the_angles_found(name: str):
    robot = load_robot(name)
    found = dict(zip(*(a.tolist() for a in stretched_joints(robot)), strict=True))
    grid = np.linspace(-1.9, 1.9, 761)  # every 5 mrad, 0 among them
    for side in Side:
        knee = robot.joint_names.index(KNEES[name][side])
        distance = lengths(robot, knee, grid, leg_ends(robot, side))
        assert abs(grid[np.argmax(distance)] - found[knee]) <= 0.005
        assert distance.max() - distance.min() > 0.1 * distance.max()


@pytest.mark.parametrize("name", KNEES)
def test_only_knees_and_elbows_are_found(name: str):
    """One knee per leg, at most one elbow per arm; twists and ankles do not stretch a limb."""
    robot = load_robot(name)
    joints = [robot.joint_names[j] for j in stretched_joints(robot)[0]]
    assert len(joints) == len(set(joints))
    elbows = [joint for joint in joints if joint not in KNEES[name]]
    assert all("elb" in joint.lower() for joint in elbows)
    assert len(elbows) == (0 if name == "coman_legs" else 2)


@pytest.mark.parametrize("name", ["melson", "coman"])
@pytest.mark.parametrize("side", list(Side))
def test_elbows_are_straight_where_the_hand_is_farthest_from_the_shoulder(name: str, side: Side):
    robot = load_robot(name)
    model, data = robot.model, robot.model.createData()
    found = dict(zip(*(a.tolist() for a in stretched_joints(robot)), strict=True))
    trunk = ancestors(model, robot.torso_frame)
    arm = [j for j in ancestors(model, robot.hand_frames[side]) if j not in trunk]  # hand first
    (elbow,) = (joint for joint in found if joint + 2 in arm)  # after the universe and the base
    grid = np.linspace(-2.3, 0.4, 541)
    distance = []
    for angle in grid:
        q = pin.neutral(model)
        q[FLOATING_BASE_NQ + elbow] = angle
        pin.framesForwardKinematics(model, data, q)
        hand = data.oMf[robot.hand_frames[side]].translation
        distance.append(np.linalg.norm(hand - data.oMi[arm[-1]].translation))
    assert abs(grid[int(np.argmax(distance))] - found[elbow]) < 0.01


def ancestors(model: pin.Model, frame: int) -> list[int]:
    """Joints that move a frame, the nearest first."""
    joint, out = int(model.frames[frame].parentJoint), []
    while joint > 0:
        out.append(joint)
        joint = int(model.parents[joint])
    return out
