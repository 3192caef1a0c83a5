"""Commands for one physical robot, replayed by a simulated robot that has its errors."""

from __future__ import annotations

import csv
import dataclasses
from pathlib import Path

import numpy as np
import pytest

from mgs.motion import Motion
from mgs.motion.servo_commands import Commands
from mgs.motion_file.export import export_motion
from mgs.robot import servos_of
from mgs.robot.unit import JointCorrection, Unit, UnitSpec, unit_of
from mgs.sim import EngineName, OneRobot, replay
from mgs.sim.prepare import prepare
from mgs.sim.replay import replay_prepared
from mgs.sim.servo import ServoModel
from mgs.sim.targets import targets_along
from tests.support.bus_robots import with_motors
from tests.support.shipped import generated

DEGREE = np.radians(1.0)


@pytest.fixture(scope="module")
def walk() -> Motion:
    motion = generated("melson/walk_practical").stages.motion
    return dataclasses.replace(motion, robot=with_motors(motion.robot))


@pytest.fixture(scope="module")
def unit(walk: Motion) -> Unit:
    """Zeros within 1 deg, stiffness within 20 %, 0.5 deg of play, scales within 1 %."""
    rng, stiffness = np.random.default_rng(0), servos_of(walk.robot).stiffness
    joints = {
        name: JointCorrection(
            zero_offset=float(rng.uniform(-1.0, 1.0) * DEGREE),
            scale=float(rng.uniform(0.99, 1.01)),
            backlash=float(0.5 * DEGREE),
            stiffness=float(k * rng.uniform(0.8, 1.2)),
        )
        for name, k in zip(walk.robot.joint_names, stiffness, strict=True)
    }
    return unit_of(UnitSpec(mgs=1, unit="number 7", robot="melson", joints=joints), walk.robot)


@pytest.mark.parametrize("feed_forward", [False, True])
@pytest.mark.slow_if("True")
def test_corrected_commands_bring_the_joints_near_the_plan(
    walk: Motion, unit: Unit, feed_forward: bool
):
    """Measured: 0.84 deg against 3.0 deg, and with feed-forward 0.44 against 0.88 deg (RMS).

    Without feed-forward the joints lag, by damping v / stiffness, whether corrected or not.
    """
    found = {
        corrected: replay(
            walk,
            "mujoco",
            servo="model",
            feed_forward=feed_forward,
            one_robot=OneRobot(unit, corrected),
        )
        for corrected in (True, False)
    }
    assert not found[True].fell
    assert found[True].joint_error_rms_deg < 0.55 * found[False].joint_error_rms_deg
    assert found[False].fell or feed_forward
    assert (found[True].unit, found[True].corrected) == ("number 7", True)


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
@pytest.mark.slow_if("pybullet")
def test_zeros_and_scales_alone_are_corrected_completely(
    walk: Motion, unit: Unit, engine: EngineName
):
    """Ideal servos do not yield: the replay is that of a robot without errors."""
    pytest.importorskip(engine)
    plain = replay(walk, engine)
    corrected = replay(walk, engine, one_robot=OneRobot(unit))
    assert abs(corrected.joint_error_rms_deg - plain.joint_error_rms_deg) < 1e-3
    assert replay(walk, engine, one_robot=OneRobot(unit, False)).fell


def test_a_joint_that_turns_the_wrong_way_is_corrected(walk: Motion):
    spec = UnitSpec(
        mgs=1, unit="8", robot="melson", joints={"left_knee_pitch": JointCorrection(sign=-1)}
    )
    wrong = unit_of(spec, walk.robot)
    assert not replay(walk, "mujoco", one_robot=OneRobot(wrong)).fell
    assert replay(walk, "mujoco", one_robot=OneRobot(wrong, False)).fell


def ticks_of(path: Path) -> np.ndarray:
    """Numbers of a table of ticks, without the times."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return np.array(list(csv.reader(lines[1:])), dtype=float)[:, 1:]


def test_the_ticks_of_an_export_keep_the_plan_on_that_robot(
    walk: Motion, unit: Unit, tmp_path: Path
):
    """From the file alone: ticks become angles by hand, and go to the joints of this robot."""
    export_motion(walk, tmp_path / "a.csv", "dynamixel", unit=unit, feed_forward=True)
    export_motion(walk, tmp_path / "plain.csv", "dynamixel", feed_forward=True)
    assert "# joint angles are commands corrected for the physical robot number 7" in (
        (tmp_path / "a.csv").read_text()
    )
    errors = {}
    for name in ("a", "plain"):
        ticks = ticks_of(tmp_path / f"{name}.csv")
        motors = [walk.robot.spec.motors[joint] for joint in walk.robot.joint_names]
        motor_angle = (ticks - 2048) * 2.0 * np.pi / 4096
        told = np.stack(
            [m.sign * (motor_angle[:, j] - m.zero_offset) for j, m in enumerate(motors)], axis=1
        )
        prepared = prepare(walk, "mujoco", servo="model", one_robot=OneRobot(unit))
        reached = unit.sign * unit.scale * told + unit.zero_offset
        commands = Commands(reached, np.zeros(walk.robot.n))
        position, velocity = targets_along(walk, prepared.settings, commands)
        prepared = dataclasses.replace(prepared, position=position, velocity=velocity)
        errors[name] = replay_prepared(prepared).joint_error_rms_deg
    assert errors["a"] < 0.6 < errors["plain"]


def test_a_servo_exerts_no_torque_within_its_play(walk: Motion, unit: Unit):
    servos = servos_of(walk.robot)
    there = OneRobot(unit).with_errors(servos)
    model = ServoModel(there, 0.001)
    none = np.zeros(walk.robot.n)
    free = servos.deadband + 0.5 * unit.backlash
    tick = servos.resolution
    inside, _, _ = model.torque(free - tick, none, none)
    outside, _, _ = model.torque(free + 2.0 * tick, none, none)
    assert np.array_equal(inside, none) and np.all(outside > 0.0)
    assert np.allclose(there.stiffness, 1.0 / unit.compliance)
