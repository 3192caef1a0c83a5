"""Logs of joints in ROS 2 recordings: messages sensor_msgs/JointState in MCAP files and bags.

A message is CDR, little- or big-endian as its first bytes say: the stamp of its header, a name and
an angle for each joint. A bag is a folder with MCAP files, or with SQLite files, which the package
rosbags reads.
"""

from __future__ import annotations

import contextlib
import struct
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from mgs.core.errors import ConfigError, MgsError, MotionFileError
from mgs.core.foreign import described, told_as
from mgs.core.limits import MAX_SAMPLES
from mgs.motion_file.joint_log import JointLog, joint_log, read_csv_log
from mgs.motion_file.mcap_contents import Contents
from mgs.motion_file.mcap_layout import HEAD
from mgs.motion_file.mcap_records import RecordFile, UnreadableFileError
from mgs.motion_file.mcap_scan import contents_by_scan

JOINT_STATE = "sensor_msgs/msg/JointState"
OF_REPLAY = "/sim/joint_states"  # what mgs replay --record adds beside the plan
MOST_NAMES = 10_000  # of a message; a damaged length must not ask for more

Message = tuple[int, bytes]  # time of the recorder [ns] and content


def read_joint_log(path: Path, topic: str | None = None) -> JointLog:
    """Log in a CSV file, an MCAP file or a bag.

    Args:
        path: the file, or the folder of a bag.
        topic: of the messages; None: the only one with joint states.

    Raises:
        ConfigError: the file is no log, or has several topics with joint states.
        MotionFileError: an MCAP file is damaged.
    """
    if path.is_dir():
        return _read_bag(path, topic)
    if path.suffix == ".mcap":
        topics = _mcap_topics(path)
        chosen = _chosen(path, topics, topic)
        return _log(path, chosen, _mcap_messages(path, chosen))
    if path.suffix == ".db3":
        raise ConfigError(path, "is a part of a bag; name the folder of the bag")
    return read_csv_log(path)


def _read_bag(folder: Path, topic: str | None) -> JointLog:
    files = sorted(folder.glob("*.mcap"))
    if files:
        chosen = _chosen(folder, [t for file in files for t in _mcap_topics(file)], topic)
        messages = (m for file in files for m in _mcap_messages(file, chosen))
        return _log(folder, chosen, messages)
    if not list(folder.glob("*.db3")):
        raise ConfigError(folder, "holds no MCAP or SQLite file of a bag")
    try:
        from rosbags.rosbag2 import Reader
    except ImportError as error:
        raise ConfigError(
            folder,
            "this bag is in SQLite files: pip install rosbags, or convert it by ros2 bag convert "
            "to MCAP",
        ) from error
    with (
        told_as(lambda what: ConfigError(folder, f"cannot be read as a bag: {what}")),
        Reader(folder) as reader,
    ):
        topics = [c.topic for c in reader.connections if c.msgtype == JOINT_STATE]
        chosen = _chosen(folder, topics, topic)
        connections = [c for c in reader.connections if c.topic == chosen]
        found = [(t, bytes(raw)) for _, t, raw in reader.messages(connections=connections)]
    return _log(folder, chosen, found)


def _chosen(path: Path, topics: Iterable[str], topic: str | None) -> str:
    """The topic to read."""
    known = sorted(set(topics))
    if topic is not None:
        if topic not in known:
            there = f"there are {', '.join(known)}" if known else "there is none"
            raise ConfigError(path, f"has no joint states on topic {topic}; {there}")
        return topic
    if OF_REPLAY in known:
        return OF_REPLAY
    if len(known) != 1:
        raise ConfigError(
            path,
            f"has joint states on {', '.join(known)}; choose one by --topic"
            if known
            else f"holds no messages of type {JOINT_STATE}",
        )
    return known[0]


