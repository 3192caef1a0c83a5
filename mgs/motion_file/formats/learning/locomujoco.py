"""locomujoco: trajectory of LocoMuJoCo 1.0 (`Trajectory.load`).

NumPy arrays in single precision, N frames, J joints, the free joint `root` first:

    joint_names   (1 + J,)    depth first, `root` before them
    frequency     ()          [Hz]; the trajectory is interpolated to the rate of the environment
    njnt          ()          1 + J
    jnt_type      (1 + J,)    0 for the free joint, 3 for hinges
    qpos          (N, 7 + J)  x, y, z [m], quaternion w, x, y, z, then angles [rad]
    qvel          (N, 6 + J)  velocity in the world [m/s], angular velocity in the frame of the root
                              [rad/s], then [rad/s], as MuJoCo has them
    split_points  (2,)        0 and N

Any other key is an error there. Poses of links are left out; `extend_motion` of LocoMuJoCo adds
them from its own model.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.geometry import rotate
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.learning.tracking import SCALAR_FIRST
from mgs.motion_file.formats.npz_file import read_npz, write_npz
from mgs.motion_file.formats.recorded import Reading, RecordedMotion, as_float32
from mgs.robot import Robot

ROOT = "root"
FREE, HINGE = 0, 3  # of MuJoCo's mjtJoint
UNUSED = ("metadata", "site_names", "body_names")  # pickled where they are None


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the arrays."""
    names, index = chosen_joints(sampled.robot, options, "depth-first")
    quat = sampled.base_quat_xyzw[:, SCALAR_FIRST]
    qpos = np.hstack([sampled.base_position, quat, sampled.joints[:, index]])
    turning = sampled.v[:, 3:FLOATING_BASE_NV]
    qvel = np.hstack([sampled.base_linear_velocity, turning, sampled.joint_velocity[:, index]])
    write_npz(
        path,
        {
            "joint_names": np.array([ROOT, *names]),
            "frequency": np.float64(sampled.fps),
            "njnt": np.int64(1 + len(names)),
            "jnt_type": np.array([FREE, *(HINGE for _ in names)], dtype=np.int32),
            "qpos": as_float32(qpos),
            "qvel": as_float32(qvel),
            "split_points": np.array([0, sampled.n_frames], dtype=np.int32),
        },
    )
    return Written(names)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the arrays: the first trajectory, if there are several."""
    del robot  # the file names its joints
    reading, arrays = Reading(path), read_npz(path, UNUSED)
    names = reading.names("joint_names", arrays.get("joint_names"))
    kinds = reading.array("jnt_type", arrays.get("jnt_type"), len(names))
    if kinds[0] != FREE or (kinds[1:] != HINGE).any():
        raise reading.error("jnt_type: only a free joint followed by hinges can be read")
    n = len(names) - 1
    qpos = reading.array("qpos", arrays.get("qpos"), None, FLOATING_BASE_NQ + n)
    qvel = reading.array("qvel", arrays.get("qvel"), len(qpos), FLOATING_BASE_NV + n)
    quat = reading.quat_xyzw("qpos[:, 3:7]", qpos[:, 3:7], len(qpos), 4, scalar_first=True)
    end = len(qpos)
    notes: tuple[str, ...] = ()
    if len(splits := reading.array("split_points", arrays.get("split_points"), None)) > 2:
        end = int(splits[1])
        notes = (f"the first of {len(splits) - 1} trajectories",)
        if not 0 < end <= len(qpos):
            raise reading.error(f"split_points: {end} is outside 1 to {len(qpos)}")
    return RecordedMotion(
        layout="locomujoco",
        fps=reading.fps(arrays.get("frequency"), "frequency"),
        joint_names=names[1:],
        order="depth-first",
        joints=qpos[:end, FLOATING_BASE_NQ:],
        joint_velocity=qvel[:end, FLOATING_BASE_NV:],
        base_position=qpos[:end, :3],
        base_quat_xyzw=quat[:end],
        base_linear_velocity=qvel[:end, :3],
        base_angular_velocity=rotate(quat, qvel[:, 3:FLOATING_BASE_NV])[:end],
        notes=notes,
    )
