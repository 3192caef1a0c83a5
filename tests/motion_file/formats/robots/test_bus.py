"""Files for servos on a bus, decoded by the maker's own library and by hand."""

from __future__ import annotations

import csv
import dataclasses
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dynamixel_sdk import Protocol1PacketHandler, Protocol2PacketHandler
from hypothesis import given
from hypothesis import strategies as st

import mgs
from mgs.core.errors import ConfigError, MgsError, MotionFileError
from mgs.motion import Motion
from mgs.motion_file.export import export_motion
from mgs.motion_file.formats import FORMATS, Options
from mgs.motion_file.formats.robots.sync_write import parse_sync_write, sync_write
from mgs.robot import MotorSpec
from mgs.robot.motor_models import MODELS, Register
from tests.support.bus_robots import motors_of_melson, with_motors
from tests.support.shipped import generated

HALF_TICK = {"AX-12": np.radians(300.0 / 1024) / 2, "MX-28": np.pi / 4096, "XM430": np.pi / 4096}
COMMENT = "#"


class Wire:
    """Port of the maker's library that keeps what is written."""

    def __init__(self) -> None:
        self.sent = b""
        self.is_using = False

    def clearPort(self) -> None:
        self.sent = b""

    def writePort(self, packet: Any) -> int:
        self.sent += bytes(packet)
        return len(packet)


def by_the_maker(register: Register, ids: list[int], values: list[int]) -> bytes:
    """Packet that dynamixel-sdk sends."""
    parameters = []
    for number, value in zip(ids, values, strict=True):
        parameters += [number, *value.to_bytes(register.width, "little", signed=value < 0)]
    wire = Wire()
    handler: Any = Protocol1PacketHandler() if register.protocol == 1 else Protocol2PacketHandler()
    sent = handler.syncWriteTxOnly(
        wire, register.address, register.width, parameters, len(parameters)
    )
    assert sent == 0
    return wire.sent


@pytest.fixture(scope="module")
def walk() -> Motion:
    return generated("melson/walk_practical").stages.motion


def of_model(walk: Motion, model: Any) -> Motion:
    return dataclasses.replace(walk, robot=with_motors(walk.robot, model))


registers = st.sampled_from(
    [
        Register("dynamixel", 1, 30, 2),
        Register("dynamixel", 2, 116, 4),
        Register("dynamixel", 2, 30, 2),
    ]
)
goals = st.dictionaries(st.integers(0, 252), st.integers(0, 65535), min_size=1, max_size=40)


@given(register=registers, goals=goals)
def test_packets_are_those_of_the_maker_s_library(register: Register, goals: dict[int, int]):
    """Values such as 0xFFFF and 0xFFFD make the pattern that protocol 2.0 has to stuff."""
    ids, values = list(goals), list(goals.values())
    packet = sync_write(register, ids, values)
    assert packet == by_the_maker(register, ids, values)
    assert parse_sync_write(packet) == (register.address, goals)


def test_a_packet_with_the_pattern_of_its_own_head_is_stuffed():
    """The sender of the maker's library forgets what its own stuffing returns; both are right."""
    register = Register("dynamixel", 2, 116, 4)
    values = [0x00FDFFFF, 0xFDFFFF]
    packet = sync_write(register, [1, 2], values)
    plain = by_the_maker(register, [1, 2], values)
    handler: Any = Protocol2PacketHandler()
    stuffed = handler.addStuffing(list(plain))
    crc = handler.updateCRC(0, stuffed, len(stuffed) - 2)
    assert packet[:-2] == bytes(stuffed[:-2])
    assert packet[-2:] == crc.to_bytes(2, "little")
    assert packet.count(b"\xff\xff\xfd\xfd") == 2
    assert parse_sync_write(packet) == (116, dict(zip([1, 2], values, strict=True)))


@given(register=registers, goals=goals, place=st.integers(0, 1000), flip=st.integers(1, 255))
def test_a_damaged_packet_is_refused(
    register: Register, goals: dict[int, int], place: int, flip: int
):
    packet = bytearray(sync_write(register, list(goals), list(goals.values())))
    packet[place % len(packet)] ^= flip
    with pytest.raises(ValueError):
        parse_sync_write(bytes(packet))


@given(st.dictionaries(st.integers(1, 20), st.integers(0, 4095), min_size=1))
def test_a_packet_of_feetech_decodes_by_hand(goals: dict[int, int]):
    """STS takes the low byte first, SCS the high one; instruction 0x83 at address 42."""
    for model, order in (("STS3215", "<BH"), ("SCS0009", ">BH")):
        packet = sync_write(MODELS[model].register, list(goals), list(goals.values()))
        head, body = packet[:7], packet[7:-1]
        assert head == bytes([0xFF, 0xFF, 0xFE, 3 * len(goals) + 4, 0x83, 42, 2])
        assert dict(struct.iter_unpack(order, body)) == goals
        assert (sum(packet[2:]) & 0xFF) == 0xFF


