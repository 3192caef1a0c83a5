"""Servo figures of a robot.yaml, and feed-forward commands as the inverse of the servo law."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from mgs.core.errors import ConfigError
from mgs.motion.servo_commands import servo_commands
from mgs.robot import Robot, Servos, build_robot, is_modelled, load_robot, servos_of
from mgs.sim.servo import ServoModel
from tests.support.motions import standing


def without_ticks(servos: Servos) -> Servos:
    none = np.zeros_like(servos.resolution)
    return dataclasses.replace(servos, resolution=none, deadband=none, punch=none)


def test_stiffness_follows_from_the_compliance_slope(melson: Robot):
    """At slope 16 the torque is the stall torque 16 steps of 300 deg / 1024 away."""
    servos = servos_of(melson)
    expected = melson.torque_limit / (16 * np.radians(300 / 1024))
    np.testing.assert_allclose(servos.stiffness, expected, rtol=1e-3)
    assert servos.stiffness[melson.joint_names.index("left_knee_pitch")] == pytest.approx(
        34.2, abs=0.1
    )


def test_damping_is_the_back_emf_unless_given(melson: Robot):
    np.testing.assert_array_equal(
        servos_of(melson).damping, melson.torque_limit / melson.no_load_speed
    )
    text = melson.yaml.replace("compliance_slope: 16", "compliance_slope: 16, damping: 0.3")
    servos = servos_of(build_robot(text, melson.urdf, "damped"))
    np.testing.assert_array_equal(servos.damping, 0.3)


def test_melsons_punch_makes_up_for_its_deadband(melson: Robot):
    """Beyond the deadband the torque is stiffness times error, so that tau / K is what it takes."""
    servos = servos_of(melson)
    np.testing.assert_allclose(servos.punch, servos.stiffness * servos.deadband, rtol=2e-3)


@pytest.mark.parametrize("name", ["melson", "coman", "coman_legs"])
def test_every_shipped_robot_says_how_stiff_its_servos_are(name: str):
    robot = load_robot(name)
    assert is_modelled(robot)
    assert (servos_of(robot).stiffness > 0.0).all()


def test_a_servo_that_no_joint_uses_needs_no_stiffness(melson: Robot):
    text = melson.yaml.replace(
        "servos:", "servos:\n  spare: {stall_torque: 1.0, no_load_speed: 1.0}"
    )
    assert is_modelled(build_robot(text, melson.urdf, "spare"))


def test_servos_without_stiffness_are_all_named(melson: Robot):
    text = melson.yaml.replace("compliance_slope: 16, ", "")
    robot = build_robot(text, melson.urdf, "my/robot.yaml")
    assert not is_modelled(robot)
    with pytest.raises(ConfigError) as caught:
        servos_of(robot)
    assert [problem.split(":")[0] for problem in caught.value.problems] == [
        "servos.AX-12",
        "servos.RX-28",
    ]
    assert str(caught.value).startswith("my/robot.yaml: servos.AX-12: ")


def test_a_command_makes_the_servo_give_the_planned_torque(melson: Robot):
    """Oracle: the servo as it is simulated, at the planned angles and speeds."""
    rng = np.random.default_rng(0)
    motion = standing(melson, 0.2)
    n, shape = melson.n, (motion.n_samples, melson.n)
    motion = dataclasses.replace(
        motion,
        torque=rng.uniform(-0.3, 0.3, shape) * melson.torque_limit,
        v=np.concatenate([np.zeros((motion.n_samples, 6)), rng.uniform(-2.0, 2.0, shape)], axis=1),
    )
    commands = servo_commands(motion)
    assert commands.clipped.shape == (n,)
    model = ServoModel(without_ticks(servos_of(melson)), 0.001)
    kept = (commands.position > melson.lower) & (commands.position < melson.upper)
    assert kept.mean() > 0.9
    for k in range(motion.n_samples):
        torque, _, _ = model.torque(commands.position[k], motion.q[k, 7:], motion.v[k, 6:])
        np.testing.assert_allclose(torque[kept[k]], motion.torque[k, kept[k]], atol=1e-12)


def test_commands_of_a_part_are_a_part_of_the_commands(melson: Robot):
    motion = standing(melson, 0.2)
    motion = dataclasses.replace(
        motion, torque=np.random.default_rng(1).normal(size=(motion.n_samples, melson.n))
    )
    whole, part = servo_commands(motion), servo_commands(motion, slice(3, 8))
    np.testing.assert_array_equal(part.position, whole.position[3:8])
    assert (whole.position >= melson.lower).all()
    assert (whole.position <= melson.upper).all()
    assert (part.clipped <= whole.clipped).all()
