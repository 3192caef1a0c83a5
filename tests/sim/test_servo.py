"""Modelled servos: one joint against closed forms, standing robots against statics."""

from __future__ import annotations

import dataclasses
from contextlib import closing

import numpy as np
import pytest

from mgs.core.errors import ConfigError, SimulationError
from mgs.gait import load_gait
from mgs.motion.dynamics import analyse
from mgs.motion.servo_commands import servo_commands
from mgs.pipeline import run_stages
from mgs.robot import build_robot, servos_of
from mgs.robot.servos import SLIP_SPEED
from mgs.sim import DEFAULTS, ENGINES, replay
from mgs.sim.engine import make_engine
from mgs.sim.mujoco_servos import ROTOR_ACCELERATION
from mgs.sim.servo import ServoModel
from tests.support.motions import DT, standing
from tests.support.pendulum import LEVER, MASS, inertia_of, pendulum, step_response
from tests.support.replays import figures

RX28 = {"stall_torque": 2.8, "no_load_speed": 6.27, "stiffness": 17.1}


def run(robot, engine_name, commands, dt=None):
    """Angles, speeds and torques (k, n) under commands (k, n), one physics step each."""
    settings = DEFAULTS[engine_name]
    settings = dataclasses.replace(settings, dt=dt or settings.dt)
    model = ServoModel(servos_of(robot), settings.dt)
    with closing(make_engine(engine_name, robot, settings, "model")) as engine:
        engine.place(robot.standing_q)
        states = []
        for command in np.asarray(commands, dtype=float).reshape(-1, robot.n):
            model.drive(engine, command[None])
            states.append(np.array(engine.joints()))
    return np.moveaxis(np.array(states), 1, 0)


def total_inertia(engine_name, robot, mass=MASS):
    """Of arm and rotor; PyBullet has no rotors, MuJoCo makes one up where none is stated."""
    if engine_name == "pybullet":
        return inertia_of(mass)
    return inertia_of(mass) + (robot.armature[0] or robot.torque_limit[0] / ROTOR_ACCELERATION)


@pytest.mark.parametrize(
    ("mass", "damping"),
    [(0.4, 0.05), (0.4, 0.6), (0.004, 0.4466)],
    ids=["swinging", "creeping", "lighter than its damping allows an explicit step"],
)
def test_a_step_is_answered_as_by_a_spring_and_a_damper(engine_name, mass, damping):
    robot = pendulum(mass=mass, stiffness=17.1, damping=damping, armature=0.005)
    dt, height = DEFAULTS[engine_name].dt, 0.2
    n = round(0.5 / dt)
    angle, _, _ = run(robot, engine_name, np.full(n, height))
    t = dt * np.arange(1, n + 1)
    inertia = total_inertia(engine_name, robot, mass)
    expected = height * step_response(t, inertia, damping, 17.1)
    np.testing.assert_allclose(angle[:, 0], expected, atol=0.035 * height)
    if inertia / damping < dt:  # as of the light arm in PyBullet: the step does not resolve it
        return
    halved, _, _ = run(robot, engine_name, np.full(2 * n, height), dt / 2)
    # first-order integration
    assert np.abs(halved[1::2, 0] - expected).max() < 0.7 * np.abs(angle[:, 0] - expected).max()


def test_an_explicit_step_would_throw_the_light_arm_to_and_fro():
    """Why PyBullet is told the speed at which a torque vanishes: dt damping / inertia is 8."""
    robot = pendulum(mass=0.004, stiffness=17.1, damping=0.4466)
    dt = DEFAULTS["pybullet"].dt
    assert dt * 0.4466 / inertia_of(0.004) > 2.0
    angle, speed, _ = run(robot, "pybullet", np.full(300, 0.2))
    assert (np.diff(angle[:, 0]) > -1e-9).all()
    assert np.abs(speed).max() < 1.01 * 17.1 * 0.2 / 0.4466


