"""A simulated line of Dynamixel servos on a pseudo terminal, in a process of its own.

    with simulated_bus(tmp_path, Setting(servos=(1, 2, 3), lose=0.05)) as bus:
        ...  # open bus.port with any driver
        bus.goals(1)  # what servo 1 was told, decoded here

Servos have a control table of 256 bytes and follow their goal with a first-order lag. Faults are
drawn with a fixed seed. Every write that a servo has understood is in the log, with the time of
time.monotonic, which processes of one computer share.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import random
import select
import subprocess
import sys
import time
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path

from tests.support import dynamixel_packets as wire

ROOT = Path(__file__).parents[2]
BAUD = 1_000_000  # [bit/s] of the simulated line


@dataclass(frozen=True)
class Setting:
    protocol: int = 2
    servos: tuple[int, ...] = (1, 2, 3)
    model: int = 1020  # XM430-W350; 29: MX-28, 350: XL-320
    start: dict[str, int] = field(default_factory=dict)  # position by id [ticks]; else the middle
    registers: dict[str, int] = field(default_factory=dict)  # "id:address:size" to value
    lag: float = 0.03  # [s] of the first-order response
    lose: float = 0.0  # part of the packets, either way
    corrupt: float = 0.0
    silent: dict[str, float] = field(default_factory=dict)  # id: time after the first goal [s]
    overload: dict[str, float] = field(default_factory=dict)
    load: dict[str, int] = field(default_factory=dict)  # register value by id
    return_delay: float = 2e-5  # [s]
    status_level: int = 2
    seed: int = 1


@dataclass(frozen=True)
class Write:
    time: float  # time.monotonic [s]
    servo: int
    address: int
    data: bytes

    @property
    def value(self) -> int:
        return int.from_bytes(self.data, "little", signed=len(self.data) == 4)


class Addresses:
    """Where the simulated servos keep things."""

    def __init__(self, protocol: int, model: int) -> None:
        if protocol == 2 and model != 350:
            self.torque, self.goal, self.present, self.load = (64, 1), (116, 4), (132, 4), (126, 2)
            self.hardware_error, self.middle = (70, 1), 2048
            self.initial = {(11, 1): 3, (48, 4): 4095, (52, 4): 0, (144, 2): 120, (9, 1): 10}
        elif protocol == 2:
            self.torque, self.goal, self.present, self.load = (24, 1), (30, 2), (37, 2), (41, 2)
            self.hardware_error, self.middle = (50, 1), 512
            self.initial = {(11, 1): 2, (6, 2): 0, (8, 2): 1023, (45, 1): 74, (5, 1): 10}
        else:
            self.torque, self.goal, self.present, self.load = (24, 1), (30, 2), (36, 2), (40, 2)
            self.hardware_error, self.middle = None, 2048 if model in (29, 310, 320) else 512
            top = 2 * self.middle - 1
            self.initial = {(6, 2): 0, (8, 2): top, (42, 1): 120, (5, 1): 10}


class Servo:
    def __init__(self, number: int, setting: Setting, places: Addresses) -> None:
        self.number, self.lag, self.places = number, setting.lag, places
        self.table = bytearray(256)
        self.put((0, 2), setting.model)
        for place, value in places.initial.items():
            self.put(place, value)
        self.at = float(setting.start.get(str(number), places.middle))
        self.put(places.goal, places.middle)
        self.put(places.load, setting.load.get(str(number), 0))
        self.moved = time.monotonic()
        for key, value in setting.registers.items():
            servo, address, size = map(int, key.split(":"))
            if servo == number:
                self.put((address, size), value)

    def put(self, place: tuple[int, int], value: int) -> None:
        address, size = place
        self.table[address : address + size] = (value % (1 << (8 * size))).to_bytes(size, "little")

    def get(self, place: tuple[int, int]) -> int:
        return int.from_bytes(self.table[place[0] : place[0] + place[1]], "little")

    def move(self) -> None:
        now = time.monotonic()
        if self.get(self.places.torque):
            goal = self.get(self.places.goal)
            self.at = goal + (self.at - goal) * math.exp(-(now - self.moved) / self.lag)
        self.moved = now
        self.put(self.places.present, round(self.at))


class Line:
    """The servos of a line and the faults of its packets."""

    def __init__(self, setting: Setting, log: Path) -> None:
        self.setting, self.random = setting, random.Random(setting.seed)
        self.places = Addresses(setting.protocol, setting.model)
        self.servos = {number: Servo(number, setting, self.places) for number in setting.servos}
        self.parser = wire.Parser(setting.protocol)
        self.first_goal: float | None = None
        self.log = log.open("w")

    def damaged(self, data: bytes) -> bytes:
        """The packet after its way along the line: as it was, with another byte, or nothing."""
        draw = self.random.random()
        if draw < self.setting.lose:
            return b""
        if draw < self.setting.lose + self.setting.corrupt:
            at = self.random.randrange(len(data))
            return data[:at] + bytes([data[at] ^ (1 << self.random.randrange(8))]) + data[at + 1 :]
        return data

    def receive(self, data: bytes) -> bytes:
        answers = b""
        for sent in self.apart(data):
            for packet in self.parser.feed(self.damaged(sent)):
                answers += self.answer(packet)
        return answers

    def apart(self, data: bytes) -> list[bytes]:
        """Packets that were read together: each of them has its own fate."""
        header = b"\xff\xff\xfd\x00" if self.setting.protocol == 2 else b"\xff\xff"
        rest, *packets = data.split(header)
        return [sent for sent in (rest, *(header + packet for packet in packets)) if sent]

    def since(self, times: dict[str, float], servo: int) -> bool:
        after = times.get(str(servo))
        if after is None or self.first_goal is None:
            return False
        return time.monotonic() - self.first_goal >= after

    def answer(self, packet: wire.Packet) -> bytes:
        two = self.setting.protocol == 2
        p, width = packet.parameters, 2 if two else 1
        if packet.instruction == wire.SYNC_WRITE:
            address, size = (int.from_bytes(p[i : i + width], "little") for i in (0, width))
            rows = p[2 * width :]
            for i in range(0, len(rows), 1 + size):
                self.write(rows[i], address, rows[i + 1 : i + 1 + size])
            return b""
        if packet.instruction == wire.SYNC_READ and two:
            address, size = (int.from_bytes(p[i : i + 2], "little") for i in (0, 2))
            answers = b""
            for number in p[4:]:
                if number not in self.servos or self.since(self.setting.silent, number):
                    break  # those behind it wait for its answer
                answers += self.damaged(self.status(number, self.read(number, address, size)))
            return answers
        number = packet.servo
        if number not in self.servos or self.since(self.setting.silent, number):
            return b""
        if packet.instruction == wire.PING:
            found = self.read(number, 0, 2) + bytes([50]) if two else b""
            return self.damaged(self.status(number, found))
        if packet.instruction == wire.READ and self.setting.status_level > 0:
            address, size = (int.from_bytes(p[i : i + width], "little") for i in (0, width))
            return self.damaged(self.status(number, self.read(number, address, size)))
        if packet.instruction == wire.WRITE:
            self.write(number, int.from_bytes(p[:width], "little"), p[width:])
            if self.setting.status_level == 2:
                return self.damaged(self.status(number, b""))
        return b""

    def status(self, number: int, data: bytes) -> bytes:
        error = 0
        if self.since(self.setting.overload, number):
            error = 0x80 if self.setting.protocol == 2 else 0x20
            if self.places.hardware_error:
                self.servos[number].put(self.places.hardware_error, 0x20)
        return wire.status(self.setting.protocol, number, error, data)

    def read(self, number: int, address: int, size: int) -> bytes:
        self.servos[number].move()
        return bytes(self.servos[number].table[address : address + size])

    def write(self, number: int, address: int, data: bytes) -> None:
        if number not in self.servos or self.since(self.setting.silent, number):
            return
        now, servo = time.monotonic(), self.servos[number]
        servo.move()
        servo.table[address : address + len(data)] = data
        told = address == self.places.goal[0] and servo.get(self.places.torque)
        if told and self.first_goal is None:  # without torque, goals are only put in place
            self.first_goal = now
        self.log.write(json.dumps([now, number, address, data.hex()]) + "\n")
        self.log.flush()


def serve(setting: Setting, log: Path) -> None:
    """Answer until the process is ended; prints the name of the port first."""
    master, slave = os.openpty()
    tty.setraw(slave)
    sys.stdout.write(os.ttyname(slave) + "\n")
    sys.stdout.flush()
    line = Line(setting, log)
    with contextlib.suppress(PermissionError):  # real servos do not wait for a busy computer
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))
    while True:
        select.select([master], [], [])
        data = os.read(master, 4096)
        answers = line.receive(data)
        if answers:
            time.sleep(10.0 * (len(data) + len(answers)) / BAUD + setting.return_delay)
            os.write(master, answers)


@dataclass(eq=False)
class SimulatedBus:
    port: str
    log: Path
    places: Addresses
    process: subprocess.Popen[str]

    def writes(self) -> list[Write]:
        """All writes that servos understood, up to now."""
        rows = [json.loads(row) for row in self.log.read_text().splitlines()]
        return [Write(t, servo, address, bytes.fromhex(data)) for t, servo, address, data in rows]

    def wait_until_quiet(self) -> None:
        """Wait until the process has worked off what was sent to it."""
        before = -1
        while (size := self.log.stat().st_size) != before:
            before = size
            time.sleep(0.2)

    def goals(self, servo: int) -> list[Write]:
        """Goals of one servo."""
        return [w for w in self.writes() if (w.servo, w.address) == (servo, self.places.goal[0])]

    def torques(self, servo: int) -> list[Write]:
        """Writes of the torque enable of one servo."""
        return [w for w in self.writes() if (w.servo, w.address) == (servo, self.places.torque[0])]


@contextmanager
def simulated_bus(folder: Path, setting: Setting) -> Iterator[SimulatedBus]:
    """A line of servos that answers while this lasts."""
    log = folder / "bus.log"
    log.write_text("")
    command = [sys.executable, "-m", "tests.support.dynamixel_bus", json.dumps(asdict(setting))]
    process = subprocess.Popen([*command, str(log)], stdout=subprocess.PIPE, text=True, cwd=ROOT)
    assert process.stdout is not None
    try:
        port = process.stdout.readline().strip()
        assert port, "the simulated bus has not started"
        yield SimulatedBus(port, log, Addresses(setting.protocol, setting.model), process)
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


if __name__ == "__main__":
    given = json.loads(sys.argv[1])
    given["servos"] = tuple(given["servos"])
    serve(Setting(**given), Path(sys.argv[2]))
