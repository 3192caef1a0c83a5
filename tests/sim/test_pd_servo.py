"""Plain PD servos: one joint against closed forms, standing robots against statics."""

from __future__ import annotations

import dataclasses
import math
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from mgs.gait import parse_gait
from mgs.motion.servo_commands import servo_commands
from mgs.pipeline import generate
from mgs.robot import build_robot, pd_servos
from mgs.sim import DEFAULTS, replay
from mgs.sim.engine import make_engine
from mgs.sim.mujoco_servos import ROTOR_ACCELERATION
from mgs.sim.servo import ServoModel
from mgs.sim.settings import OWN_SERVOS
from tests.support.motions import standing
from tests.support.pendulum import LEVER, MASS, inertia_of, pendulum, step_response
from tests.support.replays import nominal, side_to_side

SAG, TIME = math.radians(1.0), 0.01
STALL = 2.8


def settings_of(engine_name, sag=SAG, damping_time=TIME, dt=None):
    settings = DEFAULTS[engine_name]
    return dataclasses.replace(settings, dt=dt or settings.dt, sag=sag, damping_time=damping_time)


def run(robot, engine_name, commands, settings):
    """Angles and speeds (k, n) after steps under commands (k, n), torques and limits in them."""
    angles, speeds, torques, limits = [], [], [], []
    with closing(make_engine(engine_name, robot, settings, "pd")) as engine:
        engine.place(robot.standing_q)
        model = ServoModel(pd_servos(robot, settings.sag, settings.damping_time), settings.dt)
        for command in np.asarray(commands, dtype=float).reshape(-1, 1, robot.n):
            if "pd" in OWN_SERVOS[engine_name]:
                driven = engine.torques(engine.drive(command, np.zeros_like(command)))
            else:
                driven = model.drive(engine, command)
            state = engine.joints()
            angles.append(state.position)
            speeds.append(state.velocity)
            torques.append(driven.torque[0])
            limits.append(driven.limited[0])
    return (np.array(rows) for rows in (angles, speeds, torques, limits))


def law(command, angle, speed, stall=STALL, no_load_speed=6.27, sag=SAG, time=TIME):
    """Torque of a PD servo as docs/simulation.md has it."""
    torque = stall / sag * (command - angle) - stall / sag * time * speed
    line = stall * speed / no_load_speed
    return np.clip(torque, max(-stall, -stall - line), min(stall, stall - line))


@pytest.mark.parametrize(("sag_deg", "time"), [(1.0, 0.01), (10.0, 0.05), (5.0, 0.0)])
def test_a_step_is_answered_as_by_a_spring_and_a_damper(engine_name, sag_deg, time):
    """As long as neither stall torque nor speed limit it."""
    sag, stall = math.radians(sag_deg), 20.0
    robot = pendulum(mass=4.0, stall_torque=stall, no_load_speed=100.0, armature=0.005)
    settings = settings_of(engine_name, sag, time)
    n, height = round(0.2 / settings.dt), 0.5 * sag
    angle, *_ = run(robot, engine_name, np.full(n, height), settings)
    inertia = inertia_of(4.0) + (0.005 if engine_name == "mujoco" else 0.0)
    t = settings.dt * np.arange(1, n + 1)
    expected = height * step_response(t, inertia, time * stall / sag, stall / sag)
    np.testing.assert_allclose(angle[:, 0], expected, atol=0.06 * height)
    halved = dataclasses.replace(settings, dt=settings.dt / 2)
    finer, *_ = run(robot, engine_name, np.full(2 * n, height), halved)
    assert np.abs(finer[1::2, 0] - expected).max() < 0.7 * np.abs(angle[:, 0] - expected).max()


