"""feetech-sync: finished packets that write the goal positions of Feetech servos.

The layout is that of the format dynamixel-sync (`mgs export --layout dynamixel-sync`), for motors
whose model is one of Feetech. Goal positions are at address 42; servos of the series SCS take the
high byte first. Packets have the form of Dynamixel's protocol 1.0.
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
