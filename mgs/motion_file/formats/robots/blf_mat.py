"""blf-mat: MATLAB file for the joint-trajectory-player of bipedal-locomotion-framework.

`traj` (T, n): one row of joint angles [rad] per frame, columns in the order of `joints_list`, which
has to be that of joints_list in the .ini file of the player. The player first moves to the first
row in position control, then sends one row every `sampling_time` [s] of its .ini file, without
interpolating: take --fps 1 / sampling_time (100 Hz unless it is given). `joints_list`,
`sampling_time` and `about` are for people and for reading the file back. Level 5 of the format, not
compressed. Numbers read back exactly.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.errors import MotionFileError
from mgs.core.foreign import described, told_as
from mgs.core.input_files import read_bytes
from mgs.core.limits import MAX_RECORDING
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.robot import Robot

TEXT = 116  # [bytes] of description at the beginning of a file, in which SciPy writes the date
DOUBLE = 8  # [bytes]


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the matrix."""
    from scipy.io import savemat

    names, index = chosen_joints(sampled.robot, options, None)
    content = io.BytesIO()
    arrays = {
        "traj": sampled.joints[:, index],
        "joints_list": np.array([names], dtype=object).T,
        "sampling_time": sampled.interval,
        "about": "; ".join([sampled.motion.gait_name, *options.remarks]),
    }
    savemat(content, arrays, format="5", do_compression=False)
    data = b"MATLAB 5.0 MAT-file, written by mgs".ljust(TEXT) + content.getvalue()[TEXT:]
    path.write_bytes(data)
    return Written(names)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the matrix; names and rate are known if mgs wrote the file."""
    del robot
    reading = Reading(path)
    data = io.BytesIO(read_bytes(path, MAX_RECORDING, "a MATLAB file"))

    def failed(reason: str) -> MotionFileError:
        return reading.error(f"not a MATLAB file of level 5: {reason}")

    try:
        with told_as(failed):
            found = _variables(reading, data)
            listed = _texts(found.get("joints_list"))
    except OSError as error:  # SciPy's own, where bytes are missing
        raise failed(described(error)) from error
    joints = reading.array("traj", found.get("traj"), None, None)
    names = None if listed is None else reading.names("joints_list", listed)
    if names is not None and len(names) != joints.shape[1]:
        raise reading.error("joints_list and traj have different numbers of joints")
    time = found.get("sampling_time")
    return RecordedMotion(
        layout="blf-mat",
        fps=None if time is None else 1.0 / reading.fps(time, "sampling_time", "s"),
        joint_names=names,
        order=None,
        joints=joints,
    )


def _texts(cells: Any) -> list[str] | None:
    """Texts of a cell array, or of an array of texts; None: there is none."""
    if cells is None:
        return None
    found = [np.asarray(cell).reshape(-1) for cell in np.asarray(cells).reshape(-1).tolist()]
    return [str(text[0]) for text in found if text.size]


def _variables(reading: Reading, data: io.BytesIO) -> dict[str, Any]:
    """Variables of the file that a motion may have, if they are not too large."""
    from scipy.io import loadmat, whosmat

    shapes = {name: shape for name, shape, _ in whosmat(data)}
    if DOUBLE * np.prod(shapes.get("traj", (0,)), dtype=float) > MAX_RECORDING:
        raise reading.error(f"traj is larger than {MAX_RECORDING // 1_000_000} MB")
    data.seek(0)
    found: dict[str, Any] = loadmat(data, variable_names=["traj", "joints_list", "sampling_time"])
    return found
