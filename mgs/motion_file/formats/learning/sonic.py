"""sonic: folder of a motion for the controller of GR00T SONIC (`motion_dir/NAME`).

Tables separated by commas, each with a head line and one line per frame, B links:

    joint_pos.csv     joint_0 ...                          [rad]
    joint_vel.csv     joint_vel_0 ...                      [rad/s]
    body_pos.csv      body_0_x, body_0_y, body_0_z ...     origins of the links in the world [m]
    body_quat.csv     body_0_w, body_0_x, _y, _z ...       their orientations w, x, y, z
    body_lin_vel.csv  body_0_vel_x ...                     velocities of their origins [m/s]
    body_ang_vel.csv  body_0_angvel_x ...                  angular velocities in the world [rad/s]
    metadata.txt      after "Body part indexes:", on the next line, the numbers of the links

Joints and links stand breadth first, as Isaac Lab counts them; link 0 is the root. The rate is not
in the files, and the controller takes 50 Hz. It replaces a motion that it cannot load by one of its
own without a word, so look at its list of motions after loading.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from mgs.core.arrays import Array
from mgs.core.input_files import read_text
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written
from mgs.motion_file.formats.learning.tracking import SCALAR_FIRST, tracked
from mgs.motion_file.formats.number_table import number_table, opened_text
from mgs.motion_file.formats.recorded import Reading, RecordedLinks, RecordedMotion
from mgs.robot import Robot

INDEXES = re.compile(r"Body part indexes:\s*\n([^\n]*)")
TABLES = {  # file: title of a column of link i, what comes after it
    "body_pos.csv": ("body_{}_", "xyz"),
    "body_quat.csv": ("body_{}_", "wxyz"),
    "body_lin_vel.csv": ("body_{}_vel_", "xyz"),
    "body_ang_vel.csv": ("body_{}_angvel_", "xyz"),
}


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the folder."""
    motion = tracked(sampled, options, "breadth-first")
    links, n = motion.links, range(len(motion.joint_names))
    _write_table(path / "joint_pos.csv", [f"joint_{i}" for i in n], motion.joints)
    _write_table(path / "joint_vel.csv", [f"joint_vel_{i}" for i in n], motion.joint_velocity)
    quat = links.quat_xyzw[..., SCALAR_FIRST]
    arrays = (links.position, quat, links.velocity, links.angular_velocity)
    for (name, (title, parts)), array in zip(TABLES.items(), arrays, strict=True):
        head = [title.format(i) + part for i in range(len(links.names)) for part in parts]
        _write_table(path / name, head, array.reshape(sampled.n_frames, -1))
    numbers = " ".join(str(i) for i in range(len(links.names)))
    (path / "metadata.txt").write_text(
        f"Metadata for: {sampled.motion.gait_name}\n\n"
        f"Body part indexes:\n[{numbers}]\n\n"
        f"Total timesteps: {sampled.n_frames}\n",
        encoding="utf-8",
    )
    return Written(motion.joint_names, links.names)


def _write_table(path: Path, head: list[str], table: Array) -> None:
    with path.open("wb") as stream:
        np.savetxt(stream, table, fmt="%.7f", delimiter=",", header=",".join(head), comments="")


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the folder; velocities of links may be missing."""
    del robot  # the tables have no names to compare
    reading = Reading(path)
    joints = _read_table(path / "joint_pos.csv")
    n = len(joints)
    numbers = _link_numbers(reading, path / "metadata.txt")
    b = len(numbers)
    shapes = {name: (n, b * len(parts)) for name, (_, parts) in TABLES.items()}
    found = {
        name: reading.array(name, _read_table(path / name), *shape).reshape(n, b, -1)
        for name, shape in shapes.items()
        if not name.endswith("vel.csv") or (path / name).exists()
    }
    speed, turning = found.get("body_lin_vel.csv"), found.get("body_ang_vel.csv")
    quat = reading.quat_xyzw("body_quat.csv", found["body_quat.csv"], n, b, 4, scalar_first=True)
    return RecordedMotion(
        layout="sonic",
        fps=None,
        joint_names=None,
        order="breadth-first",
        joints=joints,
        joint_velocity=reading.array("joint_vel", _read_table(path / "joint_vel.csv"), n, None),
        base_position=found["body_pos.csv"][:, 0],
        base_quat_xyzw=quat[:, 0],
        base_linear_velocity=None if speed is None else speed[:, 0],
        base_angular_velocity=None if turning is None else turning[:, 0],
        links=RecordedLinks(
            names=None,
            position=found["body_pos.csv"],
            quat_xyzw=quat,
            velocity=speed,
            velocity_of=None if speed is None else "origin",
            angular_velocity=turning,
        ),
        notes=("the files state no rate; 50 Hz is usual", "the files name no joints"),
        extra={"link_numbers": numbers},
    )


def _read_table(path: Path) -> Array:
    with opened_text(path) as stream:
        return number_table(Reading(path), stream, head=True)[1]


def _link_numbers(reading: Reading, path: Path) -> list[int]:
    match = INDEXES.search(read_text(path, kind="a description of tables"))
    numbers = [int(number) for number in re.findall(r"\d+", match[1])] if match else []
    if not numbers:
        raise reading.error("metadata.txt has no line 'Body part indexes:' with numbers after it")
    return numbers
