"""csv: joint angles and velocities as a text table.

A head line `time,position.JOINT,...,velocity.JOINT,...`, then one line per sample. Units are s, rad
and rad/s; numbers read back exactly. Joints stand in the order of the robot (`mgs robot show`). Of
a cycle the first sample follows the last one. The base is not in the file.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.number_table import number_table, opened_text
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.robot import Robot

QUANTITIES = ("position", "velocity")
DIGITS = 9  # of a sample time


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the table."""
    names, index = chosen_joints(sampled.robot, options, None)
    times = np.round(sampled.interval * np.arange(sampled.n_frames), DIGITS)
    table = np.hstack([sampled.joints[:, index], sampled.joint_velocity[:, index]])
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["time", *(f"{what}.{name}" for what in QUANTITIES for name in names)])
        writer.writerows([times[k].item(), *table[k].tolist()] for k in range(len(table)))
    return Written(names)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the table, whose columns may stand in any order."""
    del robot  # the table names its joints
    reading = Reading(path)
    with opened_text(path) as stream:
        head, table = number_table(reading, stream, head=True)
    columns = {name.strip(): k for k, name in enumerate(head)}
    found = [name.partition(".")[2] for name in columns if name.startswith("position.")]
    if "time" not in columns or not found:
        raise reading.error("no columns time and position.JOINT in its first line")
    names = reading.names("the list of joints", found)
    speeds = [columns.get(f"velocity.{name}") for name in names]
    return RecordedMotion(
        layout="csv",
        fps=rate_of(reading, table[:, columns["time"]]),
        joint_names=names,
        order=None,
        joints=table[:, [columns[f"position.{name}"] for name in names]],
        joint_velocity=None if None in speeds else table[:, [s for s in speeds if s is not None]],
    )


def rate_of(reading: Reading, times: np.ndarray) -> float | None:
    """Frames per second [Hz] of sample times (T,); None for one frame.

    Raises:
        MotionFileError: the times are not at equal intervals.
    """
    if len(times) < 2:
        return None
    steps = np.diff(times)
    step = float(times[-1] - times[0]) / len(steps)
    uneven = float(np.abs(steps - step).max())
    if not step > 0.0 or uneven > 0.01 * step + 2e-6:
        raise reading.error(f"samples are not at equal intervals: {step:.6g} s, +-{uneven:.3g} s")
    return round(1.0 / step, 6)