def test_torques_are_those_of_the_law_within_the_speed_torque_line():
    """In MuJoCo, whose servos have no other reason to give less; large swings reach all limits."""
    pytest.importorskip("mujoco")
    robot = pendulum(stall_torque=STALL, no_load_speed=6.27, armature=0.005)
    settings = settings_of("mujoco")
    rng = np.random.default_rng(0)
    commands = np.repeat(rng.uniform(-1.5, 1.5, 40), 60)
    angle, speed, torque, limited = run(robot, "mujoco", commands, settings)
    before_angle, before_speed = np.append(0.0, angle[:-1, 0]), np.append(0.0, speed[:-1, 0])
    expected = [law(*state) for state in zip(commands, before_angle, before_speed, strict=True)]
    np.testing.assert_allclose(torque[:, 0], expected, atol=1e-9)
    free = [
        law(*state, no_load_speed=1e9, stall=1e9, sag=1e9 * SAG / STALL)
        for state in zip(commands, before_angle, before_speed, strict=True)
    ]
    clearly = np.abs(np.array(expected) - np.array(free)) > 0.01
    assert clearly.any() and not clearly.all()
    np.testing.assert_array_equal(limited[clearly, 0], True)
    assert (np.abs(torque) > 0.999 * STALL).any()  # stall torque
    assert (limited[:, 0] & (np.abs(torque[:, 0]) < 0.9 * STALL)).any()  # the line


def test_an_unloaded_servo_reaches_its_no_load_speed(engine_name):
    robot = pendulum(stall_torque=STALL, no_load_speed=6.27)
    settings = settings_of(engine_name)
    n = round(0.8 / settings.dt)
    _, speed, _, limited = run(robot, engine_name, np.full(n, 60.0), settings)
    assert speed[-1, 0] == pytest.approx(6.27, rel=2e-3)
    assert speed.max() <= 6.27 * (1.0 + 1e-3)
    assert limited.all()


def test_a_load_of_half_the_stall_torque_makes_it_sag_by_half(engine_name):
    weight = MASS * 9.81 * LEVER
    robot = pendulum("level", stall_torque=2.0 * weight, no_load_speed=6.0)
    settings = settings_of(engine_name)
    angle, _, torque, limited = run(
        robot, engine_name, np.zeros(round(0.5 / settings.dt)), settings
    )
    assert angle[-1, 0] == pytest.approx(-0.5 * SAG, rel=1e-3)
    assert torque[-1, 0] == pytest.approx(weight, rel=1e-3)
    assert not limited[-1, 0]


def test_a_light_arm_is_not_thrown_to_and_fro(engine_name):
    """0.1 N m/rad of stiffness would do that to 4 g in an explicit step; a robot's feet are so."""
    robot = pendulum(mass=0.004, stall_torque=STALL, no_load_speed=60.0)
    settings = settings_of(engine_name)
    angle, *_ = run(robot, engine_name, np.full(200, 0.5 * SAG), settings)
    assert settings.dt * TIME * STALL / SAG / inertia_of(0.004) > 2.0
    assert angle.max() < 0.5 * SAG * 1.05
    assert angle[-1, 0] == pytest.approx(0.5 * SAG, rel=0.01)


def test_mujocos_own_pd_servo_is_the_explicit_one_at_a_small_step(melson):
    """The implicit damping of MuJoCo's integrator makes the larger step possible."""
    pytest.importorskip("mujoco")
    motion = side_to_side(melson, 0.03, 1.0)
    fine = settings_of("mujoco", dt=1e-4)
    model = ServoModel(pd_servos(melson, SAG, TIME), fine.dt)
    with closing(make_engine("mujoco", melson, fine, "model")) as engine:
        engine.place(motion.q[0])
        for k in range(1, motion.n_samples):
            model.drive(engine, motion.q[k - 1 : k, 7:].repeat(round(motion.dt / fine.dt), axis=0))
        explicit = engine.read()
    own = settings_of("mujoco")
    with closing(make_engine("mujoco", melson, own, "pd")) as engine:
        engine.place(motion.q[0])
        for k in range(1, motion.n_samples):
            targets = motion.q[k - 1 : k, 7:].repeat(round(motion.dt / own.dt), axis=0)
            engine.drive(targets, np.zeros_like(targets))
        np.testing.assert_allclose(engine.read(), explicit, atol=2e-3)


def test_a_standing_robot_sags_by_torque_over_stiffness(engine_name, melson):
    result = replay(standing(melson, 2.0), engine_name, servo="pd")
    assert not result.fell
    sag = standing(melson, 0.1).q[0, 7:] - result.trace.q[-1, 7:]
    torque = result.trace.torque[-1]
    # PyBullet's arms, light as they are, move to and fro by a hundredth of a degree
    np.testing.assert_allclose(sag, torque * SAG / melson.torque_limit, atol=math.radians(0.025))
    assert np.degrees(np.abs(sag).max()) > 0.15