def test_a_load_makes_a_servo_droop_by_load_over_stiffness(engine_name):
    robot = pendulum("level", stiffness=20.0, damping=0.5)
    angle, _, torque = run(robot, engine_name, np.full(round(2.0 / DEFAULTS[engine_name].dt), 0.0))
    load = MASS * 9.81 * LEVER * np.cos(angle[-1, 0])
    assert angle[-1, 0] == pytest.approx(-load / 20.0, abs=1e-4)
    assert torque[-1, 0] == pytest.approx(load, rel=1e-3)


def test_friction_lets_a_load_creep_that_it_would_hold(engine_name):
    """Below SLIP_SPEED it is viscous: 0.4 N m let a load of 0.39 N m sink at 0.098 rad/s."""
    robot = pendulum("level", stiffness=0.01, damping=0.0, friction=0.4)
    speed = run(robot, engine_name, np.full(round(0.12 / DEFAULTS[engine_name].dt), 0.0))[1]
    load = MASS * 9.81 * LEVER
    assert speed[-1, 0] == pytest.approx(-load / 0.4 * SLIP_SPEED, rel=0.05)


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_an_unloaded_servo_reaches_its_no_load_speed(engine_name, friction):
    robot = pendulum(**RX28, friction=friction)
    n = round(1.0 / DEFAULTS[engine_name].dt)
    _, speed, _ = run(robot, engine_name, np.full(n, 60.0))
    assert speed[-1, 0] == pytest.approx(6.27 * (1.0 - friction / 2.8), rel=2e-3)
    assert speed.max() <= 6.27 * (1.0 + 1e-6)


def test_a_servo_has_its_stall_torque_and_no_more(engine_name):
    robot = pendulum("level", mass=4.0, **RX28)  # weighs 3.9 N m
    angle, _, torque = run(robot, engine_name, np.full(round(0.2 / DEFAULTS[engine_name].dt), 1.0))
    assert torque[0, 0] == pytest.approx(2.8, rel=1e-3)
    assert np.abs(torque).max() <= 2.8 * (1.0 + 1e-9)
    assert angle[-1, 0] < -0.01  # the weight wins


def test_the_torque_left_is_on_the_line_from_stall_torque_to_no_load_speed():
    model = ServoModel(servos_of(pendulum(**RX28, damping=0.0)), 0.001)
    for speed in (-8.0, -3.0, 0.0, 3.0, 6.0, 8.0):
        for command, sign in ((9.0, 1.0), (-9.0, -1.0)):
            torque, _, limited = model.torque(np.array([command]), np.zeros(1), np.array([speed]))
            line = sign * min(2.8, 2.8 * (1.0 - sign * speed / 6.27))
            assert torque[0] == pytest.approx(line)
            assert limited[0]
    for speed, expected in ((1.0, 1.71), (3.0, 2.8 * (1.0 - 3.0 / 6.27))):
        torque, _, limited = model.torque(np.array([0.1]), np.zeros(1), np.array([speed]))
        assert torque[0] == pytest.approx(expected)
        assert limited[0] == (expected < 1.71)


def test_torque_and_free_speed_have_the_same_sense():
    """A motor that aims at the free speed with the torque as its limit must push that way."""
    rng = np.random.default_rng(0)
    model = ServoModel(servos_of(pendulum(**RX28, friction=0.2, viscous_friction=0.1)), 0.001)
    for command, speed in rng.uniform([-0.3, -7.0], [0.3, 7.0], (1000, 2)):
        v = np.array([speed])
        torque, free, _ = model.torque(np.array([command]), np.zeros(1), v)
        assert torque[0] * (free[0] - speed) >= 0.0
        _, zero, _ = model.torque(np.array([command]), np.zeros(1), np.zeros(1))
        if abs(zero[0]) > SLIP_SPEED:  # below, friction is not all there
            at_zero, _, _ = model.torque(np.array([command]), np.zeros(1), zero)
            assert at_zero[0] == pytest.approx(0.0, abs=1e-9)


