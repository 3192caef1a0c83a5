"""Static postures that reach an object, against forward kinematics and the balance of forces."""

from __future__ import annotations

import re

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.core.contact import Side
from mgs.core.errors import ConfigError, InfeasibleGaitError
from mgs.motion_planner import plan_motion
from mgs.motion_planner.standing_model import StandingModel
from mgs.motion_planner.static_pose import find_pose
from mgs.robot import Robot, load_robot
from tests.support.strategies import numbers, pick_up_gait

MELSON = load_robot("melson")
ASKED = [0.133, -0.09, 0.03]  # 80 mm in front of the soles, 30 mm above the ground


def goals(position: list[float], side: Side = Side.RIGHT) -> np.ndarray:
    out = np.full((2, 3), np.nan)
    out[side] = position
    return out


def check_pose(robot: Robot, joints: np.ndarray, goal: np.ndarray, payload: float = 0.0) -> None:
    """Check soles, right hand, common CoM, joint limits and collisions of a posture."""
    model = robot.model
    data, rest = model.createData(), model.createData()
    pin.framesForwardKinematics(model, rest, robot.standing_q)
    sole = rest.oMf[robot.sole_frames[0]]
    q = np.concatenate([pin.neutral(model)[:7], joints])
    pin.framesForwardKinematics(model, data, q)
    q[:7] = pin.SE3ToXYZQUAT(sole * data.oMf[robot.sole_frames[0]].inverse())
    pin.framesForwardKinematics(model, data, q)
    for frame in robot.sole_frames:
        assert_allclose(data.oMf[frame].homogeneous, rest.oMf[frame].homogeneous, atol=2e-5)
    hand = data.oMf[robot.hand_frames[Side.RIGHT]].translation
    assert_allclose(hand, goal, atol=2e-5)
    com = pin.centerOfMass(model, data, q, False)
    both = (robot.mass * com + payload * hand) / (robot.mass + payload)
    spec, (x, y, _) = robot.sole_spec(Side.LEFT), rest.oMf[robot.sole_frames[0]].translation
    assert abs(both[0] - x) < 0.5 * spec.length - 0.015
    assert abs(both[1]) < y + 0.5 * spec.width - 0.015
    assert (joints >= robot.lower).all() and (joints <= robot.upper).all()
    geometry = robot.geometry
    assert not pin.computeCollisions(model, data, geometry, geometry.createData(), q, True)


@pytest.mark.parametrize("payload", [0.0, 0.15])
def test_melson_reaches_30_mm_above_the_ground_80_mm_before_its_soles(payload: float):
    start = np.array([0.0, payload])
    pose = find_pose(MELSON, goals(ASKED), start, MELSON.posture)
    check_pose(MELSON, pose.joints, np.array(ASKED), payload)
    assert MELSON.sole_spec(Side.RIGHT).length / 2 + 0.08 == pytest.approx(ASKED[0])


@settings(max_examples=12)
@given(st.tuples(numbers(-0.05, 0.3), numbers(-0.3, 0.1), numbers(0.02, 0.5)))
def test_any_object_is_reached_in_balance_or_refused_with_a_distance(position):
    try:
        pose = find_pose(MELSON, goals(list(position)), np.zeros(2), MELSON.posture)
    except InfeasibleGaitError as error:
        assert re.search(r"cannot reach|touch", str(error))
    else:
        check_pose(MELSON, pose.joints, np.array(position))


def test_a_refusal_names_the_nearest_point_and_that_point_is_in_reach():
    with pytest.raises(InfeasibleGaitError, match="the right hand cannot reach") as caught:
        plan_motion(MELSON, pick_up_gait(object=[0.45, -0.1, 0.1]))
    numbers = [float(x) for x in re.findall(r"-?\d+\.\d+", str(caught.value))]
    asked, nearest = np.array(numbers[:3]), np.array(numbers[3:6])
    away = float(re.search(r"(\d+) mm away", str(caught.value))[1])
    assert np.linalg.norm(asked - nearest) == pytest.approx(1e-3 * away, abs=2e-3)
    inward = nearest - 0.01 * (asked - nearest) / np.linalg.norm(asked - nearest)
    pose = find_pose(MELSON, goals(list(inward)), np.zeros(2), MELSON.posture)
    check_pose(MELSON, pose.joints, inward)