@pytest.mark.slow_if("pybullet")
def test_twice_the_sag_lets_a_robot_give_way_twice_as_far(engine_name, melson):
    errors = [
        replay(
            standing(melson, 1.0), engine_name, settings_of(engine_name, k * SAG), servo="pd"
        ).joint_error_rms_deg
        for k in (1.0, 2.0)
    ]
    assert errors[1] == pytest.approx(2.0 * errors[0], rel=0.1)


TWO_CIRCLES = """
mgs: 1
robot: melson
motion: sequence
sequence:
  parts:
    - gait: melson/walk_practical
      set: {walk.n_steps: 21, walk.step_length: 0.06, walk.step_yaw: 0.31415927, walk.first_support: null}
    - gait: melson/walk_practical
      set: {walk.n_steps: 21, walk.step_length: 0.06, walk.step_yaw: -0.31415927, walk.first_support: null}
"""  # noqa: E501


@pytest.mark.slow
def test_forty_turning_steps_end_where_they_are_planned(engine_name, melson):
    """With steps of 1 ms soles creep in PyBullet: it ended 50 mm off, with 0.25 ms 1.4 mm."""
    motion = generate(melson, parse_gait(TWO_CIRCLES, "test", folder=Path())).motion
    result = replay(motion, engine_name, settings_of(engine_name, 0.5 * SAG), servo="pd")
    assert result.position_error < 0.01
    assert abs(result.yaw_error_deg) < 1.5


@pytest.mark.slow_if("pybullet")
def test_a_draw_multiplies_the_sag(engine_name, melson):
    motion = standing(melson, 0.3)
    softer = dataclasses.replace(nominal(melson), sag=2.0)
    drawn = replay(motion, engine_name, servo="pd", conditions=softer)
    asked = replay(motion, engine_name, settings_of(engine_name, 2.0 * SAG), servo="pd")
    assert drawn.settings == asked.settings
    np.testing.assert_array_equal(drawn.trace.q, asked.trace.q)
    ideal = [replay(motion, engine_name, conditions=c) for c in (softer, nominal(melson))]
    np.testing.assert_array_equal(ideal[0].trace.q, ideal[1].trace.q)


def test_a_gain_of_a_half_is_twice_the_sag(engine_name, melson):
    motion = standing(melson, 0.3)
    half = dataclasses.replace(nominal(melson), gain=np.full(melson.n, 0.5))
    drawn = replay(motion, engine_name, servo="pd", conditions=half)
    asked = replay(motion, engine_name, settings_of(engine_name, 2.0 * SAG), servo="pd")
    np.testing.assert_allclose(drawn.trace.q, asked.trace.q, atol=1e-9)


def test_robots_without_stiffness_have_pd_servos_too(engine_name, melson):
    text = melson.yaml.replace("compliance_slope: 16, ", "")
    robot = build_robot(text, melson.urdf, "bare")
    result = replay(standing(robot, 0.3), engine_name, servo="pd")
    assert (result.fell, result.servo, result.feed_forward) == (False, "pd", False)


def test_feed_forward_is_for_the_pd_servos_and_may_assume_another_stiffness(melson):
    motion = dataclasses.replace(standing(melson, 0.3), torque=np.full((31, melson.n), 0.7))
    servos = pd_servos(melson, SAG, TIME)
    lead = servo_commands(motion, servos=servos).position - motion.q[:, 7:]
    np.testing.assert_allclose(lead[:, 0], 0.7 / (melson.torque_limit[0] / SAG))
    results = [
        replay(motion, "mujoco", servo="pd", feed_forward=True, assumed_stiffness=factor)
        for factor in (1.0, 0.7)
    ]
    assert [result.assumed_stiffness for result in results] == [1.0, 0.7]
    waist = melson.joint_names.index("waist_yaw")  # that bears nothing
    turned = [result.trace.q[-1, 7 + waist] - motion.q[-1, 7 + waist] for result in results]
    assert turned[1] == pytest.approx(turned[0] / 0.7, rel=0.01)


def test_rotors_that_are_not_stated_are_in_proportion_to_the_stall_torque(melson):
    """Then damping and rotor have the same time constant in every robot: 0.2 of it is a step."""
    settings = DEFAULTS["mujoco"]
    rate = ROTOR_ACCELERATION * settings.damping_time / settings.sag  # damping / rotor inertia
    assert settings.dt * rate < 0.5