def read_table(path: Path) -> tuple[dict[str, list[float]], list[str], np.ndarray]:
    """Figures in the remarks, names of the columns, and numbers, without code of mgs."""
    lines = path.read_text().splitlines()
    remarks = [line[1:].strip().split(",") for line in lines if line.startswith(COMMENT)]
    figures = {
        r[0]: [float(x) for x in r[1:]]
        for r in remarks
        if r[0] in ("id", "at_zero", "ticks_per_rad")
    }
    head, *rows = csv.reader(line for line in lines if not line.startswith(COMMENT))
    return figures, head, np.array(rows, dtype=float)


@pytest.mark.parametrize("model", ["AX-12", "MX-28", "XM430"])
def test_ticks_are_within_half_a_tick_of_the_plan(walk: Motion, model: str, tmp_path: Path):
    """The oracle computes each tick from the figures of the motors, in degrees."""
    motion = of_model(walk, model)
    export_motion(motion, tmp_path / "a.csv", "dynamixel")
    figures, head, table = read_table(tmp_path / "a.csv")
    assert head == ["time", *walk.robot.joint_names]
    assert figures["id"] == list(range(1, 20))
    assert np.allclose(table[:, 0], walk.times, rtol=0, atol=1e-9)
    per_turn, middle = (1228.8, 512) if model == "AX-12" else (4096, 2048)
    for k, name in enumerate(walk.robot.joint_names):
        spec = motion.robot.spec.motors[name]
        degrees = spec.sign * np.degrees(walk.q[:, 7 + k]) + np.degrees(spec.zero_offset)
        wanted = middle + degrees * per_turn / 360.0
        assert np.abs(table[:, 1 + k] - wanted).max() <= 0.5 + 1e-9
    back = (table[:, 1:] - figures["at_zero"]) / np.array(figures["ticks_per_rad"])
    assert np.abs(back - walk.q[:, 7:]).max() <= HALF_TICK[model] * (1 + 1e-9)
    recorded = FORMATS["dynamixel"].read(tmp_path / "a.csv")
    assert recorded.joint_names == walk.robot.joint_names
    assert np.allclose(recorded.joints, back, rtol=0, atol=1e-12)
    assert recorded.fps == pytest.approx(100.0)


@pytest.mark.parametrize("bits", [10, 12, 14])
@pytest.mark.parametrize("fps", [33.0, 125.0])
def test_any_resolution_and_any_rate_can_be_asked_for(
    walk: Motion, bits: int, fps: float, tmp_path: Path
):
    motors = {
        n: MotorSpec(id=k, ticks_per_turn=2.0**bits) for k, n in enumerate(walk.robot.joint_names)
    }
    options = Options(motors=motors, motors_file="motors.yaml")
    exported = export_motion(walk, tmp_path / "a.csv", "dynamixel", fps=fps, options=options)
    _, _, table = read_table(tmp_path / "a.csv")
    assert np.allclose(np.diff(table[:, 0]), 1.0 / fps, rtol=0, atol=2e-9)
    angles = (table[:, 1:] - 2 ** (bits - 1)) * 2.0 * np.pi / 2**bits
    assert np.abs(angles - exported.sampled.joints).max() <= np.pi / 2**bits * (1 + 1e-9)


@pytest.mark.parametrize(
    ("model", "fmt"), [("MX-28", "dynamixel"), ("XM430", "dynamixel"), ("STS3215", "feetech")]
)
def test_the_packets_of_a_walk_hold_its_ticks(walk: Motion, model: str, fmt: str, tmp_path: Path):
    motion = of_model(walk, model)
    export_motion(motion, tmp_path / "ticks.csv", fmt)
    export_motion(motion, tmp_path / "packets.csv", f"{fmt}-sync")
    _, _, table = read_table(tmp_path / "ticks.csv")
    head, *rows = (tmp_path / "packets.csv").read_text().splitlines()
    assert head == "time,packet" and len(rows) == walk.n_samples
    register = MODELS[model].register
    for k in range(0, len(rows), 50):
        time, _, packet = rows[k].partition(",")
        assert float(time) == pytest.approx(walk.times[k], abs=1e-9)
        ids, ticks = list(range(1, 20)), table[k, 1:].astype(int).tolist()
        assert bytes.fromhex(packet) == by_the_maker(register, ids, ticks)
    recorded = FORMATS[f"{fmt}-sync"].read(tmp_path / "packets.csv", motion.robot)
    assert np.abs(recorded.joints - walk.q[:, 7:]).max() <= np.pi / 4096 * (1 + 1e-9)


def test_motors_with_other_registers_have_packets_of_their_own(walk: Motion, tmp_path: Path):
    """Legs of protocol 1.0 and arms of protocol 2.0, as on a bus of both kinds."""
    motors = motors_of_melson(walk.robot) | {
        name: MotorSpec(id=40 + k, model="XL-320")
        for k, name in enumerate(walk.robot.joint_names)
        if "elbow" in name
    }
    options = Options(motors=motors, motors_file="motors.yaml")
    export_motion(walk, tmp_path / "a.csv", "dynamixel-sync", options=options)
    _, *rows = (tmp_path / "a.csv").read_text().splitlines()
    assert len(rows) == 2 * walk.n_samples
    packets = [bytes.fromhex(row.partition(",")[2]) for row in rows[:2]]
    found = [parse_sync_write(packet) for packet in packets]
    assert {len(goals) for _, goals in found} == {17, 2}
    assert [packet[:4] == b"\xff\xff\xfd\x00" for packet in packets].count(True) == 1


