"""Packets that write the goal positions of several motors at once, and what they hold.

Instruction Sync Write (0x83) to the broadcast id 0xFE, with the address, the length and then id and
data of each motor. Protocol 1.0 (Feetech too): FF FF FE LENGTH 83 ADDRESS WIDTH (ID DATA)... SUM,
where SUM makes the bytes from FE on add up to 0xFF modulo 256. Protocol 2.0: FF FF FD 00 FE LENGTH
83 ADDRESS WIDTH (ID DATA)... CRC, all numbers of two bytes, an FD after each FF FF FD in the body,
and a CRC-16 of polynomial 0x8005 over everything before it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from mgs.robot.motor_models import Register

Endian = Literal["little", "big"]

INSTRUCTION, BROADCAST = 0x83, 0xFE
HEAD_1, HEAD_2 = b"\xff\xff", b"\xff\xff\xfd\x00"
STUFFED = b"\xff\xff\xfd"
MAX_PACKET_1 = 250  # [bytes] of parameters, whose length is one byte


def _crc_table() -> tuple[int, ...]:
    table = []
    for byte in range(256):
        crc = byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ 0x8005 if crc & 0x8000 else crc << 1
        table.append(crc & 0xFFFF)
    return tuple(table)


CRC_TABLE = _crc_table()


def sync_write(register: Register, ids: Sequence[int], values: Sequence[int]) -> bytes:
    """Packet that writes one value to the goal position of each motor.

    Args:
        register: where the values go; the same for all motors.
        ids: of the motors.
        values: ticks; negative ones as two's complement, or with the sign in the highest bit of
            Feetech servos.
    """
    order: Endian = "big" if register.big_endian else "little"
    body = b"".join(
        bytes([number]) + _bits(register, value).to_bytes(register.width, order)
        for number, value in zip(ids, values, strict=True)
    )
    if register.protocol == 1:
        head = bytes([register.address, register.width])
        inside = bytes([BROADCAST, len(body) + 4, INSTRUCTION]) + head + body
        return HEAD_1 + inside + bytes([~sum(inside) & 0xFF])
    parameters = register.address.to_bytes(2, "little") + register.width.to_bytes(2, "little")
    stuffed = (bytes([INSTRUCTION]) + parameters + body).replace(STUFFED, STUFFED + b"\xfd")
    packet = HEAD_2 + bytes([BROADCAST]) + (len(stuffed) + 2).to_bytes(2, "little") + stuffed
    return packet + crc16(packet).to_bytes(2, "little")


def _bits(register: Register, value: int) -> int:
    bits = 8 * register.width
    if value < 0 and register.maker == "feetech":
        return (1 << (bits - 1)) | -value
    return value & ((1 << bits) - 1)


def crc16(data: bytes) -> int:
    """Checksum of protocol 2.0."""
    crc = 0
    for byte in data:
        crc = ((crc << 8) & 0xFFFF) ^ CRC_TABLE[(crc >> 8) ^ byte]
    return crc


def parse_sync_write(packet: bytes, big_endian: bool = False) -> tuple[int, dict[int, int]]:
    """Address and unsigned values by id of a packet.

    Raises:
        ValueError: it is no Sync Write, cut off, or its checksum is wrong.
    """
    if packet[:4] == HEAD_2:
        body, size = _body_of_2(packet), 2
    else:
        body, size = _body_of_1(packet), 1
    address = int.from_bytes(body[:size], "little")
    width = int.from_bytes(body[size : 2 * size], "little")
    data = body[2 * size :]
    if width not in (1, 2, 4) or len(data) % (width + 1):
        raise ValueError("its length is not that of whole motors")
    order: Endian = "big" if big_endian else "little"
    found = {
        data[k]: int.from_bytes(data[k + 1 : k + 1 + width], order)
        for k in range(0, len(data), width + 1)
    }
    return address, found


def _body_of_1(packet: bytes) -> bytes:
    if len(packet) < 8 or packet[:3] != HEAD_1 + bytes([BROADCAST]) or packet[4] != INSTRUCTION:
        raise ValueError("it is no Sync Write")
    if packet[3] != len(packet) - 4:
        raise ValueError("its length is wrong")
    if sum(packet[2:]) & 0xFF != 0xFF:
        raise ValueError("its checksum is wrong")
    return packet[5:-1]


def _body_of_2(packet: bytes) -> bytes:
    if len(packet) < 14 or packet[4] != BROADCAST or packet[7] != INSTRUCTION:
        raise ValueError("it is no Sync Write")
    if int.from_bytes(packet[5:7], "little") != len(packet) - 7:
        raise ValueError("its length is wrong")
    if int.from_bytes(packet[-2:], "little") != crc16(packet[:-2]):
        raise ValueError("its checksum is wrong")
    return packet[7:-2].replace(STUFFED + b"\xfd", STUFFED)[1:]
