"""dynamixel: goal positions of Dynamixel servos in ticks, as a text table.

Lines that begin with # state the ids of the motors (`id`), the tick, not rounded, at which each
joint is at 0 (`at_zero`), and the ticks per radian of the joint (`ticks_per_rad`, negative where
more ticks turn the joint back): joint angle [rad] = (tick - at_zero) / ticks_per_rad. Then comes a
head line `time,JOINT,...` and one line per frame: time [s] and a whole number of ticks for each
motor. Ids, directions, zeros and ticks of a turn (10, 12 or 14 bit, or any other number) are those
of `motors` in robot.yaml, or of --motors FILE. Angles come back within half a tick.

A program on the robot writes each line to the goal positions of the motors at its time, by one Sync
Write; dynamixel-sync has the finished packets.
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
    return write_ticks(sampled, path, options, "dynamixel")


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the table."""
    del robot  # the table names its joints
    return read_ticks(path, "dynamixel")
