"""Contact forces of the engines against Newton, and how two replays are compared."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest

from mgs.sim import Replay, agreement, replay
from tests.support.motions import DT, leaning, standing, swaying
from tests.support.replays import nominal

GRAVITY = 9.81


def means(result: Replay, start: int) -> np.ndarray:
    """Contacts (2, 5) of a replay, from a sample on."""
    return np.asarray(result.trace.contacts[start:].mean(axis=0))


def test_soles_of_a_standing_robot_carry_its_weight_below_its_com(engine_name, melson):
    contacts = means(replay(standing(melson, 1.0), engine_name), 20)
    weight = melson.mass * GRAVITY
    assert contacts[:, 2].sum() == pytest.approx(weight, rel=1e-3)
    np.testing.assert_allclose(contacts[:, :2].sum(axis=0), 0.0, atol=2e-3 * weight)
    com = pin.centerOfMass(melson.model, melson.model.createData(), melson.standing_q)[:2]
    np.testing.assert_allclose(contacts[:, 3:].sum(axis=0) / weight, com, atol=5e-4)
    for side, sign in ((0, 1.0), (1, -1.0)):  # each sole bears its part at its own place
        assert sign * contacts[side, 4] / contacts[side, 2] > 0.02


def test_a_slope_pulls_along_the_floor(engine_name, melson):
    """The floor pushes back what gravity pulls: m g sin of the slope, uphill."""
    slope = np.array([0.02, -0.03])  # about x and y
    conditions = dataclasses.replace(nominal(melson), slope=slope)
    contacts = means(replay(standing(melson, 1.0), engine_name, conditions=conditions), 20)
    weight = melson.mass * GRAVITY
    down = np.array([np.sin(slope[1]), -np.sin(slope[0]) * np.cos(slope[1])]) * weight
    np.testing.assert_allclose(contacts[:, :2].sum(axis=0), -down, atol=0.02 * weight * 0.03)


def test_contact_forces_accelerate_the_com(engine_name, melson):
    """Oracle: m a + m g of the CoM along a sway of 20 mm, from the plan by differences."""
    t = np.arange(201) * DT
    sway = 0.02 * np.outer(np.sin(np.pi * t / 2.0) ** 2, [0.0, 1.0, 0.0])
    motion = swaying(melson, sway)
    result = replay(motion, engine_name)
    data = melson.model.createData()
    com = np.array([pin.centerOfMass(melson.model, data, q).copy() for q in motion.q])
    force = melson.mass * np.gradient(np.gradient(com[:, 1], DT), DT)
    found = result.trace.contacts[: len(t), :, 1].sum(axis=1)
    window = np.ones(9) / 9.0
    smooth = [np.convolve(f, window, "valid")[10:-10] for f in (force, found)]
    assert np.abs(smooth[0]).max() > 0.1  # [N]
    np.testing.assert_allclose(smooth[1], smooth[0], atol=0.15 * np.abs(smooth[0]).max())


def test_a_replay_agrees_with_itself_and_not_with_another(melson):
    pytest.importorskip("mujoco")
    motion = standing(melson, 0.5)
    result, tilted = replay(motion, "mujoco"), replay(leaning(melson, 0.02, 0.34), "mujoco")
    same = agreement(result, result)
    assert same.same_fate
    assert (same.load, same.zmp, same.tilt_deg, same.end_position, same.end_yaw_deg) == (0,) * 5
    other = agreement(result, tilted)
    assert other.zmp > 0.002
    fallen = dataclasses.replace(result, fell=True)
    assert not agreement(result, fallen).same_fate


def test_engines_agree_on_a_standing_robot(melson):
    for name in ("pybullet", "mujoco"):
        pytest.importorskip(name)
    motion = standing(melson, 0.5)
    found = agreement(replay(motion, "pybullet"), replay(motion, "mujoco"))
    assert found.engines == ("pybullet", "mujoco")
    assert found.same_fate
    assert found.zmp < 1e-3
    assert found.load < 0.1
    assert found.tilt_deg < 0.1
    assert found.end_position < 1e-3
