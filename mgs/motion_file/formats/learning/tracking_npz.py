"""The seven arrays that whole_body_tracking and mjlab share; see their own modules."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written
from mgs.motion_file.formats.learning.tracking import (
    VelocityOf,
    link_arrays,
    optional_names,
    read_links,
    tracked,
    whole_fps,
)
from mgs.motion_file.formats.npz_file import read_npz, write_npz
from mgs.motion_file.formats.recorded import Reading, RecordedMotion, as_float32
from mgs.robot.orders import Order


def write_tracking(
    sampled: SampledMotion, path: Path, options: Options, order: Order, velocity_of: VelocityOf
) -> Written:
    """Write the arrays in an order, with the velocities of one point of the links."""
    motion = tracked(sampled, options, order)
    write_npz(
        path,
        {
            "fps": whole_fps(sampled.fps),
            "joint_pos": as_float32(motion.joints),
            "joint_vel": as_float32(motion.joint_velocity),
            **link_arrays(motion.links, velocity_of),
            "joint_names": np.array(motion.joint_names),
            "body_names": np.array(motion.links.names),
        },
    )
    return Written(motion.joint_names, motion.links.names)


def read_tracking(path: Path, layout: str, order: Order, velocity_of: VelocityOf) -> RecordedMotion:
    """Motion of the arrays, taken to be in an order where the file names nothing."""
    reading, arrays = Reading(path), read_npz(path)
    names = optional_names(reading, arrays, "joint_names")
    joints = reading.array(
        "joint_pos", arrays.get("joint_pos"), None, None if names is None else len(names)
    )
    link_names = optional_names(reading, arrays, "body_names")
    links = read_links(reading, arrays, len(joints), link_names, velocity_of)
    assert links.velocity is not None and links.angular_velocity is not None
    root_velocity = links.velocity[:, 0] if velocity_of == "origin" else None
    return RecordedMotion(
        layout=layout,
        fps=reading.fps(arrays.get("fps")),
        joint_names=names,
        order=order,
        joints=joints,
        joint_velocity=reading.array("joint_vel", arrays.get("joint_vel"), *joints.shape),
        base_position=links.position[:, 0],
        base_quat_xyzw=links.quat_xyzw[:, 0],
        base_linear_velocity=root_velocity,
        base_angular_velocity=links.angular_velocity[:, 0],
        links=links,
        notes=() if names else ("the file names no joints",),
    )