def test_a_command_arrives_a_whole_number_of_steps_later(engine_name):
    latency, dt = 0.0102, DEFAULTS[engine_name].dt
    robot = pendulum(stiffness=10.0, latency=latency)
    commands = np.zeros(round(0.05 / dt))
    told = 7
    commands[told:] = 0.1
    _, _, torque = run(robot, engine_name, commands)
    # of 1 N m; before it there are traces of the base that settles
    assert np.flatnonzero(torque[:, 0] > 0.5)[0] == told + round(latency / dt)


def test_latency_delays_and_changes_nothing_else(engine_name):
    dt = DEFAULTS[engine_name].dt
    commands = 0.2 * np.sin(20.0 * dt * np.arange(round(0.3 / dt)))
    late, prompt = (
        run(pendulum(stiffness=10.0, damping=0.3, latency=latency), engine_name, commands)[0]
        for latency in (20 * dt, 0.0)
    )
    np.testing.assert_allclose(late[20:], prompt[:-20], atol=1e-6)


def test_blocks_of_commands_make_no_difference():
    robot = pendulum(stiffness=10.0, latency=0.013)
    commands = np.arange(60.0)[:, None]
    whole = ServoModel(servos_of(robot), 0.001)._delayed(commands)
    model = ServoModel(servos_of(robot), 0.001)
    parts = [model._delayed(block) for block in np.split(commands, [4, 5, 30])]
    np.testing.assert_array_equal(np.concatenate(parts), whole)
    np.testing.assert_array_equal(whole[:, 0], np.maximum(np.arange(60.0) - 13.0, 0.0))


def test_angles_are_counted_in_ticks():
    tick = 0.005
    model = ServoModel(servos_of(pendulum(stiffness=100.0, resolution=tick)), 0.001)
    for command, q, ticks in (
        (0.0124, 0.0, 2),
        (0.0126, 0.0, 3),
        (0.0, 0.0124, -2),
        (0.01, 0.01, 0),
    ):
        torque, _, _ = model.torque(np.array([command]), np.array([q]), np.zeros(1))
        assert torque[0] == pytest.approx(ticks * 100.0 * tick, abs=1e-12)


def test_within_the_deadband_there_is_no_torque_and_beyond_it_punch():
    servos = servos_of(pendulum(stiffness=100.0, deadband=0.01, punch=0.3))
    model = ServoModel(servos, 0.001)
    for error, expected in ((0.009, 0.0), (0.01, 0.0), (0.011, 0.4), (-0.02, -1.3)):
        torque, _, _ = model.torque(np.array([error]), np.zeros(1), np.zeros(1))
        assert torque[0] == pytest.approx(expected)


# --- standing robots --------------------------------------------------------------------------


def held(robot, seconds):
    """The half-sitting posture with the torques that hold it, each leg bearing one half."""
    motion = standing(robot, seconds)
    body = analyse(robot, motion.q, DT, np.full(motion.n_samples, 0.5))
    return dataclasses.replace(motion, torque=body.torque)


def smooth(robot):
    """The robot with servos that have neither ticks nor deadband nor friction."""
    spec = robot.yaml
    for key in ("resolution: 0.00511", "deadband: 0.00511", "friction: 0.05"):
        assert key in spec
        spec = spec.replace(key, f"{key.split(':')[0]}: 0.0")
    for punch in ("0.1752", "0.0938"):
        spec = spec.replace(f"punch: {punch}", "punch: 0.0")
    # 32 ticks of 0.00511 rad
    spec = spec.replace("compliance_slope: 16", "stiffness: 17.1")
    return build_robot(spec, robot.urdf, "smooth")


def test_feed_forward_takes_the_droop_away(engine_name, melson):
    motion = held(smooth(melson), 1.0)
    without = replay(motion, engine_name, servo="model", feed_forward=False)
    result = replay(motion, engine_name, servo="model")
    assert (without.feed_forward, result.feed_forward) == (False, True)
    assert without.joint_error_max_deg > 2.0
    assert result.joint_error_max_deg < 0.05
    assert result.max_tilt_deg < 0.05
    assert not result.fell


