"""feetech-sync: finished packets that write the goal positions of Feetech servos.

A head line `time,packet` and one line per packet: the time [s] at which it is to be sent, and its
bytes as hexadecimal digits. Motors with the same register share a packet; a bus of several kinds of
motors has several packets with the same time. Each is a Sync Write (0x83) of goal positions: the
program on the robot opens the port and writes the bytes. Ids, ticks and registers are those of
`motors` in robot.yaml, or of --motors FILE. Angles come back within half a tick. Lines that begin
with # are remarks. The table states no scale, so that reading it takes a robot with the motors.
"""

from __future__ import annotations

from pathlib import Path

from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written
from mgs.motion_file.formats.recorded import RecordedMotion
from mgs.motion_file.formats.robots.packets import read_packets, write_packets
from mgs.robot import Robot


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the table."""
    return write_packets(sampled, path, options, "feetech")


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the table, for a robot with these motors."""
    return read_packets(path, "feetech-sync", robot)
