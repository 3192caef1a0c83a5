"""protomotions: motion of ProtoMotions (`MotionLib`).

torch.save of a dictionary, tensors in single precision, T frames, J joints, B links:

    fps                  number [Hz]; 30 is usual, and the library interpolates
    dof_pos              (T, J)     [rad]
    dof_vel              (T, J)     [rad/s]
    rigid_body_pos       (T, B, 3)  origins of the links in the world [m]
    rigid_body_rot       (T, B, 4)  their orientations x, y, z, w
    rigid_body_vel       (T, B, 3)  velocities of their origins [m/s]
    rigid_body_ang_vel   (T, B, 3)  angular velocities in the world [rad/s]
    rigid_body_contacts  (T, B)     true for the links that carry a sole on the ground

Joints and links stand depth first, as MuJoCo counts them, the root link first, without names.
Reading and writing need torch (pip install 'mgs[protomotions]'); files are read with weights_only,
so that they cannot run code.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.input_files import read_bytes
from mgs.core.limits import MAX_RECORDING
from mgs.motion.link_motion import sole_links
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written
from mgs.motion_file.formats.learning.motion_lib import foot_contacts
from mgs.motion_file.formats.learning.tracking import tracked
from mgs.motion_file.formats.recorded import (
    Reading,
    RecordedLinks,
    RecordedMotion,
    as_float32,
    decoding,
)
from mgs.robot import Robot


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the dictionary."""
    import torch  # 200 MB, for this format alone

    motion = tracked(sampled, options, "depth-first")
    links = motion.links
    arrays = {
        "dof_pos": motion.joints,
        "dof_vel": motion.joint_velocity,
        "rigid_body_pos": links.position,
        "rigid_body_rot": links.quat_xyzw,
        "rigid_body_vel": links.velocity,
        "rigid_body_ang_vel": links.angular_velocity,
    }
    content: dict[str, Any] = {"fps": float(sampled.fps)}
    content |= {key: torch.from_numpy(as_float32(array)) for key, array in arrays.items()}
    contacts = np.zeros((sampled.n_frames, len(links.names)), dtype=bool)
    on_ground = foot_contacts(sampled) > 0.0
    for side, link in enumerate(sole_links(sampled.robot, links.names)):
        contacts[:, link] |= on_ground[:, side]
    content["rigid_body_contacts"] = torch.from_numpy(contacts)
    stream = io.BytesIO()  # given a path, torch would write its name into the file
    torch.save(content, stream)
    path.write_bytes(stream.getvalue())
    return Written(motion.joint_names, links.names)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the dictionary."""
    import torch

    del robot  # the file has nothing to compare
    reading = Reading(path)
    data = read_bytes(path, MAX_RECORDING, "a recorded motion")
    with decoding(path, "a file that torch loads without running code"):
        loaded = torch.load(io.BytesIO(data), weights_only=True, map_location="cpu")
    if not isinstance(loaded, dict):
        raise reading.error("not a dictionary")
    found = {
        key: value.numpy() if isinstance(value, torch.Tensor) else value
        for key, value in loaded.items()
    }
    joints = reading.array("dof_pos", found.get("dof_pos"), None, None)
    position = reading.array("rigid_body_pos", found.get("rigid_body_pos"), len(joints), None, 3)
    shape = position.shape
    quat = reading.quat_xyzw("rigid_body_rot", found.get("rigid_body_rot"), *shape[:2], 4)
    velocity = reading.array("rigid_body_vel", found.get("rigid_body_vel"), *shape)
    turning = reading.array("rigid_body_ang_vel", found.get("rigid_body_ang_vel"), *shape)
    return RecordedMotion(
        layout="protomotions",
        fps=reading.fps(found.get("fps")),
        joint_names=None,
        order="depth-first",
        joints=joints,
        joint_velocity=reading.array("dof_vel", found.get("dof_vel"), *joints.shape),
        base_position=position[:, 0],
        base_quat_xyzw=quat[:, 0],
        base_linear_velocity=velocity[:, 0],
        base_angular_velocity=turning[:, 0],
        links=RecordedLinks(None, position, quat, velocity, "origin", turning),
        notes=("the file names no joints",),
    )
