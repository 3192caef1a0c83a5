"""Trajectories from key to key: minimum jerk in closed form, places and times of the keys."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from numpy.testing import assert_allclose

from mgs.core.contact import Side, Support
from mgs.gait import KeyframesGait
from mgs.motion_planner import plan_motion
from mgs.robot import leg_length, load_robot, midpoint_width
from mgs.trajectory_planner import (
    TaskTrajectory,
    plan_posture_trajectory,
    plan_trajectories,
)
from tests.support.strategies import keyframes, keyframes_gait, pick_up_gait

MELSON = load_robot("melson")


def tasks_of(gait: KeyframesGait) -> TaskTrajectory:
    return plan_trajectories(plan_motion(MELSON, gait))


def rotation(quat_xyzw: np.ndarray) -> np.ndarray:
    return pin.Quaternion(*quat_xyzw[[3, 0, 1, 2]]).matrix()


@given(keyframes())
def test_feet_never_move_and_the_body_rests_in_every_key_at_its_time(gait):
    tasks, frames, dt = tasks_of(gait), gait.keyframes, gait.dt
    assert (tasks.support == Support.DOUBLE).all()
    half = 0.5 * midpoint_width(MELSON)
    for side in Side:
        here = [0.0, side.sign * half, 0.0, 0.0, 0.0, 0.0, 1.0]
        assert_allclose(tasks.soles[:, side], np.tile(here, (tasks.n_samples, 1)), atol=1e-15)
    assert (tasks.n_samples - 1) * dt == pytest.approx(frames.duration, abs=0.5 * dt + 1e-9)
    now = {"com": [0.0] * 3, "crouch": 0.0, "torso": [0.0] * 3, "right_hand": [0.0] * 3}
    at_rest, posture = dict(now), dict(zip(MELSON.joint_names, MELSON.posture, strict=True))
    joints = dict(posture)
    com, torso = tasks.com[0], rotation(tasks.torso[0])
    right = tasks.hands[0, Side.RIGHT] + com
    for key in frames.keys:
        if key.rest:
            now, joints = dict(at_rest), dict(posture)
        for name in now:
            if getattr(key, name) is not None:
                now[name] = getattr(key, name)
        joints |= key.posture
        lower = [0.0, 0.0, 0.01 * now["crouch"] * leg_length(MELSON)]
        for t in (key.time, key.time + key.hold):
            k = round(t / dt)
            assert_allclose(tasks.com[k], com + now["com"] - lower, atol=1e-12)
            roll, pitch, yaw = now["torso"]
            turned = pin.rpy.rpyToMatrix(roll, pitch, yaw) @ torso
            assert_allclose(rotation(tasks.torso[k]), turned, atol=1e-12)
            assert_allclose(
                tasks.posture.angles[k], [joints[n] for n in MELSON.joint_names], atol=1e-12
            )
            if tasks.hands_asked[Side.RIGHT]:
                hand = tasks.hands[k, Side.RIGHT] + tasks.com[k]
                assert_allclose(hand, right + now["right_hand"], atol=1e-12)
    assert not tasks.hands_asked[Side.LEFT]
    led = any(key.right_hand is not None for key in frames.keys)
    assert tasks.hands_asked[Side.RIGHT] == led


def test_between_keys_the_body_follows_the_minimum_jerk_polynomial():
    """Displacement d (10 s^3 - 15 s^4 + 6 s^5) at s = t / T.

    T. Flash and N. Hogan, "The coordination of arm movements: an experimentally confirmed
    mathematical model", J. Neuroscience 5(7), 1985.
    """
    key = {"time": 2.5, "hold": 0.5, "com": [0.02, -0.01, 0.0], "torso": [0.0, 0.4, 0.0]}
    key["posture"] = {"left_shoulder_pitch": -0.65}
    tasks = tasks_of(keyframes_gait(key))
    s = np.clip((np.arange(tasks.n_samples) * 0.01 - 0.5) / 2.0, 0.0, 1.0)
    blend = 10 * s**3 - 15 * s**4 + 6 * s**5
    assert_allclose(tasks.com[:, 0] - tasks.com[0, 0], 0.02 * blend, atol=1e-12)
    assert_allclose(tasks.com[:, 1] - tasks.com[0, 1], -0.01 * blend, atol=1e-12)
    pitch = [pin.rpy.matrixToRpy(rotation(quat))[1] for quat in tasks.torso]
    assert_allclose(pitch, 0.4 * blend, atol=1e-12)
    j = MELSON.joint_names.index("left_shoulder_pitch")
    assert_allclose(
        tasks.posture.angles[:, j], 0.35 - blend, atol=1e-12
    )  # half-sitting has it at 0.35
    middle = round(1.5 / 0.01)
    speed = (tasks.com[middle + 1, 0] - tasks.com[middle - 1, 0]) / 0.02
    assert speed == pytest.approx(15.0 / 8.0 * 0.02 / 2.0, rel=1e-3)  # twice the mean, nearly


def test_the_torso_turns_as_pinocchio_interpolates_orientations():
    keys = [{"time": 1.5, "torso": [0.3, 0.0, 0.0]}, {"time": 3.5, "torso": [0.0, 0.2, -0.7]}]
    tasks = tasks_of(keyframes_gait(*keys))
    a, b = (pin.Quaternion(*tasks.torso[k][[3, 0, 1, 2]]) for k in (150, 350))
    for k in (180, 250, 300):
        s = (k - 150) / 200
        between = a.slerp(10 * s**3 - 15 * s**4 + 6 * s**5, b)
        assert_allclose(rotation(tasks.torso[k]), between.matrix(), atol=1e-12)


def test_the_hand_goes_straight_down_and_the_common_com_does_not_jump():
    pick_up = pick_up_gait(object=[0.1, -0.12, 0.12], payload=0.3)
    tasks = plan_trajectories(plan_motion(MELSON, pick_up))
    hand = tasks.hands[:, Side.RIGHT] + tasks.com
    ends = np.round(np.array(pick_up.pick_up.times) / 0.01).astype(int)
    _, above, at, taken, lifted, _ = ends
    down = hand[above : at + 1]
    assert_allclose(down[:, :2], np.tile([0.1, -0.12], (len(down), 1)), atol=1e-12)
    assert (np.diff(down[:, 2]) <= 0.0).all()
    assert_allclose(hand[at : taken + 1], np.tile([0.1, -0.12, 0.12], (51, 1)), atol=1e-12)
    assert_allclose(hand[above], hand[lifted], atol=1e-12)
    assert_allclose(hand[[0, -1]], hand[[0, 0]], atol=1e-12)
    mass = tasks.payload[:, Side.RIGHT]
    assert (mass[: at + 1] == 0.0).all() and (mass[taken:] == 0.3).all()
    both = (MELSON.mass * tasks.com + mass[:, None] * hand) / (MELSON.mass + mass[:, None])
    assert_allclose(tasks.zmp_ref, both[:, :2], atol=1e-12)
    assert np.abs(np.diff(tasks.zmp_ref, 2, axis=0)).max() / 0.01**2 < 1.0  # [m/s^2]


def test_without_balance_joints_go_from_key_to_key_and_the_base_turns_upright():
    """Oracle: the minimum-jerk polynomial, and Pinocchio's interpolation of orientations."""
    key = {"time": 2.5, "hold": 0.5, "posture": {"left_elbow_pitch": -1.0}}
    gait = keyframes_gait(
        key, balance="off", lying="front", begin={"left_elbow_pitch": -2.0, "left_knee_pitch": 0.1}
    )
    plan = plan_motion(MELSON, gait)
    found = plan_posture_trajectory(plan)
    n = len(found.angles)
    assert n == plan.n_samples == round(gait.keyframes.duration / 0.01) + 1
    s = np.clip((np.arange(n) * 0.01 - 0.5) / 2.0, 0.0, 1.0)
    blend = 10 * s**3 - 15 * s**4 + 6 * s**5
    elbow, knee = (MELSON.joint_names.index(f"left_{j}_pitch") for j in ("elbow", "knee"))
    assert_allclose(found.angles[:, elbow], -2.0 + blend, atol=1e-12)
    assert_allclose(found.angles[:, knee], 0.1, atol=1e-12)
    others = np.delete(np.arange(MELSON.n), [elbow, knee])
    expected = np.tile(MELSON.posture[others], (n, 1))
    assert_allclose(found.angles[:, others], expected, atol=1e-12)
    upright = rotation(MELSON.standing_q[3:7])
    lying = pin.rpy.rpyToMatrix(0.0, 0.5 * np.pi, 0.0) @ upright
    part = np.arange(n) / (n - 1)
    rise = 10 * part**3 - 15 * part**4 + 6 * part**5
    a, b = pin.Quaternion(lying), pin.Quaternion(upright)
    for k in (0, n // 3, n // 2, n - 1):
        between = a.slerp(float(rise[k]), b).matrix()
        assert_allclose(rotation(found.base[k]), between, atol=1e-9)
