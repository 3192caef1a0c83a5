"""gmr: motion of a robot as GMR writes it and TWIST and TWIST2 read it.

Pickle of a dictionary, double precision, T frames, J joints, B links:

    fps             number [Hz]; 30 is usual
    root_pos        (T, 3)     origin of the root link in the world [m]
    root_rot        (T, 4)     its orientation x, y, z, w
    dof_pos         (T, J)     [rad], depth first
    local_body_pos  (T, B, 3)  origins of the links in the frame of the root [m]
    link_body_list  list of B names of links, depth first

Joints have no names in the file. The pickle can be read with any version of NumPy. Readers of mgs
refuse a pickle that holds anything but plain data and arrays, or that would run code.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.geometry import quat_conjugate, rotate
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written
from mgs.motion_file.formats.learning.tracking import tracked
from mgs.motion_file.formats.pickle_file import read_pickle, write_pickle
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.robot import Robot

RATES = ("fps", "mocap_frame_rate")


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the dictionary."""
    motion = tracked(sampled, options, "depth-first")
    back = quat_conjugate(sampled.base_quat_xyzw)[:, None]
    local = rotate(back, motion.links.position - sampled.base_position[:, None])
    write_pickle(
        path,
        {
            "fps": float(sampled.fps),
            "root_pos": np.ascontiguousarray(sampled.base_position),
            "root_rot": np.ascontiguousarray(sampled.base_quat_xyzw),
            "dof_pos": np.ascontiguousarray(motion.joints),
            "local_body_pos": np.ascontiguousarray(local),
            "link_body_list": list(motion.links.names),
        },
    )
    return Written(motion.joint_names, motion.links.names)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the dictionary."""
    del robot  # the file has nothing to compare
    reading, found = Reading(path), read_pickle(path)
    if not isinstance(found, dict):
        raise reading.error("not a dictionary")
    joints = reading.array("dof_pos", found.get("dof_pos"), None, None)
    rate = next((found[key] for key in RATES if key in found), None)
    return RecordedMotion(
        layout="gmr",
        fps=None if rate is None else reading.fps(rate),
        joint_names=None,
        order="depth-first",
        joints=joints,
        base_position=reading.array("root_pos", found.get("root_pos"), len(joints), 3),
        base_quat_xyzw=reading.quat_xyzw("root_rot", found.get("root_rot"), len(joints), 4),
        notes=("the file names no joints",),
    )
