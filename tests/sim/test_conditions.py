"""Conditions other than the plan's: draws, and what each of them does to a replay."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest

from mgs.pipeline import Stages
from mgs.robot import Robot
from mgs.sim import replay
from mgs.sim.conditions import RANGES, Conditions, disturbed, draw, gravity_on_slope
from mgs.sim.model import simulation_urdf
from tests.support.motions import standing
from tests.support.replays import nominal


def test_a_draw_is_its_seed_and_number(walk_5cm: Stages):
    motion = walk_5cm.motion
    first, again = (draw(motion, RANGES["wide"], 7, 3) for _ in range(2))
    for field in dataclasses.fields(Conditions):
        np.testing.assert_array_equal(getattr(first, field.name), getattr(again, field.name))
    other = draw(motion, RANGES["wide"], 7, 4)
    assert not np.array_equal(first.mass, other.mass)
    assert first.friction != draw(motion, RANGES["wide"], 8, 3).friction


def test_draws_stay_in_their_ranges_and_reach_far_into_them(walk_5cm: Stages):
    draws = [draw(walk_5cm.motion, RANGES["wide"], 0, k) for k in range(300)]
    limits = {
        "friction": ([d.friction for d in draws], 0.5, 1.0),
        "slope": (np.degrees([d.slope for d in draws]), -1.0, 1.0),
        "mass": ([d.mass for d in draws], 0.95, 1.05),
        "com": ([d.com for d in draws], -0.005, 0.005),
        "gain": ([d.gain for d in draws], 0.8, 1.2),
        "supply": ([d.supply for d in draws], 0.8, 1.0),
        "latency": ([d.latency for d in draws], 0.0, 0.010),
        "bump": ([d.bumps[:, 2] for d in draws], 0.0, 0.002),
        "logarithm of the sag": (np.log2([d.sag for d in draws]), -2.0, 2.0),
    }
    for name, (values, low, high) in limits.items():
        values = np.asarray(values)
        assert low <= values.min() <= low + 0.05 * (high - low), name
        assert high - 0.05 * (high - low) <= values.max() <= high, name
    offsets = np.degrees([d.joint_offset for d in draws])
    assert offsets.std() == pytest.approx(0.3, rel=0.05)


def test_lab_is_half_of_wide():
    wide, lab = RANGES["wide"], RANGES["lab"]
    assert lab.friction == (0.75, 1.0)
    assert (wide.sag, lab.sag) == ((0.25, 4.0), (0.5, 2.0))  # half of it as a logarithm
    for field in dataclasses.fields(wide):
        if field.name not in ("friction", "sag"):
            assert getattr(lab, field.name) == pytest.approx(0.5 * getattr(wide, field.name))


def test_every_footstep_but_the_first_two_has_a_bump_under_its_sole(walk_5cm: Stages):
    motion = walk_5cm.motion
    bumps = draw(motion, RANGES["wide"], 0, 0).bumps
    assert len(bumps) == len(motion.footsteps) - 2
    for step, (x, y, _) in zip(motion.footsteps[2:], bumps, strict=True):
        sole = motion.robot.sole_spec(step.side)
        assert abs(x - step.x) <= 0.5 * sole.length
        assert abs(y - step.y) <= 0.5 * sole.width


def test_the_disturbed_robot_has_other_masses_and_its_com_elsewhere(melson: Robot):
    conditions = dataclasses.replace(
        nominal(melson),
        mass=np.full(melson.n + 1, 1.05),
        com=np.array([0.0, 0.004, 0.0]),
        supply=0.8,
    )
    robot = disturbed(melson, conditions)
    assert robot.mass == pytest.approx(1.05 * melson.mass)
    np.testing.assert_allclose(robot.torque_limit, 0.8 * melson.torque_limit)
    q = pin.neutral(melson.model)  # where all link frames are parallel
    com = [pin.centerOfMass(r.model, r.model.createData(), q) for r in (melson, robot)]
    np.testing.assert_allclose(com[1] - com[0], [0.0, 0.004, 0.0], atol=1e-12)
    assert melson.mass == pytest.approx(2.6)  # the original is as it was


def test_no_disturbance_is_the_robot_itself(melson: Robot):
    assert simulation_urdf(disturbed(melson, nominal(melson))) == simulation_urdf(melson)


def test_gravity_leans_as_the_floor_does():
    g = gravity_on_slope(np.radians([0.0, 1.0]), 9.81)
    assert np.linalg.norm(g) == pytest.approx(9.81)
    # a floor turned about +y by 1 deg goes down ahead: things roll forward
    np.testing.assert_allclose(
        g, 9.81 * np.array([np.sin(np.radians(1.0)), 0.0, -np.cos(np.radians(1.0))])
    )
    g = gravity_on_slope(np.radians([1.0, 0.0]), 9.81)
    assert g[1] == pytest.approx(-9.81 * np.sin(np.radians(1.0)))


def test_nominal_conditions_change_nothing(melson: Robot, engine_name):
    motion = standing(melson, 1.0)
    plain = replay(motion, engine_name)
    same = replay(motion, engine_name, conditions=nominal(melson))
    np.testing.assert_array_equal(plain.trace.q, same.trace.q)


def test_on_too_steep_a_floor_the_robot_falls(melson: Robot, engine_name):
    motion = standing(melson, 1.0)
    steep = dataclasses.replace(nominal(melson), slope=np.radians([0.0, 20.0]))
    assert replay(motion, engine_name, conditions=steep).fell


def test_on_a_slippery_floor_it_slides_down(melson: Robot, engine_name):
    """Friction 0.1 holds up to 5.7 deg."""
    motion = standing(melson, 1.0)
    slope = np.radians([0.0, 8.0])
    ice = dataclasses.replace(nominal(melson), slope=slope, friction=0.1)
    assert replay(motion, engine_name, conditions=ice).distance[0] > 0.05


def test_joints_stand_where_their_zeros_put_them(melson: Robot, engine_name):
    motion = standing(melson, 1.0)
    offset = np.zeros(melson.n)
    i = melson.joint_names.index("left_shoulder_pitch")
    offset[i] = 0.1
    result = replay(
        motion, engine_name, conditions=dataclasses.replace(nominal(melson), joint_offset=offset)
    )
    angle = result.trace.q[-1, 7 + i] - motion.q[-1, 7 + i]
    assert angle == pytest.approx(0.1, abs=0.005)


def test_late_commands_make_a_moving_joint_late(walk_5cm: Stages):
    pytest.importorskip("mujoco")
    motion = walk_5cm.motion
    late = dataclasses.replace(nominal(motion.robot), latency=0.05)
    plain, delayed = replay(motion, "mujoco"), replay(motion, "mujoco", conditions=late)
    i = motion.robot.joint_names.index("left_hip_roll")
    window = slice(200, 1000)
    q = [r.trace.q[window, 7 + i] for r in (plain, delayed)]
    shifted = plain.trace.q[195:995, 7 + i]  # 5 samples earlier
    assert np.abs(q[1] - shifted).max() < 0.2 * np.abs(q[1] - q[0]).max()
