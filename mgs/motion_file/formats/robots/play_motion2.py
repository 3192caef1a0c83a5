"""play-motion2: parameters of PAL Robotics' play_motion2 (TALOS, KANGAROO, TIAGo).

A parameter file of ROS 2 for the node /play_motion2, with one motion named after the file:
`joints`, `positions` [rad] as one flat list, frame by frame, `times_from_start` [s], and `meta`
with `name`, `usage` and `description`. All numbers have a decimal point, since the node refuses a
list that it does not take as doubles; they read back exactly. The player approaches the first frame
by itself, in a time that it chooses, and hands the frames to the active joint trajectory
controllers, without velocities: these interpolate linearly or by splines, as they are set. Start it
with `play_motion2 run NAME` or the action play_motion2.
"""

from __future__ import annotations

import re
from pathlib import Path

from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.plain.csv_table import rate_of
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.motion_file.formats.robots.flow_text import number, numbers, read_flow, text, texts
from mgs.motion_file.formats.robots.rest import refuse_cycle
from mgs.robot import Robot

NODE = "/play_motion2"


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the parameters."""
    refuse_cycle(sampled, "play-motion2", "its player ends a motion at rest")
    names, index = chosen_joints(sampled.robot, options, None)
    rows = ",\n  ".join(", ".join(map(number, row)) for row in sampled.joints[:, index])
    key = motion_key(sampled.motion.gait_name)
    about = "; ".join([sampled.motion.gait_name, *options.remarks])
    meta = f'{{"name": {text(key)}, "usage": "demo", "description": {text(about)}}}'
    path.write_text(
        f'{{"{NODE}": {{"ros__parameters": {{"motions": {{{text(key)}: {{\n'
        f'"joints": {texts(names)},\n"positions": [\n  {rows}],\n'
        f'"times_from_start": {numbers(sampled.times)},\n"meta": {meta}}}}}}}}}}}\n',
        encoding="utf-8",
    )
    return Written(names, notes=(f"name of the motion: {key}",))


def motion_key(name: str) -> str:
    """Name without points and slashes, which the node would take as levels of parameters."""
    return re.sub(r"\W+", "_", name).strip("_") or "motion"


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the parameters, which must be the only one in the file."""
    del robot  # the file names its joints
    reading, content = Reading(path), read_flow(path, "parameters of play_motion2")
    for level in (NODE, "ros__parameters", "motions"):
        content = content.get(level) if isinstance(content, dict) else None
    if not isinstance(content, dict) or len(content) != 1:
        raise reading.error(f"{NODE}: ros__parameters: motions: should have one motion")
    (found,) = content.values()
    if not isinstance(found, dict):
        raise reading.error("a motion should be a mapping")
    names = reading.names("joints", found.get("joints"))
    times = reading.array("times_from_start", found.get("times_from_start"), None)
    flat = reading.array("positions", found.get("positions"), len(times) * len(names))
    return RecordedMotion(
        layout="play-motion2",
        fps=rate_of(reading, times),
        joint_names=names,
        order=None,
        joints=flat.reshape(len(times), len(names)),
    )
