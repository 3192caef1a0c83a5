"""amp: motion in the JSON of AMP_for_hardware and its forks, after DeepMimic.

    LoopMode       "Wrap" for a cycle (--cycle), which ends with its first frame, else "Clamp"
    FrameDuration  [s], not rounded
    EnableCycleOffsetPosition, EnableCycleOffsetRotation, MotionWeight
    Joints         names of the J joints, which loaders ignore
    Frames         one list of 7 + J + 6 + 6 + J + 6 numbers per frame

The columns of a frame: root_pos 3 [m], root_quat 4 (x, y, z, w), joints_pos J [rad], left and right
toe 3 + 3 [m], linear velocity 3 [m/s], angular velocity 3 [rad/s], joints_vel J [rad/s], velocities
of the toes 3 + 3 [m/s]. Both velocities of the root are in its own frame, since these loaders turn
them into the world. A toe is the middle of a sole, seen from the root link. Joints stand depth
first. Loaders have the number of joints and of toes as constants: a humanoid's are J and 2.

Numbers have 7 digits after the point.
"""

from __future__ import annotations

from pathlib import Path

from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.geometry import rotate
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.learning.amp_frames import (
    columns,
    head,
    read_frames,
    split,
    write_frames,
)
from mgs.motion_file.formats.recorded import RecordedMotion
from mgs.robot import Robot

BESIDE = 3 + 4 + 6 + 6 + 6  # columns that are not of joints


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the frames."""
    names, index = chosen_joints(sampled.robot, options, "depth-first")
    twist = sampled.v[:, :FLOATING_BASE_NV]
    joints, speeds = sampled.joints[:, index], sampled.joint_velocity[:, index]
    table = columns(sampled, joints, speeds, twist, "base_")
    write_frames(path, head(sampled, names), table)
    return Written(names)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the frames, which have two toes."""
    del robot
    reading, content, frames, fps = read_frames(path)
    n, odd = divmod(frames.shape[1] - BESIDE, 2)
    if n < 1 or odd:
        raise reading.error(
            f"{frames.shape[1]} columns, which are not {BESIDE} and two for every joint"
        )
    names = reading.names("Joints", content["Joints"]) if content.get("Joints") else None
    if names is not None and len(names) != n:
        raise reading.error(f"Joints has {len(names)} names for {n} joints")
    widths = {"position": 3, "quat": 4, "joints": n, "toes": 6, "linear": 3, "angular": 3}
    part = split(frames, {**widths, "speeds": n, "toe_speeds": 6})
    quat = reading.quat_xyzw("the root of Frames", part["quat"], len(frames), 4)
    return RecordedMotion(
        layout="amp",
        fps=fps,
        joint_names=names,
        order="depth-first",
        joints=part["joints"],
        joint_velocity=part["speeds"],
        base_position=part["position"],
        base_quat_xyzw=quat,
        base_linear_velocity=rotate(quat, part["linear"]),
        base_angular_velocity=rotate(quat, part["angular"]),
        notes=() if names else ("the file names no joints",),
        extra={"loop": content.get("LoopMode") == "Wrap"},
    )
