"""motion-lib: motion library of PHC, ASAP, HumanoidVerse, PBHC and GR00T SONIC.

Pickle, which joblib.load reads, of a dictionary with one entry, named after the gait; its value is
a dictionary in single precision, T frames, J joints:

    root_trans_offset  (T, 3)         origin of the root link in the world [m]
    pose_aa            (T, 1 + J, 3)  rotation vectors [rad]: of the root in the world, then of each
                                      link in its parent, the axis of its joint times its angle
    dof                (T, J)         [rad]
    root_rot           (T, 4)         orientation of the root x, y, z, w
    fps                integer [Hz]; 30 is usual, and the loader interpolates
    contact_mask       (T, 2)         left and right foot; 1: on the ground (PBHC)

Joints stand depth first, as MuJoCo counts them, without names. Readers of mgs refuse a pickle that
holds anything but plain data and arrays, or that would run code.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError
from mgs.core.geometry import rotvec_from_quat_xyzw
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.pickle_file import read_pickle, write_pickle
from mgs.motion_file.formats.recorded import Reading, RecordedMotion, as_float32
from mgs.robot import Robot
from mgs.robot.orders import joint_axes


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the dictionary."""
    if abs(sampled.fps - round(sampled.fps)) > 1e-9:
        raise ConfigError("fps", f"{sampled.fps:.10g} Hz is no integer, as this format needs")
    names, index = chosen_joints(sampled.robot, options, "depth-first")
    joints = sampled.joints[:, index]
    axes = joint_axes(sampled.robot, names)
    root = rotvec_from_quat_xyzw(sampled.base_quat_xyzw)[:, None]
    entry = {
        "root_trans_offset": as_float32(sampled.base_position),
        "pose_aa": as_float32(np.concatenate([root, joints[..., None] * axes], axis=1)),
        "dof": as_float32(joints),
        "root_rot": as_float32(sampled.base_quat_xyzw),
        "fps": round(sampled.fps),
        "contact_mask": as_float32(foot_contacts(sampled)),
    }
    write_pickle(path, {sampled.motion.gait_name: entry})
    return Written(names)


def foot_contacts(sampled: SampledMotion) -> Array:
    """1 where the left and the right sole are on the ground, else 0: (T, 2)."""
    off = [Support.single(side.other) for side in Side]
    return np.column_stack([sampled.support != other for other in off]).astype(np.float64)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the dictionary, which has one entry."""
    del robot  # the file has nothing to compare
    reading, found = Reading(path), read_pickle(path)
    entry, name = _entry(reading, found)
    joints = reading.array("dof", entry.get("dof"), None, None)
    n = len(joints)
    contacts = entry.get("contact_mask")
    return RecordedMotion(
        layout="motion-lib",
        fps=reading.fps(entry.get("fps")),
        joint_names=None,
        order="depth-first",
        joints=joints,
        base_position=reading.array("root_trans_offset", entry.get("root_trans_offset"), n, 3),
        base_quat_xyzw=reading.quat_xyzw("root_rot", entry.get("root_rot"), n, 4),
        contacts=None if contacts is None else reading.array("contact_mask", contacts, n, 2),
        notes=("the file names no joints",),
        extra={"name": name},
    )


def _entry(reading: Reading, found: Any) -> tuple[dict[str, Any], str]:
    """The only motion of a file, and its name."""
    if not isinstance(found, dict) or not found:
        raise reading.error("not a dictionary of motions")
    if "dof" in found:
        return found, ""
    if len(found) > 1:
        names = ", ".join(str(name) for name in list(found)[:5])
        raise reading.error(f"holds {len(found)} motions ({names} ...); one is read")
    name, entry = next(iter(found.items()))
    if not isinstance(entry, dict):
        raise reading.error("its entry is no dictionary")
    return entry, str(name)