def _mcap_topics(path: Path) -> list[str]:
    with _opened(path) as (file, contents):
        del file
        return [
            channel.topic
            for channel in contents.channels.values()
            if channel.schema_id in contents.schemas
            and contents.schemas[channel.schema_id].name in (JOINT_STATE, "sensor_msgs/JointState")
            and contents.counts.get(channel.id)
        ]


def _mcap_messages(path: Path, topic: str) -> Iterator[Message]:
    with _opened(path) as (file, contents):
        del file
        channels = {c.id for c in contents.channels.values() if c.topic == topic}
        for place in contents.places:
            if not place.channels & channels:
                continue
            chunk = place.load()
            data = chunk.data.tobytes()
            for channel in channels & chunk.entries.keys():
                rows = zip(chunk.entries[channel], chunk.sizes(channel), strict=True)
                for (time, offset), size in rows:
                    start = int(offset) + HEAD
                    yield int(time), data[start : start + int(size)]


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[tuple[RecordFile, Contents]]:
    """A file and its contents; every error that a malformed one causes names it."""
    try:
        with path.open("rb") as stream:
            file = RecordFile(stream)
            yield file, contents_by_scan(file, None)
    except UnreadableFileError as error:
        raise MotionFileError(path, str(error)) from error
    except OSError as error:
        raise MotionFileError(path, (error.strerror or str(error)).lower()) from error
    except MgsError:
        raise
    except Exception as error:
        raise MotionFileError(path, f"cannot be read ({described(error)})") from error


def _log(path: Path, topic: str, messages: Iterable[Message]) -> JointLog:
    """Log of all messages; a joint is missing in messages that do not name it."""
    times: list[float] = []
    stamped: list[bool] = []
    values: list[dict[str, float]] = []
    for recorded, content in messages:
        try:
            stamp, found = _joint_state(content)
        except (struct.error, UnicodeDecodeError, ValueError) as error:
            raise ConfigError(
                path, f"message {len(values) + 1} on {topic} is damaged: {described(error)}"
            ) from error
        stamped.append(stamp > 0.0)
        times.append(stamp if stamp > 0.0 else recorded * 1e-9)
        values.append(found)
        if len(values) > MAX_SAMPLES:
            raise ConfigError(path, f"has more than {MAX_SAMPLES} messages on {topic}")
    if not values:
        raise ConfigError(path, f"has no messages on {topic}")
    if any(stamped) and not all(stamped):
        raise ConfigError(path, f"some messages on {topic} have no stamp")
    names = list(dict.fromkeys(name for row in values for name in row))
    columns = {name: np.array([row.get(name, np.nan) for row in values]) for name in names}
    clock = np.array(times)
    return joint_log(f"{path} ({topic})", clock, {"position": columns, "command": {}})


def _joint_state(content: bytes) -> tuple[float, dict[str, float]]:
    """Stamp [s] and angle of each joint [rad] of a message.

    Raises:
        struct.error: it is too short; or ValueError, where its parts contradict each other.
    """
    order = "<" if content[1:2] == b"\x01" else ">"
    body, at = memoryview(content)[4:], 0  # alignment counts from behind the first four bytes

    def number(kind: str, size: int) -> int:
        nonlocal at
        at += -at % size
        (value,) = struct.unpack_from(order + kind, body, at)
        at += size
        return int(value)

    def text() -> str:
        nonlocal at
        length = number("I", 4)
        if at + length > len(body):
            raise ValueError("a text reaches beyond the message")
        raw = bytes(body[at : at + length])
        at += length
        return raw.rstrip(b"\0").decode()

    stamp = number("i", 4) + 1e-9 * number("I", 4)
    text()  # frame
    count = number("I", 4)
    if count > MOST_NAMES:
        raise ValueError(f"{count} names")
    names = [text() for _ in range(count)]
    n_angles = number("I", 4)
    if n_angles != count:
        raise ValueError(f"{n_angles} angles of {count} joints")
    at += -at % 8 if count else 0
    angles = struct.unpack_from(f"{order}{count}d", body, at)
    return stamp, dict(zip(names, angles, strict=True))
