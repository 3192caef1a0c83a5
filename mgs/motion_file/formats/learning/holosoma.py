"""holosoma: motion for whole-body tracking in holosoma.

NumPy arrays in single precision, T frames, J joints, B links, the root link first:

    fps             (1,)        [Hz]; 50 Hz is expected
    joint_names     (J,)        depth first
    body_names      (B,)        depth first
    joint_pos       (T, 7 + J)  root: x, y, z [m], quaternion w, x, y, z; then angles [rad]
    joint_vel       (T, 6 + J)  root: velocity in the world [m/s], angular velocity in the frame of
                                the root [rad/s], as MuJoCo's qvel; then [rad/s]
    body_pos_w      (T, B, 3)   origins of the links in the world [m]
    body_quat_w     (T, B, 4)   their orientations w, x, y, z
    body_lin_vel_w  (T, B, 3)   velocities of the origins of the links [m/s]
    body_ang_vel_w  (T, B, 3)   angular velocities in the world [rad/s]

Joints and links are found by their names. The root's part of joint_pos and joint_vel is skipped.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.geometry import rotate
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written
from mgs.motion_file.formats.learning.tracking import (
    SCALAR_FIRST,
    link_arrays,
    read_links,
    tracked,
    whole_fps,
)
from mgs.motion_file.formats.npz_file import read_npz, write_npz
from mgs.motion_file.formats.recorded import Reading, RecordedMotion, as_float32
from mgs.robot import Robot


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the arrays."""
    motion = tracked(sampled, options, "depth-first")
    quat = sampled.base_quat_xyzw[:, SCALAR_FIRST]
    turning = sampled.v[:, 3:FLOATING_BASE_NV]
    write_npz(
        path,
        {
            "fps": whole_fps(sampled.fps),
            "joint_names": np.array(motion.joint_names),
            "body_names": np.array(motion.links.names),
            "joint_pos": as_float32(np.hstack([sampled.base_position, quat, motion.joints])),
            "joint_vel": as_float32(
                np.hstack([sampled.base_linear_velocity, turning, motion.joint_velocity])
            ),
            **link_arrays(motion.links, "origin"),
        },
    )
    return Written(motion.joint_names, motion.links.names)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the arrays."""
    del robot  # the file names joints and links
    reading, arrays = Reading(path), read_npz(path)
    names = reading.names("joint_names", arrays.get("joint_names"))
    link_names = reading.names("body_names", arrays.get("body_names"))
    q = reading.array("joint_pos", arrays.get("joint_pos"), None, FLOATING_BASE_NQ + len(names))
    v = reading.array("joint_vel", arrays.get("joint_vel"), len(q), FLOATING_BASE_NV + len(names))
    quat = reading.quat_xyzw("joint_pos[:, 3:7]", q[:, 3:7], len(q), 4, scalar_first=True)
    return RecordedMotion(
        layout="holosoma",
        fps=reading.fps(arrays.get("fps")),
        joint_names=names,
        order="depth-first",
        joints=q[:, FLOATING_BASE_NQ:],
        joint_velocity=v[:, FLOATING_BASE_NV:],
        base_position=q[:, :3],
        base_quat_xyzw=quat,
        base_linear_velocity=v[:, :3],
        base_angular_velocity=rotate(quat, v[:, 3:FLOATING_BASE_NV]),
        links=read_links(reading, arrays, len(q), link_names, "origin"),
    )
