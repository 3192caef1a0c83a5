"""Tests of the motors of a robot: ticks against figures of data sheets, and faulty files."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.errors import ConfigError, MgsError
from mgs.core.shipped import shipped_folder
from mgs.robot import MotorSpec, build_robot, motors_of, read_motors
from mgs.robot.motor_models import MODELS

FOLDER = shipped_folder("robots") / "melson"
URDF = (FOLDER / "robot.urdf").read_text()


def robot_yaml(motors: object) -> str:
    tree = yaml.safe_load((FOLDER / "robot.yaml").read_text())
    return yaml.safe_dump(tree | {"motors": motors})


@pytest.mark.parametrize(
    ("model", "degrees", "tick"),
    [
        ("AX-12", 0.0, 512),
        ("AX-12", 29.3, 612),  # 0.293 deg a tick
        ("RX-28", -149.9, 0),
        ("MX-28", 90.0, 3072),  # a quarter of 4096
        ("MX-28-2.0", -90.0, 1024),
        ("XL-320", 60.0, 717),  # 512 + 1024 / 5, rounded
        ("XM430", 45.0, 2560),
        ("STS3215", -179.9, 1),
        ("SCS0009", -30.0, 410),
    ],
)
def test_a_known_model_has_the_ticks_of_its_data_sheet(model: str, degrees: float, tick: int):
    motors = motors_of({"a": MotorSpec(id=1, model=model)}, ["a"], "test")  # type: ignore[arg-type]
    assert motors.to_ticks(np.radians([degrees])).tolist() == [tick]


@pytest.mark.parametrize("model", MODELS)
def test_the_ticks_of_every_model_fit_into_its_register(model: str):
    found = MODELS[model]
    assert 0 <= found.lowest < found.centre < found.highest < 1 << (8 * found.register.width)
    assert abs(2 * found.centre - found.lowest - found.highest) <= 1


@given(
    bits=st.sampled_from([10, 12, 14]),
    sign=st.sampled_from([1, -1]),
    gear=st.floats(0.5, 3.0),
    zero=st.floats(-0.5, 0.5),
    angle=st.floats(-0.8, 0.8),
)
def test_an_angle_reads_back_within_half_a_tick(
    bits: int, sign: int, gear: float, zero: float, angle: float
):
    spec = MotorSpec(id=3, sign=sign, gear=gear, zero_offset=zero, ticks_per_turn=2.0**bits)  # type: ignore[arg-type]
    motors = motors_of({"a": spec}, ["a"], "test")
    ticks = motors.to_ticks(np.array([angle]))
    assert 0 <= ticks[0] < 2**bits
    # by hand: the angle of the motor from its middle, in turns
    turns = (sign * gear * angle + zero) / (2.0 * math.pi)
    assert abs(ticks[0] - 2 ** (bits - 1) - turns * 2**bits) <= 0.5 + 1e-9
    half_a_tick = math.pi / (gear * 2**bits)
    assert motors.resolution == pytest.approx([2.0 * half_a_tick])
    assert abs(motors.to_angles(ticks)[0] - angle) <= half_a_tick * (1 + 1e-9)


def test_an_angle_beyond_the_range_of_a_motor_is_refused_with_its_name():
    motors = motors_of({"knee": MotorSpec(id=7, model="AX-12")}, ["knee"], "test")
    with pytest.raises(MgsError, match=r"motor 7 of joint knee .* tick 1025 .* ticks 0 to 1023"):
        motors.to_ticks(np.radians([[0.0], [150.3]]))


def test_a_robot_yaml_takes_the_motors_of_some_joints():
    motors = {
        "left_hip_yaw": {"id": 8, "model": "RX-28", "sign": -1},
        "waist_yaw": {"id": 21, "model": "AX-12"},
    }
    robot = build_robot(robot_yaml(motors), URDF, "robot.yaml")
    assert robot.spec.motors["left_hip_yaw"].sign == -1
    with pytest.raises(ConfigError, match="no motor given for left_hip_roll, left_hip_pitch"):
        motors_of(robot.spec.motors, robot.joint_names, robot.source)


@pytest.mark.parametrize(
    ("motors", "message"),
    [
        ({"neck": {"id": 1, "model": "AX-12"}}, "motors: robot.urdf has no joint 'neck'"),
        (
            {"waist_yaw": {"id": 254, "model": "AX-12"}},
            "motors.waist_yaw.id: input should be less",
        ),
        ({"waist_yaw": {"id": 1}}, "give model or ticks_per_turn"),
        ({"waist_yaw": {"id": 1, "model": "AX-13"}}, "motors.waist_yaw.model"),
        ({"waist_yaw": {"id": 1, "model": "AX-12", "sign": 0}}, "motors.waist_yaw.sign"),
        ({"waist_yaw": {"id": 1, "model": "AX-12", "ticks_per_turn": 4096.0}}, "leave ticks_per"),
        ({"waist_yaw": {"id": 1, "ticks_per_turn": 4096.0, "centre": 5000}}, "centre 5000 is outs"),
        (
            {n: {"id": 4, "model": "RX-28"} for n in ("left_hip_yaw", "right_hip_yaw")},
            "motors.right_hip_yaw: id 4 is that of left_hip_yaw too",
        ),
    ],
)
def test_wrong_motors_are_refused_with_the_key(motors: object, message: str):
    with pytest.raises(ConfigError) as refused:
        build_robot(robot_yaml(motors), URDF, "robot.yaml")
    assert message in str(refused.value)


def test_motors_are_read_from_a_file_of_their_own(tmp_path: Path):
    path = tmp_path / "motors.yaml"
    path.write_text("mgs: 1\nmotors:\n  a: {id: 1, model: XM430, zero_offset: 0.1}\n")
    assert read_motors(path) == {"a": MotorSpec(id=1, model="XM430", zero_offset=0.1)}
    path.write_text("mgs: 1\nmotors:\n  a: {id: 1, model: XM430}\n  b: {id: 1, model: XM430}\n")
    with pytest.raises(ConfigError, match=r"motors.b: id 1 is that of a too"):
        read_motors(path)
