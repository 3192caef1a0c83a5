"""The plan of a balance motion against Pinocchio's forward kinematics of the standing robot."""

from __future__ import annotations

import functools

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from numpy.testing import assert_allclose

from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError
from mgs.gait import BalanceGait
from mgs.motion_planner import BalancePlan, plan_motion
from mgs.motion_planner.standing import standing_figures
from mgs.robot import Robot, load_robot
from mgs.trajectory_planner import plan_trajectories
from tests.support.strategies import balance_gait, balances, constant, figure_eight, sine

MELSON = load_robot("melson")


@functools.cache  # arrays of a Data are views that do not keep it alive
def standing(robot: Robot) -> pin.Data:
    """Frames and CoM of the half-sitting robot; origin on the ground midway between the soles."""
    q = np.concatenate([pin.neutral(robot.model)[:7], robot.posture])
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    left, right = (data.oMf[frame] for frame in robot.sole_frames)
    place = pin.SE3(left.rotation, 0.5 * (left.translation + right.translation)).inverse()
    q[:7] = pin.SE3ToXYZQUAT(place)
    pin.framesForwardKinematics(robot.model, data, q)
    pin.centerOfMass(robot.model, data, q, False)
    return data


def plan_of(gait: BalanceGait) -> BalancePlan:
    plan = plan_motion(MELSON, gait)
    assert type(plan) is BalancePlan
    return plan


@pytest.mark.parametrize("name", ["melson", "coman", "coman_legs"])
def test_the_figures_of_the_standing_robot_are_those_of_its_forward_kinematics(name: str):
    robot = load_robot(name)
    data, figures = standing(robot), standing_figures(robot)
    assert_allclose(figures.com, data.com[0], atol=1e-12)
    torso = pin.Quaternion(figures.torso).matrix()
    assert_allclose(torso, data.oMf[robot.torso_frame].rotation, atol=1e-12)
    hands = [data.oMf[frame].translation for frame in robot.hand_frames]
    if name == "coman_legs":  # its arms are locked
        assert np.isnan(figures.hands).all()
    else:
        assert_allclose(figures.hands, hands, atol=1e-12)


@given(balances())
def test_both_feet_stay_where_they_stand_for_the_whole_motion(gait: BalanceGait):
    plan = plan_of(gait)
    support = plan_trajectories(plan).support
    assert len(support) == plan.n_samples and (support == Support.DOUBLE).all()
    seconds = (plan.n_samples - 1) * plan.dt
    assert seconds == pytest.approx(gait.balance.duration, abs=0.5 * plan.dt + 1e-9)
    data = standing(MELSON)
    assert [f.side for f in plan.footsteps] == list(Side)
    for footstep in plan.footsteps:
        sole = data.oMf[MELSON.sole_frames[footstep.side]].translation
        assert_allclose([footstep.x, footstep.y, footstep.yaw], [*sole[:2], 0.0], atol=1e-12)


@given(balances())
def test_rests_and_fades_last_as_long_as_asked_and_channels_act_in_between(gait: BalanceGait):
    plan = plan_of(gait)
    assert plan.start == plan.n_samples - 1 - plan.end
    assert plan.start * gait.dt == pytest.approx(gait.balance.rest, abs=0.5 * gait.dt + 1e-9)
    assert plan.ease * gait.dt == pytest.approx(gait.balance.ease, abs=0.5 * gait.dt + 1e-9)
    assert 0 <= plan.start < plan.end < plan.n_samples
    assert plan.ease >= 1


def test_only_hands_with_a_channel_have_a_reference():
    right = standing(MELSON).oMf[MELSON.hand_frames[Side.RIGHT]].translation
    for channel in (sine("right_hand_y", 0.01), figure_eight("right_hand", "yz", 0.02, 0.01)):
        hands = plan_of(balance_gait(sine("com_x", 0.01), channel)).hands
        assert np.isnan(hands[Side.LEFT]).all()
        assert_allclose(hands[Side.RIGHT], right, atol=1e-12)
    assert np.isnan(plan_of(balance_gait(sine("com_x", 0.01))).hands).all()


def test_com_z_adds_to_the_given_height_or_to_the_height_of_the_posture():
    height = standing(MELSON).com[0][2]
    for given_height, expected in ((None, height), (0.25, 0.25)):
        plan = plan_of(balance_gait(sine("com_z", 0.01), com_height=given_height))
        assert plan.com_height == pytest.approx(expected, abs=1e-12)
        assert_allclose(plan.com, standing(MELSON).com[0], atol=1e-12)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_hand_that_cannot_move_relative_to_the_torso_is_refused_by_name(side: str):
    legs = load_robot("coman_legs")
    with pytest.raises(ConfigError, match=rf"balance\.channels: {side}_hand: coman_legs cannot"):
        plan_motion(legs, balance_gait(constant(f"{side}_hand_z", 0.01)))
    plan = plan_motion(legs, balance_gait(constant("torso_yaw", 0.01)))
    assert isinstance(plan, BalancePlan) and np.isnan(plan.hands).all()
