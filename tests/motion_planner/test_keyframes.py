"""Refusals of keyframes that a robot cannot follow."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.motion_planner import KeyframePlan, plan_motion
from mgs.robot import arm_mask, leg_mask, load_robot
from tests.support.strategies import keyframes_gait

MELSON = load_robot("melson")


@pytest.mark.parametrize("name", ["melson", "coman"])
def test_legs_and_arms_are_the_groups_of_the_robot(name: str):
    robot = load_robot(name)
    groups = robot.spec.groups

    def names(mask: np.ndarray) -> set[str]:
        return {robot.joint_names[j] for j in np.flatnonzero(mask)}

    assert names(leg_mask(robot)) == {*groups["left_leg"], *groups["right_leg"]}
    for side in Side:
        assert names(arm_mask(robot, side)) == set(groups[f"{side.label}_arm"])


@pytest.mark.parametrize(
    ("key", "part"),
    [
        (
            {"posture": {"left_knee_pitch": 0.5}},
            "a joint of the legs, which keep soles",
        ),
        ({"posture": {"left_elbow": -0.5}}, "no such joint; did you mean 'left_elbow_pitch'?"),
        ({"posture": {"left_elbow_pitch": 0.5}}, r"0.5 rad is outside the joint's range \[-2.2689"),
        (
            {"posture": {"left_elbow_pitch": -0.5}, "left_hand": [0.0, 0.0, 0.01]},
            "this arm follows its hand, which some key names",
        ),
    ],
)
def test_a_joint_angle_that_a_key_may_not_ask_for_is_refused(key: dict[str, Any], part: str):
    with pytest.raises(ConfigError, match=r"keyframes: keys\.0\.posture\.left_.*" + part):
        plan_motion(MELSON, keyframes_gait({"time": 1.0, **key}))


def test_all_problems_of_joint_angles_are_reported_at_once():
    keys = [{"time": t, "posture": {"nose": 0.1, "waist_yaw": 2.0}} for t in (1.0, 2.0)]
    with pytest.raises(ConfigError) as caught:
        plan_motion(MELSON, keyframes_gait(*keys))
    assert len(caught.value.problems) == 4


def test_keys_with_too_few_samples_in_between_are_refused():
    with pytest.raises(ConfigError, match=r"keyframes\.keys\.1\.time: .* fewer than 5 samples"):
        plan_motion(MELSON, keyframes_gait({"time": 1.0}, {"time": 1.03}))


def test_a_reference_for_the_hand_of_a_locked_arm_is_refused():
    legs = load_robot("coman_legs")
    with pytest.raises(ConfigError, match="left_hand: coman_legs cannot move it"):
        plan_motion(legs, keyframes_gait({"time": 1.0, "left_hand": [0.0, 0.0, 0.0]}))
    plan = plan_motion(legs, keyframes_gait({"time": 1.0, "crouch": 2.0}))
    assert isinstance(plan, KeyframePlan) and np.isnan(plan.hands).all()
