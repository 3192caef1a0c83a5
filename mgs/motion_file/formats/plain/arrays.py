"""npz: joint angles and velocities as NumPy arrays.

`time` (N,) [s], `position` (N, n) [rad], `velocity` (N, n) [rad/s], `joint_names` (n,) and `dt`
[s]; of a cycle also its `displacement` (3,): x, y [m] and yaw [rad]. Joints stand in the order of
the robot (`mgs robot show`). Of a cycle the first sample follows the last one. The base is not in
the file.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.npz_file import read_npz, write_npz
from mgs.motion_file.formats.plain.csv_table import DIGITS
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.robot import Robot


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the arrays."""
    names, index = chosen_joints(sampled.robot, options, None)
    arrays: dict[str, Any] = {
        "time": np.round(sampled.interval * np.arange(sampled.n_frames), DIGITS),
        "position": np.ascontiguousarray(sampled.joints[:, index]),
        "velocity": np.ascontiguousarray(sampled.joint_velocity[:, index]),
        "joint_names": np.array(names),
        "dt": sampled.interval,
    }
    if sampled.cycle is not None:
        arrays["displacement"] = sampled.cycle.displacement
    write_npz(path, arrays)
    return Written(names)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the arrays."""
    del robot  # the file names its joints
    reading, arrays = Reading(path), read_npz(path)
    names = reading.names("joint_names", arrays.get("joint_names"))
    joints = reading.array("position", arrays.get("position"), None, len(names))
    return RecordedMotion(
        layout="npz",
        fps=round(1.0 / reading.fps(arrays.get("dt"), "dt", "s"), 9),
        joint_names=names,
        order=None,
        joints=joints,
        joint_velocity=reading.array("velocity", arrays.get("velocity"), *joints.shape),
        displacement=(
            reading.array("displacement", arrays["displacement"], 3)
            if "displacement" in arrays
            else None
        ),
    )