def test_bodies_that_would_touch_are_kept_apart():
    """Without a least distance of bodies the forearm would be inside the thigh here."""
    position = [0.133, -0.05, 0.03]
    model = StandingModel(MELSON, np.zeros(2))
    try:
        pose = find_pose(MELSON, goals(position), np.zeros(2), MELSON.posture)
    except InfeasibleGaitError as error:
        pytest.fail(str(error))
    assert model.collisions(pose.joints) == []
    check_pose(MELSON, pose.joints, np.array(position))


@pytest.mark.parametrize("name", ["melson", "coman"])
def test_forces_of_a_still_robot_with_a_payload_are_in_balance(name: str):
    """Oracle: inverse dynamics of a robot with a heavier hand and the ground as external forces."""
    robot, rng = load_robot(name), np.random.default_rng(1)
    payload = np.array([0.0, 0.05 * robot.mass])
    joints = robot.posture + rng.uniform(-0.1, 0.1, robot.n)
    model = StandingModel(robot, payload)
    standing, q = model.stand(joints), model.q.copy()
    heavy = robot.model.copy()
    hand = heavy.frames[robot.hand_frames[Side.RIGHT]]
    point = pin.Inertia(payload[1], np.zeros(3), np.zeros((3, 3)))
    heavy.appendBodyToJoint(hand.parentJoint, point, hand.placement)
    data = heavy.createData()
    pin.framesForwardKinematics(heavy, data, q)
    com = pin.centerOfMass(heavy, data, q).copy()
    assert_allclose(standing.loaded_com, com, atol=1e-12)
    # vertical forces on both soles whose sum acts below the CoM, shared as it stands between them
    outer = pin.StdVec_Force([pin.Force.Zero() for _ in range(heavy.njoints)])
    left, right = (sole.translation[:2] for sole in model.soles)
    share = (com[:2] - right) @ (left - right) / ((left - right) @ (left - right))
    shift = com[:2] - (share * left + (1.0 - share) * right)
    for side, (at, part) in enumerate(((left, share), (right, 1.0 - share))):
        up = np.array([0.0, 0.0, part * 9.81 * (robot.mass + payload[1])])
        moment = np.cross([*(at + shift), 0.0], up)
        joint = heavy.frames[robot.sole_frames[side]].parentJoint
        outer[joint] = data.oMi[joint].actInv(pin.Force(up, moment))
    zero = np.zeros(heavy.nv)
    forces = pin.rnea(heavy, data, q, zero, zero, outer)
    assert_allclose(forces[:6], 0.0, atol=1e-9 * robot.mass)
    assert_allclose(standing.torque, forces[6:], atol=1e-9 * robot.mass)


def test_the_plan_for_the_left_hand_is_the_mirror_image_of_that_for_the_right_hand():
    right = plan_motion(MELSON, pick_up_gait(object=[0.12, -0.1, 0.1]))
    left = plan_motion(MELSON, pick_up_gait(hand="left", object=[0.12, 0.1, 0.1]))
    names = MELSON.joint_names
    other = {"left": "right", "right": "left", "waist": "waist"}
    for j, name in enumerate(names):
        side, rest = name.split("_", 1)
        sign = 1.0 if name.endswith("pitch") else -1.0
        twin = names.index(f"{other[side]}_{rest}")
        # two searches, on a cost that is flat to about their stopping tolerance
        assert_allclose(left.posture[:, twin], sign * right.posture[:, j], atol=0.02)
    assert_allclose(left.com, right.com * [1.0, -1.0, 1.0], atol=1e-3)
    assert_allclose(left.hands[:, Side.LEFT], right.hands[:, Side.RIGHT] * [1, -1, 1], atol=1e-12)
    assert np.isnan(left.hands[:, Side.RIGHT]).all()


def test_both_hands_meet_the_object_from_either_side():
    hands = plan_motion(MELSON, pick_up_gait(hand="both", object=[0.1, 0.0, 0.15], width=0.2)).hands
    assert_allclose(hands[2], [[0.1, 0.1, 0.15], [0.1, -0.1, 0.15]], atol=1e-12)
    assert_allclose(hands[1, :, 2] - hands[2, :, 2], 0.15 * 0.2815, atol=1e-4)


def test_picking_up_with_a_robot_that_cannot_move_its_hands_is_refused():
    with pytest.raises(ConfigError, match=r"pick_up\.hand: right: coman_legs cannot move"):
        plan_motion(load_robot("coman_legs"), pick_up_gait(object=[0.3, -0.1, 0.3]))
