"""open-duck: motion in the JSON of the Open Duck reference motion generator.

    LoopMode       "Wrap" for a cycle (--cycle), which ends with its first frame, else "Clamp"
    FPS, FrameDuration   [Hz], [s], not rounded
    EnableCycleOffsetPosition, EnableCycleOffsetRotation, MotionWeight
    Joints         names of the J joints
    Vel_x, Vel_y, Yaw    mean velocity [m/s] and turning [rad/s]
    Placo          dx, dy [m], dtheta [rad] per step, period [s] of two steps,
                   startend_double_support_ratio 0: a cycle begins with the first frame
    Frame_offset, Frame_size   lists of one mapping: first column and number of columns by name
    Frames         one list of numbers per frame

The columns of a frame: root_pos 3 [m], root_quat 4 (x, y, z, w), joints_pos J [rad],
left_toe_pos 3, right_toe_pos 3 [m], world_linear_vel 3 [m/s], world_angular_vel 3 [rad/s],
joints_vel J [rad/s], left_toe_vel 3, right_toe_vel 3 [m/s], foot_contacts 2 (left, right; 1: on the
ground).

A toe is the middle of a sole, seen from the root link. Joints stand depth first. world_angular_vel
is the angular velocity in the world; the generator's own files have another quantity there, the
rotation vector between two frames times its length. Numbers have 7 digits after the point.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.geometry import yaw_from_quat_xyzw
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.learning.amp_frames import (
    Columns,
    columns,
    head,
    read_frames,
    write_frames,
)
from mgs.motion_file.formats.learning.motion_lib import foot_contacts
from mgs.motion_file.formats.recorded import RecordedMotion
from mgs.robot import Robot

STEPS = 2  # of a cycle


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the frames."""
    names, index = chosen_joints(sampled.robot, options, "depth-first")
    velocity = np.hstack([sampled.base_linear_velocity, sampled.base_angular_velocity])
    joints, speeds = sampled.joints[:, index], sampled.joint_velocity[:, index]
    table = columns(sampled, joints, speeds, velocity, "world_")
    table["foot_contacts"] = foot_contacts(sampled)
    write_frames(path, _entries(sampled, names, table), table)
    return Written(names)


def _entries(sampled: SampledMotion, names: tuple[str, ...], table: Columns) -> dict[str, Any]:
    """Entries before the frames."""
    x, y, yaw = _displacement(sampled)
    period = safe_period(sampled.n_frames - 1, sampled.fps)
    rate = 1.0 / period if period > 0.0 else 0.0
    sizes = {name: column.shape[1] for name, column in table.items()}
    starts = np.cumsum([0, *sizes.values()])[:-1].tolist()
    return {
        **head(sampled, names),
        "FPS": round(sampled.fps) if abs(sampled.fps - round(sampled.fps)) < 1e-9 else sampled.fps,
        "Vel_x": x * rate,
        "Vel_y": y * rate,
        "Yaw": yaw * rate,
        "Placo": {
            "dx": x / STEPS,
            "dy": y / STEPS,
            "dtheta": yaw / STEPS,
            "period": period,
            "startend_double_support_ratio": 0.0,
        },
        "Frame_offset": [dict(zip(sizes, starts, strict=True))],
        "Frame_size": [sizes],
    }


def safe_period(frames: int, fps: float) -> float:
    """Period [s] of a number of frames that is this number again when a reader cuts it off."""
    period = frames / fps
    return period if int(period * fps) == frames else math.nextafter(period, math.inf)


def _displacement(sampled: SampledMotion) -> tuple[float, float, float]:
    """How far the robot comes: x, y [m] and yaw [rad]."""
    if sampled.cycle is not None:
        x, y, yaw = sampled.cycle.displacement.tolist()
        return x, y, yaw
    way = sampled.base_position[-1] - sampled.base_position[0]
    heading = np.unwrap(yaw_from_quat_xyzw(sampled.base_quat_xyzw))
    return float(way[0]), float(way[1]), float(heading[-1] - heading[0])


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the frames, whose columns are where Frame_offset says."""
    del robot  # the file names its joints
    reading, content, frames, fps = read_frames(path)
    names = reading.names("Joints", content.get("Joints"))
    offsets, sizes = (_mapping(content, key) for key in ("Frame_offset", "Frame_size"))

    def part(name: str, width: int) -> np.ndarray[Any, np.dtype[np.float64]]:
        start, size = offsets.get(name), sizes.get(name)
        if not isinstance(start, int) or size != width or not 0 <= start <= frames.shape[1] - width:
            raise reading.error(f"Frame_offset, Frame_size: {name} should be {width} columns")
        return frames[:, start : start + width]

    contacts = part("foot_contacts", 2)
    return RecordedMotion(
        layout="open-duck",
        fps=fps,
        joint_names=names,
        order="depth-first",
        joints=part("joints_pos", len(names)),
        joint_velocity=part("joints_vel", len(names)),
        base_position=part("root_pos", 3),
        base_quat_xyzw=reading.quat_xyzw("root_quat", part("root_quat", 4), len(frames), 4),
        base_linear_velocity=part("world_linear_vel", 3),
        base_angular_velocity=part("world_angular_vel", 3),
        contacts=contacts,
        extra={"loop": content.get("LoopMode") == "Wrap"},
    )


def _mapping(content: dict[str, Any], key: str) -> dict[str, Any]:
    """The only mapping of a list of mappings; empty if there is none."""
    found = content.get(key)
    first = found[0] if isinstance(found, list) and found else None
    return first if isinstance(first, dict) else {}
