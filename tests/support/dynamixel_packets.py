"""Packets of Dynamixel protocol 1.0 and 2.0, written from the maker's manuals for a simulated bus.

Protocol 1.0: FF FF id length instruction parameters checksum; length counts what follows it, the
checksum is the complement of the sum from id on. Protocol 2.0: FF FF FD 00 id length(2) instruction
parameters crc(2); CRC-16 with polynomial 0x8005 and start 0; within instruction and parameters an
FD is added behind FF FF FD.
"""

from __future__ import annotations

from dataclasses import dataclass

PING, READ, WRITE, SYNC_READ, SYNC_WRITE, STATUS = 0x01, 0x02, 0x03, 0x82, 0x83, 0x55
BROADCAST = 0xFE


@dataclass(frozen=True)
class Packet:
    servo: int
    instruction: int  # of a status packet of protocol 1.0: its error byte
    parameters: bytes


def crc16(data: bytes) -> int:
    crc = 0
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = ((crc << 1) ^ 0x8005 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def checksum(body: bytes) -> int:
    return ~sum(body) & 0xFF


def stuffed(body: bytes) -> bytes:
    return body.replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")


def unstuffed(body: bytes) -> bytes:
    return body.replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")


def encode(protocol: int, servo: int, instruction: int, parameters: bytes) -> bytes:
    if protocol == 1:
        body = bytes([servo, len(parameters) + 2, instruction]) + parameters
        return b"\xff\xff" + body + bytes([checksum(body)])
    content = stuffed(bytes([instruction]) + parameters)
    head = b"\xff\xff\xfd\x00" + bytes([servo]) + (len(content) + 2).to_bytes(2, "little")
    return head + content + crc16(head + content).to_bytes(2, "little")


def status(protocol: int, servo: int, error: int, parameters: bytes) -> bytes:
    if protocol == 1:
        return encode(1, servo, error, parameters)
    return encode(2, servo, STATUS, bytes([error]) + parameters)


class Parser:
    """Packets out of a stream of bytes; damaged ones are counted and dropped."""

    def __init__(self, protocol: int) -> None:
        self.protocol, self.damaged, self._data = protocol, 0, b""

    def feed(self, data: bytes) -> list[Packet]:
        self._data += data
        packets = []
        while (found := self._next()) is not None:
            if isinstance(found, Packet):
                packets.append(found)
            else:
                self.damaged += 1
        return packets

    def _next(self) -> Packet | bool | None:
        """A packet, False for a damaged one, None: more bytes are needed."""
        header = b"\xff\xff" if self.protocol == 1 else b"\xff\xff\xfd\x00"
        start = self._data.find(header)
        if start < 0:
            self._data = self._data[-3:]
            return None
        self._data = self._data[start:]
        fixed = 4 if self.protocol == 1 else 7
        if len(self._data) < fixed:
            return None
        count = self._data[3:4] if self.protocol == 1 else self._data[5:7]
        length = int.from_bytes(count, "little")
        if not (2 if self.protocol == 1 else 3) <= length <= 1000:  # a damaged length
            self._data = self._data[1:]
            return False
        if len(self._data) < fixed + length:
            return None
        whole, rest = self._data[: fixed + length], self._data[fixed + length :]
        if self.protocol == 1:
            good = whole[-1] == checksum(whole[2:-1])
            packet = Packet(whole[2], whole[4], whole[5:-1])
        else:
            good = int.from_bytes(whole[-2:], "little") == crc16(whole[:-2])
            content = unstuffed(whole[7:-2])
            packet = Packet(whole[4], content[0] if content else 0, content[1:])
        if not good:
            self._data = self._data[1:]
            return False
        self._data = rest
        return packet
