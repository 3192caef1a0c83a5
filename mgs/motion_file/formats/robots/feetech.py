"""feetech: goal positions of Feetech servos in ticks, as a text table.

The layout is that of the format dynamixel (`mgs export --layout dynamixel`), for motors whose model
is one of Feetech, such as STS3215. A program on the robot writes each line to the goal positions
(address 42) at its time, by one Sync Write; feetech-sync has the finished packets.
"""

from __future__ import annotations

from pathlib import Path

from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written
from mgs.motion_file.formats.recorded import RecordedMotion
from mgs.motion_file.formats.robots.ticks import read_ticks, write_ticks
from mgs.robot import Robot


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the table."""
    return write_ticks(sampled, path, options, "feetech")


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the table."""
    del robot  # the table names its joints
    return read_ticks(path, "feetech")
