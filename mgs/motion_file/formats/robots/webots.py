"""webots: a .motion file of the simulator Webots.

A head line `#WEBOTS_MOTION,V1.0,JOINT,...`, then one line per frame: the time as
minutes:seconds:milliseconds, a name `Pose1`, `Pose2`, ..., and the angle of each motor [rad].
Angles read back exactly, times in whole milliseconds. The names have to be those of the motors in
the PROTO of the robot. The player of Webots interpolates linearly; of a cycle the last frame is the
first one again, for a motion that is set to loop.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.number_table import opened_text
from mgs.motion_file.formats.plain.csv_table import rate_of
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.motion_file.formats.robots.milliseconds import whole_milliseconds
from mgs.robot import Robot

HEAD = ["#WEBOTS_MOTION", "V1.0"]


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the motion."""
    names, index = chosen_joints(sampled.robot, options, None)
    times = whole_milliseconds(sampled.times, sampled.interval)
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([*HEAD, *names])
        for k, (time, row) in enumerate(zip(times, sampled.joints[:, index].tolist(), strict=True)):
            writer.writerow([_clock(time), f"Pose{k + 1}", *row])
    return Written(names)


def _clock(milliseconds: int) -> str:
    minutes, rest = divmod(milliseconds, 60_000)
    return f"{minutes:02d}:{rest // 1000:02d}:{rest % 1000:03d}"


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the file; its lines may lack the names of the poses."""
    del robot  # the file names its joints
    reading, times, rows = Reading(path), [], []
    with opened_text(path) as stream:
        lines = csv.reader(stream)
        head = next(lines, [])
        if head[:2] != HEAD:
            raise reading.error(f"its first line should begin with {','.join(HEAD)}")
        names = reading.names("the list of motors", head[2:])
        for line in lines:
            if line:
                times.append(_seconds(reading, lines.line_num, line[0]))
                rows.append(_angles(reading, lines.line_num, line, len(names)))
    joints = reading.array("angles", rows, None, len(names))
    return RecordedMotion(
        layout="webots",
        fps=rate_of(reading, np.array(times)),
        joint_names=names,
        order=None,
        joints=joints,
    )


def _seconds(reading: Reading, number: int, text: str) -> float:
    parts = text.split(":")
    if len(parts) != 3 or not all(part.isascii() and part.isdigit() for part in parts):
        raise reading.error(f"line {number}: the time should be minutes:seconds:milliseconds")
    minutes, seconds, milliseconds = (int(part[:9]) for part in parts)
    return 60.0 * minutes + seconds + 1e-3 * milliseconds


def _angles(reading: Reading, number: int, line: list[str], width: int) -> list[float]:
    cells = line[-width:] if len(line) in (width + 1, width + 2) else []
    try:
        return [float(cell) for cell in cells or line]
    except ValueError as error:
        raise reading.error(f"line {number}: it should have {width} angles") from error
