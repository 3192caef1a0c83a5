"""Writing motion files."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

import mgs
from mgs.core.atomic_files import refuse_taken, replacing
from mgs.core.contact import Support
from mgs.core.errors import MgsError, MotionFileError
from mgs.core.progress import Progress
from mgs.core.wrong_type import given_path, wrong_type
from mgs.motion import Motion
from mgs.motion.servo_commands import servo_commands
from mgs.motion_file.cdr import Layout
from mgs.motion_file.check import find_problem
from mgs.motion_file.latched_topics import ONCE_TOPICS, small_messages, trajectory_message
from mgs.motion_file.mcap_layout import HEAD, MESSAGE, RECORD_HEAD
from mgs.motion_file.mcap_writer import (
    Block,
    ChunkWriter,
    block_of_message,
    block_of_rows,
    message_rows,
)
from mgs.motion_file.topics import (
    COMMANDS_TOPIC,
    START_NS,
    SUPPORT_TOPIC,
    TF_TOPIC,
    SampleTopic,
    joint_commands,
    sample_topics,
    split_stamps,
    stamps_ns,
    support_layouts,
)
from mgs.motion_file.transforms import LinkTree, link_tree
from mgs.motion_file.viewer_topics import VIEWER_TOPICS, viewer_messages
from mgs.robot import is_modelled

FORMAT_VERSION = 3
SAMPLES_PER_CHUNK = 500  # about 2 MB; viewers read a chunk at a time


@dataclass(frozen=True, eq=False)
class AddedTopic:
    """Topic with M messages beside those of the motion; ignored when a file is read."""

    name: str
    kind: str
    layout: Layout
    times_ns: NDArray[np.uint64]  # (M,)
    columns: Mapping[str, NDArray[Any]]  # (M, count) by slot, all but the slot `stamp`


def write_motion(
    motion: Motion,
    path: str | Path,
    *,
    force: bool = False,
    progress: Progress | None = None,
    added: Sequence[AddedTopic] = (),
) -> Path:
    """Write a motion file, or nothing at all.

    Args:
        motion: motion to write.
        path: path of the file; its folder is made if missing.
        force: replace an existing file.
        progress: called with the number of written samples and the number of all samples.
        added: further topics, such as those of a replay.

    Returns:
        Path of the file.

    Raises:
        OutputExistsError: the file exists and `force` is not set.
        MotionFileError: an array has a wrong shape or contains a number that is not finite.
        MgsError: the file cannot be written.
        TypeError: an argument has a wrong type.
    """
    if not isinstance(motion, Motion):
        raise wrong_type("what is written", "a Motion", motion)
    path = given_path(path)
    if problem := find_problem(motion):
        raise MotionFileError(path, f"not written: {problem}")
    refuse_taken(path, force)
    try:
        with replacing(path) as stream:
            _write(motion, stream, progress or (lambda done, total: None), added)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise MgsError(f"{path}: cannot be written: {reason}") from error
    return path


def motion_bytes(motion: Motion) -> bytes:
    """Content of the file that `write_motion` would write.

    Raises:
        MotionFileError: an array has a wrong shape or contains a number that is not finite.
    """
    if problem := find_problem(motion):
        raise MotionFileError(motion.gait_name, problem)
    stream = io.BytesIO()
    _write(motion, stream, lambda done, total: None)
    return stream.getvalue()


def _write(
    motion: Motion, stream: BinaryIO, progress: Progress, added: Sequence[AddedTopic] = ()
) -> None:
    tree = link_tree(motion.robot)
    topics = sample_topics(motion.robot, tree)
    if is_modelled(motion.robot):
        topics.append(joint_commands(motion.robot))
    writer = ChunkWriter(stream, f"mgs {mgs.__version__}")
    kinds = ONCE_TOPICS | VIEWER_TOPICS
    once = {name: writer.add_channel(name, kind, once=True) for name, kind in kinds.items()}
    channels = {t.name: writer.add_channel(t.name, t.kind, once=False) for t in topics}
    channels[SUPPORT_TOPIC] = writer.add_channel(SUPPORT_TOPIC, "std_msgs/String", once=False)
    channels |= {t.name: writer.add_channel(t.name, t.kind, once=False) for t in added}
    writer.add_metadata("mgs", metadata(motion))
    for name, media_type, text in _attachments(motion):
        writer.add_attachment(name, media_type, text.encode(), START_NS)
    _write_once(motion, tree, writer, once)
    times = stamps_ns(motion.n_samples, motion.dt)
    for start in range(0, motion.n_samples, SAMPLES_PER_CHUNK):
        samples = slice(start, min(start + SAMPLES_PER_CHUNK, motion.n_samples))
        writer.add_chunk(_sample_blocks(motion, tree, topics, channels, times, samples))
        progress(samples.stop, motion.n_samples)
    longest = max((len(topic.times_ns) for topic in added), default=0)
    for start in range(0, longest, SAMPLES_PER_CHUNK):
        samples = slice(start, start + SAMPLES_PER_CHUNK)
        writer.add_chunk([_added_block(topic, channels[topic.name], samples) for topic in added])
    writer.finish()


def _added_block(topic: AddedTopic, channel: int, samples: slice) -> Block:
    times = topic.times_ns[samples]
    columns = {slot: values[samples] for slot, values in topic.columns.items()}
    rows = message_rows(channel, times, topic.layout.size)
    topic.layout.fill(rows[:, HEAD:], columns | {"stamp": split_stamps(times)})
    return block_of_rows(channel, times, rows)


def metadata(motion: Motion) -> dict[str, str]:
    """Metadata record `mgs`; numbers are JSON, so that they read back exactly."""
    footsteps = [asdict(s) | {"side": s.side.label} for s in motion.footsteps]
    followers = {name: asdict(f) for name, f in motion.robot.followers.items()}
    coupled = {"followers": json.dumps(followers, allow_nan=False)} if followers else {}
    return coupled | {
        "mgs_version": mgs.__version__,
        "schema_version": str(FORMAT_VERSION),
        "gait": motion.gait_name,
        "robot": motion.robot.spec.name,
        "solver": json.dumps(motion.provenance.to_dict(), allow_nan=False),
        "provenance": json.dumps(asdict(motion.provenance), allow_nan=False),
        "dt": json.dumps(motion.dt, allow_nan=False),
        "samples": json.dumps(motion.n_samples, allow_nan=False),
        "duration": json.dumps(motion.duration, allow_nan=False),
        "mass": json.dumps(motion.robot.mass, allow_nan=False),
        "seed": "none",  # the four stages draw no random numbers
        "footsteps": json.dumps(footsteps, allow_nan=False),
        "scene": json.dumps(asdict(motion.scene), allow_nan=False),
    }


def _attachments(motion: Motion) -> list[tuple[str, str, str]]:
    return [
        ("gait.yaml", "application/yaml", motion.gait.to_yaml()),
        ("robot.yaml", "application/yaml", motion.robot.yaml),
        ("robot.urdf", "application/xml", motion.robot.urdf),
    ]


def _write_once(
    motion: Motion, tree: LinkTree, writer: ChunkWriter, channels: dict[str, int]
) -> None:
    """Write the topics with a single message, /joint_trajectory in a chunk of its own.

    That message has 53 MB for 160 000 samples. Readers of the robot description need not unpack it.
    """
    messages = small_messages(motion, tree) | viewer_messages(motion)
    blocks = [
        block_of_message(channels[topic], START_NS, layout.size, [layout.template])
        for topic, layout in messages.items()
    ]
    writer.add_chunk(blocks)
    message = trajectory_message(motion)
    channel = channels["/joint_trajectory"]
    writer.add_chunk([block_of_message(channel, START_NS, message.size, message.parts())])


def _sample_blocks(
    motion: Motion,
    tree: LinkTree,
    topics: list[SampleTopic],
    channels: dict[str, int],
    times: NDArray[np.uint64],
    samples: slice,
) -> list[Block]:
    """Messages of a span of samples, topic by topic."""
    times = times[samples]
    stamps = split_stamps(times)
    blocks = []
    for topic in topics:
        columns = topic.columns(vars(motion), samples)
        columns["stamp"] = stamps
        if topic.name == TF_TOPIC:
            links = tree.poses(motion.q[samples])
            columns |= {f"link {i}": links[:, i] for i in range(links.shape[1])}
        elif topic.name == COMMANDS_TOPIC:
            columns["position"] = servo_commands(motion, samples).position
        channel = channels[topic.name]
        rows = message_rows(channel, times, topic.layout.size)
        topic.layout.fill(rows[:, HEAD:], columns)
        blocks.append(block_of_rows(channel, times, rows))
    blocks.append(_support_block(channels[SUPPORT_TOPIC], times, motion.support[samples]))
    return blocks


def _support_block(channel: int, times: NDArray[np.uint64], support: NDArray[np.int8]) -> Block:
    """Messages of /support, which have three lengths: rows of the longest one, cut to length."""
    layouts = support_layouts()
    rows = message_rows(channel, times, max(layout.size for layout in layouts.values()))
    sizes = np.array([layouts[s].size for s in Support])[support]  # (N,)
    rows[:, :HEAD].view(MESSAGE)["length"][:, 0] = HEAD - RECORD_HEAD.size + sizes
    for s, layout in layouts.items():
        rows[support == s, HEAD : HEAD + layout.size] = layout.template
    lengths = HEAD + sizes
    kept = np.arange(rows.shape[1]) < lengths[:, None]
    offsets = (np.cumsum(lengths) - lengths).astype(np.uint64)
    return Block(channel, times, offsets, int(lengths.sum()), [rows[kept]])
