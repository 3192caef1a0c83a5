"""Frames of adversarial motion priors as JSON, which amp and open-duck share.

The columns of a frame, J joints; a toe is the middle of a sole, left before right:

    root_pos 3, root_quat 4 (x, y, z, w), joints_pos J, left_toe_pos 3, right_toe_pos 3,
    linear velocity 3, angular velocity 3, joints_vel J, left_toe_vel 3, right_toe_vel 3

Toes are seen from the root link: positions in its frame and their derivatives.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.core.input_files import read_text
from mgs.core.limits import MAX_RECORDING
from mgs.motion.link_motion import sole_motion
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.recorded import Reading

DIGITS = 7  # after the point
Columns = dict[str, Array]  # (T, width) by name, in the order of the file


def columns(
    sampled: SampledMotion, joints: Array, joint_velocity: Array, base_velocity: Array, prefix: str
) -> Columns:
    """Columns of the frames.

    Args:
        sampled: the motion.
        joints: angles (T, J) in the order of the file [rad].
        joint_velocity: their velocities (T, J) [rad/s].
        base_velocity: linear and angular velocity (T, 6) of the root link.
        prefix: of the names of these velocities.
    """
    position, velocity = sole_motion(sampled)
    return {
        "root_pos": sampled.base_position,
        "root_quat": sampled.base_quat_xyzw,
        "joints_pos": joints,
        "left_toe_pos": position[:, 0],
        "right_toe_pos": position[:, 1],
        f"{prefix}linear_vel": base_velocity[:, :3],
        f"{prefix}angular_vel": base_velocity[:, 3:],
        "joints_vel": joint_velocity,
        "left_toe_vel": velocity[:, 0],
        "right_toe_vel": velocity[:, 1],
    }


def head(sampled: SampledMotion, names: Sequence[str]) -> dict[str, Any]:
    """Entries of the file before its frames."""
    cycle = sampled.cycle
    return {
        "LoopMode": "Clamp" if cycle is None else "Wrap",
        "FrameDuration": sampled.interval,
        "EnableCycleOffsetPosition": True,
        "EnableCycleOffsetRotation": cycle is not None and bool(abs(cycle.displacement[2]) > 1e-6),
        "MotionWeight": 1.0,
        "Joints": list(names),
    }


def write_frames(path: Path, content: dict[str, Any], table: Columns) -> None:
    """Write the entries and the frames."""
    rows = np.round(np.hstack(list(table.values())), DIGITS) + 0.0  # no -0.0
    with path.open("w", encoding="utf-8") as stream:
        text = json.dumps(content, indent=1, allow_nan=False)
        stream.write(text.removesuffix("\n}") + ',\n "Frames": [\n')
        for k, row in enumerate(rows):
            stream.write(
                f"  {json.dumps(row.tolist(), allow_nan=False)}{',' if k < len(rows) - 1 else ''}\n"
            )
        stream.write(" ]\n}\n")


def read_frames(path: Path) -> tuple[Reading, dict[str, Any], Array, float]:
    """Entries, frames (T, C) and rate [Hz] of a file."""
    reading = Reading(path)
    text = read_text(path, MAX_RECORDING, "a recorded motion")
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise reading.error(f"not JSON: {error}") from error
    if not isinstance(content, dict):
        raise reading.error("not a JSON object")
    frames = reading.array("Frames", content.get("Frames"), None, None)
    return (
        reading,
        content,
        frames,
        1.0 / reading.fps(content.get("FrameDuration"), "FrameDuration", "s"),
    )


def split(frames: Array, widths: dict[str, int]) -> Columns:
    """Columns of frames by name."""
    ends = np.cumsum(list(widths.values()))
    return dict(zip(widths, np.split(frames, ends[:-1], axis=1), strict=True))