def test_a_negative_goal_has_the_form_of_its_maker():
    """Two's complement of a Dynamixel servo, sign and magnitude of a Feetech one."""
    dynamixel = sync_write(Register("dynamixel", 2, 116, 4), [1], [-5])
    assert dynamixel == by_the_maker(Register("dynamixel", 2, 116, 4), [1], [-5])
    feetech = sync_write(MODELS["STS3215"].register, [1], [-5])
    assert feetech[8:10] == (0x8000 | 5).to_bytes(2, "little")


def test_what_lacks_a_motor_a_register_or_the_right_maker_is_refused(walk: Motion, tmp_path: Path):
    with pytest.raises(ConfigError, match="no motor given for left_hip_yaw"):
        export_motion(walk, tmp_path / "a.csv", "dynamixel")
    with pytest.raises(ConfigError, match="a motor of feetech; use the format feetech"):
        export_motion(of_model(walk, "STS3215"), tmp_path / "a.csv", "dynamixel")
    motors = {
        n: MotorSpec(id=k, ticks_per_turn=4096.0) for k, n in enumerate(walk.robot.joint_names)
    }
    options = Options(motors=motors, motors_file="motors.yaml")
    with pytest.raises(
        ConfigError, match=r"motors.yaml: motors.left_hip_yaw: the register of its goal"
    ):
        export_motion(walk, tmp_path / "a.csv", "dynamixel-sync", options=options)
    narrow = {
        name: spec.model_copy(update={"ticks": [2000, 2100]}) for name, spec in motors.items()
    }
    with pytest.raises(MgsError, match=r"would have to go to tick \d+ .* ticks 2000 to 2100"):
        export_motion(walk, tmp_path / "a.csv", "dynamixel", options=Options(motors=narrow))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time,a\n0.0,1\n", "at_zero is missing"),
        ("# at_zero,1\n# ticks_per_rad,0\n# id,1\ntime,a\n0,1\n", "ticks_per_rad is 0"),
        ("# at_zero,x\ntime,a\n0,1\n", "at_zero should be numbers"),
        ("# at_zero,1\n# ticks_per_rad,1\nangle,a\n0,1\n", "the first column should be time"),
        ("# at_zero,1,2\n# ticks_per_rad,1\ntime,a\n0,1\n", "at_zero has the shape"),
        ("# at_zero,1\n# ticks_per_rad,1\n# id,1\ntime,a\n0,nan\n", "not finite"),
        ("#", "no line of numbers"),
        ("", "no line of numbers"),
    ],
)
def test_a_damaged_table_is_refused(text: str, message: str, tmp_path: Path):
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(MotionFileError, match=message):
        FORMATS["dynamixel"].read(path)


def test_a_table_of_packets_needs_a_robot_with_the_same_motors(walk: Motion, tmp_path: Path):
    motion = of_model(walk, "MX-28")
    path = tmp_path / "a.csv"
    export_motion(motion, path, "dynamixel-sync")
    fmt = FORMATS["dynamixel-sync"]
    with pytest.raises(MotionFileError, match=r"name a robot whose robot.yaml has motors"):
        fmt.read(path, walk.robot)
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:5], lines[5][:-2] + "00"]))
    with pytest.raises(MotionFileError, match="packet 5: its checksum is wrong"):
        fmt.read(path, motion.robot)
    path.write_text(
        "\n".join([lines[0], f"0.0,{sync_write(MODELS['MX-28'].register, [1], [5]).hex()}"])
    )
    with pytest.raises(MotionFileError, match=r"the frame at 0 s is not of the motors"):
        fmt.read(path, motion.robot)


def test_the_front_door_takes_files_of_motors_and_of_one_robot(walk: Motion, tmp_path: Path):
    motors = "\n".join(
        f"  {name}: {{id: {k}, model: XM430}}" for k, name in enumerate(walk.robot.joint_names)
    )
    (tmp_path / "motors.yaml").write_text(f"mgs: 1\nmotors:\n{motors}\n")
    (tmp_path / "unit.yaml").write_text(
        "mgs: 1\nunit: number 7\nrobot: melson\njoints: {waist_yaw: {scale: 0.5}}\n"
    )
    files = {"motors": tmp_path / "motors.yaml", "unit": tmp_path / "unit.yaml"}
    found = mgs.export(walk, tmp_path / "a.csv", "dynamixel", **files)
    recorded = FORMATS["dynamixel"].read(found)
    j = walk.robot.joint_names.index("waist_yaw")
    assert np.abs(recorded.joints[:, j] - 2.0 * walk.q[:, 7 + j]).max() <= np.pi / 4096 * 1.001
    assert recorded.extra == {"ids": list(range(19))}
