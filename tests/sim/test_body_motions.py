"""Pick-ups and payloads in physics: where the hand is, and what the ground bears."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.contact import Side
from mgs.judge.verdict import replay_checks
from mgs.robot import Robot
from mgs.sim import DEFAULTS, EngineName, replay
from mgs.sim.engine import make_engine
from tests.support.motions import standing
from tests.support.shipped import generated
from tests.support.strategies import pick_up_gait


@pytest.mark.parametrize("servo", ["ideal", pytest.param("model", marks=pytest.mark.slow)])
@pytest.mark.slow_if("pybullet")
def test_the_hand_of_melson_is_at_the_object_and_the_robot_stays_up(
    melson: Robot, engine_name: EngineName, servo: str
):
    """80 mm in front of the soles, 30 mm above the ground; 2 mm are allowed on ideal servos."""
    motion = generated("melson/pick_up").stages.motion
    result = replay(motion, engine_name, servo=servo)
    assert [check.name for check in replay_checks(result) if not check.ok] == []
    data, hands = melson.model.createData(), []
    grasps = np.flatnonzero((result.trace.t >= 3.5) & (result.trace.t <= 4.0))
    for q in result.trace.q[grasps]:
        pin.framesForwardKinematics(melson.model, data, q)
        hands.append(data.oMf[melson.hand_frames[Side.RIGHT]].translation.copy())
    toe = 0.5 * melson.sole_spec(Side.RIGHT).length
    off = np.linalg.norm(np.array(hands) - [toe + 0.08, -0.09, 0.03], axis=1)
    assert off.max() < (0.002 if servo == "ideal" else 0.01)


def test_a_payload_in_a_hand_weighs_on_the_ground_where_it_hangs(melson, engine_name):
    engine = make_engine(engine_name, melson, DEFAULTS[engine_name])
    q, payload = melson.standing_q, np.array([0.0, 0.2])
    data = melson.model.createData()
    pin.framesForwardKinematics(melson.model, data, q)
    hand = data.oMf[melson.hand_frames[Side.RIGHT]].translation
    joints = np.tile(q[7:], (5, 1))
    found = {}
    engine.place(q)
    for mass in (0.0 * payload, payload, 0.0 * payload):
        engine.carry(mass)
        for _ in range(200):
            engine.drive(joints, np.zeros_like(joints))
        force = engine.contacts().sum(axis=0)
        found[len(found)] = force[[2, 3, 4]]
    engine.close()
    weight = 9.81 * 0.2
    more = found[1] - found[0]
    assert_allclose(more[0], weight, rtol=0.02)
    # its moment about the world's axes; the robot yields a little
    assert_allclose(more[1:] / weight, hand[:2], atol=3e-3)
    assert_allclose(found[2], found[0], atol=0.05)


def test_a_replay_carries_what_the_gait_picks_up(melson, engine_name):
    gait = pick_up_gait(object=[0.1, -0.12, 0.1], payload=0.3, approach=0.2, pause=0.1, lower=0.2)
    motion = dataclasses.replace(standing(melson, 1.5), gait=gait)  # the posture does not matter
    result = replay(motion, engine_name)
    taken = gait.pick_up.times[3]
    up = result.trace.contacts[:, :, 2].sum(axis=1)
    t = result.trace.t
    assert up[t < taken - 0.15].mean() == pytest.approx(9.81 * melson.mass, rel=0.01)
    assert up[t > taken + 0.2].mean() == pytest.approx(9.81 * (melson.mass + 0.3), rel=0.01)
