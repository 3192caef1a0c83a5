"""Joints that follow given angles in addition to the tasks of soles, torso, hands and CoM."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side
from mgs.pipeline import run_stages
from mgs.robot import load_robot
from tests.support.strategies import keyframes_gait, pick_up_gait

MELSON = load_robot("melson")
KEYS = (
    {"time": 1.3, "crouch": 5.0, "torso": [0.0, 0.2, 0.1], "posture": {"waist_yaw": 0.3}},
    {"time": 2.2, "posture": {"left_shoulder_pitch": -0.4, "left_elbow_pitch": -1.8}},
    {"time": 3.0, "rest": True},
)


@pytest.mark.parametrize("solver", ["ik1", "ik2", "ik3", "ik4", "ik5"])
def test_held_joints_follow_their_keys_while_all_tasks_are_met(solver: str):
    gait = keyframes_gait(*KEYS, rest=0.3, ik={"solver": solver})
    stages = run_stages(MELSON, gait)
    motion, tasks = stages.motion, stages.tasks
    joints = motion.q[:, FLOATING_BASE_NQ:]
    # ik1 and ik3 take one linearised step a sample and lag a little
    near = 2e-3 if solver in ("ik1", "ik3") else 2e-4
    held = tasks.posture.held
    assert_allclose(joints[:, held], tasks.posture.angles[:, held], atol=near)
    assert held.sum() == 7  # waist and both arms
    waist = MELSON.joint_names.index("waist_yaw")
    assert joints[130, waist] == pytest.approx(0.3, abs=near)
    assert np.abs(motion.com - motion.com_ref).max() < 2e-4
    turned = pin.rpy.rpyToMatrix(0.0, 0.2, 0.1)
    torso = pin.Quaternion(*motion.torso[150, [6, 3, 4, 5]]).matrix()
    assert_allclose(torso, turned, atol=2e-4)
    assert_allclose(joints[-1], MELSON.posture, atol=1e-3)


def test_a_hand_with_keys_moves_its_arm_only():
    key = {"time": 1.3, "right_hand": [0.03, 0.0, 0.05]}
    stages = run_stages(MELSON, keyframes_gait(key, rest=0.3))
    motion, names = stages.motion, MELSON.joint_names
    moved = motion.hands[-1, Side.RIGHT, :3] - motion.hands[0, Side.RIGHT, :3]
    assert_allclose(moved, [0.03, 0.0, 0.05], atol=1e-6)
    change = np.ptp(motion.q[:, FLOATING_BASE_NQ:], axis=0)
    left = [j for j, name in enumerate(names) if name.startswith("left_") and "el" in name]
    assert change[names.index("right_elbow_pitch")] > 0.1
    assert change[left].max() < 1e-4


def test_a_mirrored_pick_up_moves_the_mirrored_joints():
    right, left = (
        run_stages(MELSON, pick_up_gait(hand=hand, object=[0.1, y, 0.15])).motion.q[:, 7:]
        for hand, y in (("right", -0.1), ("left", 0.1))
    )
    names, other = MELSON.joint_names, {"left": "right", "right": "left", "waist": "waist"}
    for j, name in enumerate(names):
        side, rest = name.split("_", 1)
        sign = 1.0 if name.endswith("pitch") else -1.0
        twin = names.index(f"{other[side]}_{rest}")
        # the postures come from two searches that stop within a tolerance of the same optimum
        assert_allclose(left[:, twin], sign * right[:, j], atol=0.02)
