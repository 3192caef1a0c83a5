"""naoqi: lists for ALMotion.angleInterpolation of NAO and Pepper.

JSON with `names`, `angleLists` (one list of angles [rad] for each name), `timeLists` (one list of
times [s] for each name) and `isAbsolute` (true). Numbers read back exactly. ALMotion takes no time
of 0: the first frame is reached after the approach (--approach, 2 s unless it is given), from the
posture that the robot is in; `approach` states it. The names have to be those of the robot, such as
LHipPitch. On the robot:

    d = json.load(open("walk.json"))
    motion.angleInterpolation(d["names"], d["angleLists"], d["timeLists"], d["isAbsolute"])
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.plain.csv_table import rate_of
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.motion_file.formats.recorded import numbers as as_numbers
from mgs.motion_file.formats.robots.flow_text import (
    entries,
    number,
    numbers,
    read_flow,
    text,
    texts,
)
from mgs.robot import Robot


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the lists."""
    names, index = chosen_joints(sampled.robot, options, None)
    times = numbers(options.approach + sampled.times)
    angles = entries(numbers(column) for column in sampled.joints[:, index].T)
    about = "; ".join([sampled.motion.gait_name, *options.remarks])
    path.write_text(
        f'{{"about": {text(about)},\n"names": {texts(names)},\n"angleLists": {angles},\n'
        f'"timeLists": {entries(times for _ in names)},\n"isAbsolute": true,\n'
        f'"approach": {number(options.approach)}}}\n',
        encoding="utf-8",
    )
    return Written(names, notes=(f"the first frame is reached after {options.approach:g} s",))


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the lists, whose joints must have the same times."""
    del robot  # the file names its joints
    reading, content = Reading(path), read_flow(path, "lists for ALMotion")
    if not isinstance(content, dict):
        raise reading.error("it should have the keys names, angleLists and timeLists")
    names = reading.names("names", content.get("names"))
    joints = _by_frame(reading, content, "angleLists", len(names))
    times = _by_frame(reading, content, "timeLists", len(names))
    if len(times) != len(joints) or np.ptp(times, axis=1).max() > 0.0:
        raise reading.error("the joints have different times; they cannot be read as frames")
    return RecordedMotion(
        layout="naoqi",
        fps=rate_of(reading, times[:, 0]),
        joint_names=names,
        order=None,
        joints=joints,
    )


def _by_frame(reading: Reading, content: dict[str, Any], key: str, width: int) -> Array:
    """Numbers (T, width) of the lists of a key, one list for each joint."""
    found = as_numbers(content.get(key))
    return reading.array(key, None if found is None else found.T, None, width)
