"""rosbag2: folder that `ros2 bag play` and rosbag2 tools take.

`metadata.yaml` (version 5, read by ROS 2 Humble and later) and `motion.mcap`, which is a motion
file of mgs: topics, types and units are those of docs/architecture.md and `mgs info`; every topic
has its quality of service. At another rate (--fps) all topics are resampled. A cycle is refused.
With --unit or --feed-forward the topics of the plan stay as they are and /joint_commands/corrected
(sensor_msgs/JointState) has the commands. Joint angles read back exactly.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.errors import ConfigError
from mgs.core.yaml_text import dump_yaml
from mgs.motion import Motion
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.cdr import Slot, message_layout
from mgs.motion_file.formats.format import Options, Written
from mgs.motion_file.formats.recorded import RecordedMotion
from mgs.motion_file.formats.robots.rest import refuse_cycle
from mgs.motion_file.mcap_reader import McapReader
from mgs.motion_file.read import read_motion
from mgs.motion_file.topics import STAMP, field_shapes, stamps_ns
from mgs.motion_file.write import AddedTopic, write_motion
from mgs.robot import Robot

VERSION = 5
FILE, METADATA = "motion.mcap", "metadata.yaml"
CORRECTED = "/joint_commands/corrected"


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the motion file and its metadata."""
    refuse_cycle(sampled, "rosbag2", "a bag is played once")
    if sampled.times[-1] > sampled.motion.duration + sampled.interval:
        raise ConfigError(
            "lead_in", "a bag has the topics of the plan alone; use jtc, or no lead-in"
        )
    motion = resampled_motion(sampled.plan or sampled)
    added = [] if sampled.plan is None else [_corrected(sampled, motion)]
    write_motion(motion, path / FILE, added=added)
    times = stamps_ns(motion.n_samples, motion.dt)
    span = int(times[0]), int(times[-1])
    tree = {"rosbag2_bagfile_information": _information(path / FILE, span)}
    (path / METADATA).write_text(dump_yaml(tree, width=1000.0), encoding="utf-8")
    return Written(sampled.robot.joint_names)


def resampled_motion(sampled: SampledMotion) -> Motion:
    """Motion whose samples are the frames; quantities beside the joints are linear in between."""
    motion = sampled.motion
    if sampled.n_frames == motion.n_samples and sampled.interval == motion.dt:
        return motion
    at = motion.dt * np.arange(motion.n_samples)

    def between(values: np.ndarray) -> np.ndarray:
        flat = values.reshape(len(values), -1)
        columns = [np.interp(sampled.times, at, column) for column in flat.T]
        return np.stack(columns, axis=1).reshape(-1, *values.shape[1:])

    changes: dict[str, Any] = {
        name: between(getattr(motion, name))
        for name in field_shapes(motion.robot.n)
        if name not in ("q", "v")
    }
    for name, first in (
        ("soles", 3),
        ("soles_ref", 3),
        ("hands", 3),
        ("torso", 3),
        ("torso_ref", 0),
    ):
        quat = changes[name][..., first:]
        quat /= np.linalg.norm(quat, axis=-1, keepdims=True)
    return dataclasses.replace(
        motion,
        dt=sampled.interval,
        support=sampled.support,
        q=sampled.q,
        v=sampled.v,
        **changes,
    )


def _corrected(sampled: SampledMotion, motion: Motion) -> AddedTopic:
    """Topic of the commands at the frames."""
    robot, kind = sampled.robot, "sensor_msgs/JointState"
    value = {
        "header": {"stamp": STAMP, "frame_id": ""},
        "name": robot.joint_names,
        "position": Slot("position", robot.n),
        "velocity": Slot("velocity", robot.n),
    }
    return AddedTopic(
        name=CORRECTED,
        kind=kind,
        layout=message_layout(kind, value),
        times_ns=stamps_ns(motion.n_samples, motion.dt),
        columns={"position": sampled.joints, "velocity": sampled.joint_velocity},
    )


def _information(file: Path, span: tuple[int, int]) -> dict[str, Any]:
    """What metadata.yaml says of the one file of a bag; `span` is its first and last time [ns]."""
    with file.open("rb") as stream:
        contents = McapReader(stream).contents
    topics = [
        {
            "topic_metadata": {
                "name": channel.topic,
                "type": contents.schemas[channel.schema_id].name,
                "serialization_format": "cdr",
                "offered_qos_profiles": channel.metadata["offered_qos_profiles"],
            },
            "message_count": contents.counts[number],
        }
        for number, channel in contents.channels.items()
    ]
    count = sum(contents.counts.values())
    start, duration = {"nanoseconds_since_epoch": span[0]}, {"nanoseconds": span[1] - span[0]}
    return {
        "version": VERSION,
        "storage_identifier": "mcap",
        "duration": duration,
        "starting_time": start,
        "message_count": count,
        "topics_with_message_count": topics,
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [FILE],
        "files": [
            {"path": FILE, "starting_time": start, "duration": duration, "message_count": count}
        ],
    }


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the bag, which mgs has to have written."""
    del robot  # the motion file has its own
    motion = read_motion(path / FILE)
    return RecordedMotion(
        layout="rosbag2",
        fps=round(1.0 / motion.dt, 9),
        joint_names=motion.robot.joint_names,
        order=None,
        joints=motion.q[:, FLOATING_BASE_NQ:],
        joint_velocity=motion.v[:, FLOATING_BASE_NV:],
        base_position=motion.q[:, :3],
        base_quat_xyzw=motion.q[:, 3:FLOATING_BASE_NQ],
    )
