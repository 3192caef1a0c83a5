"""Tables of packets for a bus of motors."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.errors import ConfigError
from mgs.core.limits import MAX_SAMPLES
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.number_table import opened_text
from mgs.motion_file.formats.plain.csv_table import rate_of
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.motion_file.formats.robots.sync_write import MAX_PACKET_1, parse_sync_write, sync_write
from mgs.motion_file.formats.robots.ticks import DIGITS, motors_for
from mgs.robot import Motors, Robot, motors_of
from mgs.robot.motor_models import Maker, Register

HEAD = "time,packet"
BITS = 10  # of a byte on the bus


def write_packets(sampled: SampledMotion, path: Path, options: Options, maker: Maker) -> Written:
    """Write the table; see mgs.motion_file.formats.robots.dynamixel_sync for its layout.

    Raises:
        ConfigError: the register of a motor is not known, or too many share one packet.
    """
    motors = motors_for(sampled, options, maker)
    names, index = chosen_joints(sampled.robot, options, None)
    groups = _by_register(motors, options.motors_source(sampled.robot))
    ticks = motors.to_ticks(sampled.joints[:, index])
    most = 0
    with path.open("w", encoding="utf-8", newline="") as stream:
        stream.writelines(f"# {line}\n" for line in options.remarks)
        stream.write(f"{HEAD}\n")
        for time, row in zip(np.round(sampled.times, DIGITS).tolist(), ticks.tolist(), strict=True):
            size = 0
            for register, members in groups.items():
                ids, values = [motors.ids[j] for j in members], [row[j] for j in members]
                packet = sync_write(register, ids, values)
                stream.write(f"{time},{packet.hex()}\n")
                size += len(packet)
            most = max(most, size)
    baud = most * BITS / sampled.interval
    note = f"{most} bytes a frame: a bus of at least {baud:.0f} baud carries them at this rate"
    return Written(names, notes=(note,))


def _by_register(motors: Motors, source: str) -> dict[Register, list[int]]:
    """Numbers of the joints whose goals go into one packet, by their register."""
    groups: dict[Register, list[int]] = {}
    for j, (name, register) in enumerate(zip(motors.joint_names, motors.registers, strict=True)):
        if register is None:
            raise ConfigError(
                source, f"motors.{name}: the register of its goal is not known; add goal"
            )
        groups.setdefault(register, []).append(j)
    for register, members in groups.items():
        if register.protocol == 1 and len(members) * (register.width + 1) > MAX_PACKET_1:
            raise ConfigError(source, f"motors: {len(members)} motors do not fit into one packet")
    return groups


def read_packets(path: Path, layout: str, robot: Robot | None) -> RecordedMotion:
    """Motion of a table of packets.

    Raises:
        ConfigError: the file is missing, or the robot is not known or has other motors.
        MotionFileError: the table or a packet in it is damaged.
    """
    reading = Reading(path)
    if robot is None or not robot.spec.motors:
        raise reading.error("packets have no scale; name a robot whose robot.yaml has motors")
    motors = motors_of(robot.spec.motors, robot.joint_names, robot.source)
    registers = dict(zip(motors.ids, motors.registers, strict=True))
    frames: dict[float, dict[int, int]] = {}
    with opened_text(path) as stream:
        lines = (line.strip() for line in stream if not line.startswith("#"))
        if next(lines, "") != HEAD:
            raise reading.error(f"its first line should be {HEAD}")
        for number, line in enumerate(lines, start=1):
            try:
                time, _, text = line.partition(",")
                packet = bytes.fromhex(text)
                _, found = parse_sync_write(packet, _is_big_endian(registers, packet))
                frames.setdefault(float(time), {}).update(found)
            except ValueError as error:
                raise reading.error(f"packet {number}: {error}") from error
            if len(frames) > MAX_SAMPLES:
                raise reading.error(f"more than {MAX_SAMPLES} frames")
    if unlike := [t for t, found in frames.items() if set(found) != set(motors.ids)]:
        raise reading.error(f"the frame at {unlike[0]:g} s is not of the motors of {robot.source}")
    ticks = [[_signed(found[i], registers[i]) for i in motors.ids] for found in frames.values()]
    return RecordedMotion(
        layout=layout,
        fps=rate_of(reading, np.array(list(frames))),
        joint_names=motors.joint_names,
        order=None,
        joints=motors.to_angles(np.array(ticks, dtype=np.int64).reshape(-1, len(motors.ids))),
    )


def _is_big_endian(registers: dict[int, Register | None], packet: bytes) -> bool:
    """Whether the first motor of a packet takes the high byte first."""
    register = registers.get(packet[7]) if len(packet) > 7 else None
    return register is not None and register.big_endian


def _signed(value: int, register: Register | None) -> int:
    if register is None:
        return value
    half = 1 << (8 * register.width - 1)
    if value < half:
        return value
    return half - value if register.maker == "feetech" else value - 2 * half
