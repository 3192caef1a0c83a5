"""Pages of an action file of ROBOTIS OP3, as bytes.

A file has 256 pages of 512 bytes: a header of 64 bytes and 7 steps of 64 bytes. Header: name (14),
reserved, repeat, schedule (0x0A: the time of a step counts), 3 reserved, number of steps, reserved,
speed (32: as it is), reserved, accel [cycles], next page, exit page, 4 reserved, checksum (all
bytes of the page add up to 0xFF modulo 256), 31 gains, reserved. Step: 31 positions of two bytes,
low byte first, by the id of the motor, then pause and time [cycles]. A position with the bit 0x4000
is left as it is.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

PAGES, STEPS, JOINTS = 256, 7, 31
PAGE, HEAD = 512, 64  # [bytes]
NAME = 13  # [bytes] of a name, besides the zero behind it
TIME_BASE, GAIN = 0x0A, 0x55
INVALID = 0x4000
HEADER = struct.Struct("<14sxBB3xBxBxBBB4xB31sx")
STEP = struct.Struct("<31HBB")


@dataclass(frozen=True)
class PageStep:
    """One keyframe: tick by id, and pause and time [cycles]."""

    positions: Mapping[int, int]
    time: int
    pause: int = 0


@dataclass(frozen=True)
class Page:
    """Up to 7 steps, and the page that follows; 0: none."""

    name: str
    steps: Sequence[PageStep]
    next: int = 0
    exit: int = 0
    repeat: int = 1
    speed: int = 32
    accel: int = 2
    schedule: int = TIME_BASE


def file_bytes(pages: Mapping[int, Page]) -> bytes:
    """Content of a file with some pages, by number; all others are empty."""
    empty = page_bytes(Page("", (), accel=32))
    return b"".join(page_bytes(pages[k]) if k in pages else empty for k in range(PAGES))


def page_bytes(page: Page) -> bytes:
    """512 bytes of a page."""
    steps = [*page.steps, *[PageStep({}, 0)] * (STEPS - len(page.steps))]
    body = b"".join(
        STEP.pack(*(s.positions.get(j, INVALID) for j in range(JOINTS)), s.pause, s.time)
        for s in steps
    )
    name = page.name.encode("ascii", "replace")[:NAME]

    def header(checksum: int) -> bytes:
        return HEADER.pack(
            name, page.repeat, page.schedule, len(page.steps), page.speed, page.accel, page.next,
            page.exit, checksum, bytes([GAIN] * JOINTS),
        )  # fmt: skip

    rest = sum(header(0)) + sum(body)
    return header((0xFF - rest) & 0xFF) + body


def parse_page(data: bytes) -> Page | None:
    """Page of 512 bytes; None if its checksum is wrong, in which case the robot empties it."""
    if sum(data) & 0xFF != 0xFF:
        return None
    name, repeat, schedule, count, speed, accel, following, leaving, _, _ = HEADER.unpack(
        data[:HEAD]
    )
    steps = []
    for k in range(min(count, STEPS)):
        *positions, pause, time = STEP.unpack_from(data, HEAD + k * STEP.size)
        given = {j: tick for j, tick in enumerate(positions) if not tick & INVALID}
        steps.append(PageStep(given, time, pause))
    return Page(
        name=name.split(b"\0")[0].decode("ascii", "replace"),
        steps=tuple(steps),
        next=following,
        exit=leaving,
        repeat=repeat,
        speed=speed,
        accel=accel,
        schedule=schedule,
    )