def test_a_standing_robot_droops_by_torque_over_stiffness(engine_name, melson):
    """At every joint; the weight moves on as the robot sinks, which changes torques a little."""
    robot = smooth(melson)
    motion = held(robot, 2.0)
    result = replay(motion, engine_name, servo="model", feed_forward=False)
    sag = motion.q[-1, 7:] - result.trace.q[-1, 7:]
    np.testing.assert_allclose(result.trace.torque[-1], 17.1 * sag, atol=0.01)
    knee = robot.joint_names.index("left_knee_pitch")
    assert sag[knee] == pytest.approx(motion.torque[-1, knee] / 17.1, rel=0.15)


def test_both_engines_agree_on_a_standing_droop(melson):
    for name in ENGINES:
        pytest.importorskip(name)
    motion = held(melson, 1.0)
    ends = [
        replay(motion, name, servo="model", feed_forward=False).trace.q[-1, 7:] for name in ENGINES
    ]
    # a tick is 0.29 deg, and a servo rests where friction and deadband let it
    np.testing.assert_allclose(np.degrees(ends[0] - ends[1]), 0.0, atol=0.45)


def test_the_same_replay_twice_gives_the_same_figures(engine_name, melson):
    first, second = (replay(held(melson, 0.3), engine_name, servo="model") for _ in range(2))
    assert figures(first) == figures(second)
    np.testing.assert_array_equal(first.trace.q, second.trace.q)


def test_a_robot_without_stiffness_is_refused(engine_name, melson):
    robot = build_robot(melson.yaml.replace("compliance_slope: 16, ", ""), melson.urdf, "a.yaml")
    with pytest.raises(ConfigError, match=r"a\.yaml: servos\.AX-12: .* give stiffness"):
        replay(standing(robot, 0.1), engine_name, servo="model")
    assert not replay(standing(robot, 0.1), engine_name).fell


def test_an_unknown_servo_is_refused(melson):
    with pytest.raises(SimulationError, match="ideal, model"):
        replay(standing(melson, 0.1), "mujoco", servo="perfect")


def test_commands_outside_the_joint_limits_are_cut_and_reported(engine_name, melson):
    limited = melson.yaml + "\nlimits: {left_knee_pitch: [0.865, 2.2]}\n"
    motion = held(build_robot(limited, melson.urdf, "limited"), 0.1)
    result = replay(motion, engine_name, servo="model")
    knee = motion.robot.joint_names.index("left_knee_pitch")
    wanted = motion.q[0, 7 + knee] + motion.torque[0, knee] / (2.8 / (16 * 0.00511))
    assert result.command_clipped_joint == "left_knee_pitch"
    assert result.command_clipped_deg == pytest.approx(np.degrees(0.865 - wanted))
    assert servo_commands(motion).position[:, knee].min() == 0.865


@pytest.mark.slow
@pytest.mark.parametrize("name", ["walk_5cm", "walk_practical"])
@pytest.mark.parametrize("step", [1.0, 0.5])
def test_a_walk_stays_up_with_feed_forward_and_falls_without(engine_name, melson, name, step):
    """At compliance slope 32, twice as soft as Melson's own setting."""
    text = melson.yaml.replace("compliance_slope: 16", "compliance_slope: 32")
    text = text.replace("punch: 0.1752", "punch: 0.0876").replace("punch: 0.0938", "punch: 0.0469")
    soft = build_robot(text, melson.urdf, "soft")
    motion = run_stages(soft, load_gait(f"melson/{name}"), name).motion
    settings = DEFAULTS[engine_name]
    settings = dataclasses.replace(settings, dt=step * settings.dt)
    result = replay(motion, engine_name, settings, servo="model")
    assert not result.fell
    assert result.max_tilt_deg < 2.0
    assert result.position_error < 0.02
    assert replay(motion, engine_name, settings, servo="model", feed_forward=False).fell
