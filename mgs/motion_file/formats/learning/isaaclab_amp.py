"""isaaclab-amp: reference motion of the AMP tasks of Isaac Lab (humanoid_amp).

NumPy arrays in single precision, N frames, D joints, B links, the root link first:

    fps                      ()         [Hz], an integer
    dof_names                (D,)
    body_names               (B,)
    dof_positions            (N, D)     [rad]
    dof_velocities           (N, D)     [rad/s]
    body_positions           (N, B, 3)  origins of the links in the world [m]
    body_rotations           (N, B, 4)  their orientations w, x, y, z
    body_linear_velocities   (N, B, 3)  velocities of the centres of mass of the links [m/s], which
                                        is what Isaac Lab compares them with
    body_angular_velocities  (N, B, 3)  angular velocities in the world [rad/s]

Joints and links are found by their names; here they stand breadth first. The loader interpolates,
so that any rate that is a whole number will do.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.errors import ConfigError
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written
from mgs.motion_file.formats.learning.tracking import link_arrays, read_links, tracked
from mgs.motion_file.formats.npz_file import read_npz, write_npz
from mgs.motion_file.formats.recorded import Reading, RecordedMotion, as_float32
from mgs.robot import Robot

KEYS = (
    "body_positions",
    "body_rotations",
    "body_linear_velocities",
    "body_angular_velocities",
)


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the arrays."""
    if abs(sampled.fps - round(sampled.fps)) > 1e-9:
        raise ConfigError("fps", f"{sampled.fps:.10g} Hz is no integer, as this format needs")
    motion = tracked(sampled, options, "breadth-first")
    links = zip(KEYS, link_arrays(motion.links, "com").values(), strict=True)
    write_npz(
        path,
        {
            "fps": np.int64(round(sampled.fps)),
            "dof_names": np.array(motion.joint_names),
            "body_names": np.array(motion.links.names),
            "dof_positions": as_float32(motion.joints),
            "dof_velocities": as_float32(motion.joint_velocity),
            **dict(links),
        },
    )
    return Written(motion.joint_names, motion.links.names)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the arrays."""
    del robot  # the file names joints and links
    reading, arrays = Reading(path), read_npz(path)
    names = reading.names("dof_names", arrays.get("dof_names"))
    link_names = reading.names("body_names", arrays.get("body_names"))
    joints = reading.array("dof_positions", arrays.get("dof_positions"), None, len(names))
    links = read_links(reading, arrays, len(joints), link_names, "com", KEYS)
    return RecordedMotion(
        layout="isaaclab-amp",
        fps=reading.fps(arrays.get("fps")),
        joint_names=names,
        order="breadth-first",
        joints=joints,
        joint_velocity=reading.array("dof_velocities", arrays.get("dof_velocities"), *joints.shape),
        base_position=links.position[:, 0],
        base_quat_xyzw=links.quat_xyzw[:, 0],
        links=links,
    )
