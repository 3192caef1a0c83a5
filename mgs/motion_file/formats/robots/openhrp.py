"""openhrp: folder of patterns for the SequencePlayer of hrpsys and OpenHRP.

`motion.pos` has the time [s] and the joint angles [rad], `motion.waist` the time, position [m] and
roll, pitch, yaw [rad] (about fixed axes) of the root link in the world, `motion.zmp` the time and
the planned ZMP [m] in the frame of the root link: x, y, z. One line per frame, separated by blanks;
numbers read back exactly. Columns of `motion.pos` have to stand in the order of the joint ids of
the robot's model (--joints). There is no `motion.hip`, beside which the player would ignore
`motion.waist`. Load it with loadPattern("FOLDER/motion", 3.0): the player moves to the first frame
in that time.

Use --fps 1 / dt of the controller (200 Hz unless it is given). Where frames are farther apart than
dt, the player fits polynomials that stop at every frame.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.geometry import quat_conjugate, rotate
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.number_table import opened_text
from mgs.motion_file.formats.plain.csv_table import DIGITS, rate_of
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.robot import Robot

NAME = "motion"


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the three files."""
    names, index = chosen_joints(sampled.robot, options, None)
    waist = np.hstack([sampled.base_position, rpy_of(sampled.base_quat_xyzw)])
    tables = {"pos": sampled.joints[:, index], "waist": waist, "zmp": zmp_in_base(sampled)}
    times = np.round(sampled.times, DIGITS).tolist()
    for suffix, table in tables.items():
        lines = (
            " ".join(map(repr, [time, *row]))
            for time, row in zip(times, table.tolist(), strict=True)
        )
        (path / f"{NAME}.{suffix}").write_text("\n".join(lines) + "\n", encoding="ascii")
    return Written(names)


def rpy_of(quat_xyzw: Array) -> Array:
    """Angles (T, 3) [rad] about the fixed axes x, y, z of quaternions (T, 4); without jumps."""
    x, y, z, w = quat_xyzw.T
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.stack([np.unwrap(roll), pitch, np.unwrap(yaw)], axis=1)


def zmp_in_base(sampled: SampledMotion) -> Array:
    """Planned ZMP (T, 3) [m] in the frame of the root link, linear between planned samples."""
    motion, cycle = sampled.motion, sampled.cycle
    base = motion.q[:, :FLOATING_BASE_NQ]
    above = np.hstack([motion.zmp_ref, np.zeros((motion.n_samples, 1))]) - base[:, :3]
    planned = rotate(quat_conjugate(base[:, 3:]), above)
    if cycle is not None:
        planned = planned[cycle.start : cycle.start + cycle.n_samples]
        planned = np.vstack([planned, planned[:1]])
    at = motion.dt * np.arange(len(planned))
    times = sampled.times if cycle is None else sampled.times % at[-1]
    return np.stack([np.interp(times, at, column) for column in planned.T], axis=1)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the folder; joints have no names."""
    del robot
    reading = Reading(path)
    table = _table(path / f"{NAME}.pos", None)
    waist = _table(path / f"{NAME}.waist", 7)
    if len(waist) != len(table) or not np.array_equal(waist[:, 0], table[:, 0]):
        raise reading.error(f"{NAME}.pos and {NAME}.waist have different times")
    return RecordedMotion(
        layout="openhrp",
        fps=rate_of(reading, table[:, 0]),
        joint_names=None,
        order=None,
        joints=table[:, 1:],
        base_position=waist[:, 1:4],
        base_quat_xyzw=quat_of(waist[:, 4:]),
    )


def quat_of(rpy: Array) -> Array:
    """Quaternions (T, 4) xyzw of angles (T, 3) [rad] about the fixed axes x, y, z."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(0.5 * rpy).T, np.sin(0.5 * rpy).T
    return np.stack(
        [
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        ],
        axis=1,
    )


def _table(path: Path, width: int | None) -> Array:
    """Numbers (T, C) of one of the files."""
    reading = Reading(path)
    with opened_text(path) as stream:
        try:
            rows = [[float(cell) for cell in line.split()] for line in stream if line.strip()]
        except ValueError as error:
            raise reading.error(f"it should have numbers only: {error}") from error
    return reading.array("its table", rows, None, width)
