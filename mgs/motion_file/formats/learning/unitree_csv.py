"""unitree-csv: base and joints in a table without a head line.

The layout of the "LAFAN1 retargeted" motions, which whole_body_tracking, unitree_rl_lab, mjlab and
booster_train read. One line per frame, separated by commas:

    x, y, z         position of the root link in the world [m]
    qx, qy, qz, qw  its orientation; the scalar part comes last
    joints          angles [rad], depth first

Neither the rate nor the names of the joints are in the file. Readers take 30 Hz unless they are
told (`--input_fps`), and have a list of joints of their own: compare it with the order that
`mgs export` prints, or give theirs (`--joints`).

Beware: files of ProtoMotions and Kimodo have as many columns, but the scalar part of the quaternion
first. Numbers have 9 digits after the point.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.number_table import number_table, opened_text
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.robot import Robot

BASE = 7  # columns of the base


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the table."""
    names, index = chosen_joints(sampled.robot, options, "depth-first")
    table = np.hstack([sampled.q[:, :BASE], sampled.joints[:, index]])
    with path.open("wb") as stream:
        np.savetxt(stream, table, fmt="%.9f", delimiter=",")
    return Written(names)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the table."""
    del robot  # the table has no names to compare
    reading = Reading(path)
    with opened_text(path) as stream:
        _, table = number_table(reading, stream, head=False)
    if table.shape[1] <= BASE:
        raise reading.error(f"{table.shape[1]} columns; base and joints are more than {BASE}")
    return RecordedMotion(
        layout="unitree-csv",
        fps=None,
        joint_names=None,
        order="depth-first",
        joints=table[:, BASE:],
        base_position=table[:, :3],
        base_quat_xyzw=reading.quat_xyzw("the base", table[:, 3:BASE], None, 4),
        notes=("the file states no rate", "the file names no joints"),
    )
