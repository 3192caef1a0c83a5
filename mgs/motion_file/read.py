"""Reading motion files."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, BinaryIO, Literal

from pydantic import Field, PlainValidator, TypeAdapter

from mgs.core.config import Model, build
from mgs.core.contact import Footstep, Side
from mgs.core.errors import ConfigError, MotionFileError
from mgs.core.foreign import described
from mgs.core.input_files import opened
from mgs.core.limits import (
    MAX_ATTACHMENT,
    MAX_BALLS,
    MAX_BOXES,
    MAX_FILE,
    MAX_PARTS,
    MAX_STEPS,
    MAX_URDF,
)
from mgs.core.scene import Ball, Box, Scene
from mgs.core.wrong_type import wrong_type
from mgs.gait import Gait, parse_gait
from mgs.motion import Motion
from mgs.motion.provenance import Provenance
from mgs.motion_file.cdr import full_name
from mgs.motion_file.check import find_problem
from mgs.motion_file.latched_topics import ONCE_TOPICS
from mgs.motion_file.mcap_reader import McapReader
from mgs.motion_file.mcap_records import UnreadableFileError
from mgs.motion_file.read_samples import read_samples
from mgs.motion_file.topics import SUPPORT_TOPIC, SampleTopic, sample_topics, stamps_ns
from mgs.motion_file.transforms import link_tree
from mgs.motion_file.write import FORMAT_VERSION
from mgs.robot import Robot, build_robot

JSON_KEYS = ("dt", "samples", "duration", "mass", "solver", "provenance", "footsteps", "scene")


class FootstepEntry(Model):
    """Footstep in the metadata."""

    side: Literal["left", "right"]
    x: float
    y: float
    yaw: float
    z: float = 0.0


class BoxEntry(Model):
    """Box on the ground in the metadata."""

    x: float
    y: float
    yaw: float
    length: float = Field(gt=0.0)
    width: float = Field(gt=0.0)
    height: float = Field(gt=0.0)


class BallEntry(Model):
    """Ball on the ground in the metadata."""

    x: float
    y: float
    radius: float = Field(gt=0.0)
    mass: float = Field(gt=0.0)
    time: float
    direction: float
    speed: float


class SceneEntry(Model):
    """Objects on the ground in the metadata."""

    boxes: list[BoxEntry] = Field([], max_length=MAX_BOXES)
    balls: list[BallEntry] = Field([], max_length=MAX_BALLS)


def _provenance(value: object) -> Provenance:
    """Convert JSON to a provenance; its lists become tuples."""
    return TypeAdapter(Provenance).validate_python(value)


class MotionMetadata(Model):
    """Part of the metadata record `mgs` that a motion is read from."""

    gait: str
    dt: float = Field(gt=0.0, le=1.0)
    samples: int = Field(gt=0)
    provenance: Annotated[Provenance, PlainValidator(_provenance)]
    footsteps: list[FootstepEntry] = Field(max_length=2 * MAX_STEPS * MAX_PARTS)
    scene: SceneEntry = SceneEntry()


def read_motion(motion: Motion | str | Path) -> Motion:
    """Read a motion file; every array equals the written one bit for bit.

    Args:
        motion: path of the file; a motion is returned unchanged, so that functions can accept both.

    Raises:
        MotionFileError: the file is missing, damaged or not a motion file.
        TypeError: the argument is neither a motion nor a path.
    """
    if isinstance(motion, Motion):
        return motion
    if not isinstance(motion, str | Path):
        raise wrong_type("the motion", "a Motion or the path of a motion file", motion)
    path = Path(motion)
    with _all_errors_naming(path), opened(path) as stream:
        reader = _open(path, stream)
        found = _read(path, reader)
    if problem := find_problem(found):
        raise MotionFileError(path, problem)
    return found


def read_info(path: Path) -> dict[str, Any]:
    """Summarize a motion file without decoding its messages.

    Returns:
        `file`, `bytes`, `profile`, `library`, `duration` [s], `metadata` (the record `mgs` with its
        numbers as numbers), `topics` (name, type, messages) and `attachments` (name, media type,
        bytes).

    Raises:
        MotionFileError: the file is missing, damaged or not a motion file.
    """
    path = Path(path)
    with _all_errors_naming(path), opened(path) as stream:
        reader = _open(path, stream)
        values = _parsed(reader.read_metadata())
        topics = [
            {"topic": topic, "type": reader.kind(topic), "messages": reader.count(topic)}
            for topic in reader.topics
        ]
        attachments = [
            {"name": a.name, "media_type": a.media_type, "bytes": a.data_size}
            for a in reader.contents.attachments.values()
        ]
        return {
            "file": str(path),
            "bytes": reader.file.size,
            "profile": reader.file.header.profile,
            "library": reader.file.header.library,
            "duration": values["duration"],
            "metadata": values,
            "topics": topics,
            "attachments": attachments,
        }


@contextlib.contextmanager
def _all_errors_naming(path: Path) -> Iterator[None]:
    """Turn every error that a malformed file causes into a MotionFileError with its path."""
    try:
        yield
    except MotionFileError:
        raise
    except OSError as error:
        raise MotionFileError(path, (error.strerror or str(error)).lower()) from error
    except UnreadableFileError as error:
        raise MotionFileError(path, str(error)) from error
    except ConfigError as error:
        raise MotionFileError(path, str(error).removeprefix(f"{path}: ")) from error
    except Exception as error:
        reason = described(error)
        raise MotionFileError(path, f"not in the layout of a motion file ({reason})") from error


def _open(path: Path, stream: BinaryIO) -> McapReader:
    """Open a motion file of the format that this version of mgs reads."""
    reader = McapReader(stream)
    version = reader.read_metadata().get("schema_version")
    if version != str(FORMAT_VERSION):
        raise MotionFileError(
            path,
            f"has format {version!r}, this version of mgs reads format {FORMAT_VERSION}; generate "
            "the motion again",
        )
    return reader


def _parsed(values: dict[str, str]) -> dict[str, Any]:
    return {key: json.loads(v) if key in JSON_KEYS else v for key, v in values.items()}


def _read(path: Path, reader: McapReader) -> Motion:
    values = _parsed(reader.read_metadata())
    wanted = {key: values[key] for key in MotionMetadata.model_fields if key in values}
    meta = build(MotionMetadata, wanted, f"{path}: metadata")
    robot, gait = _read_attachments(path, reader)
    topics = sample_topics(robot, link_tree(robot))
    _check_topics(path, reader, topics, meta.samples)
    arrays = read_samples(reader, robot.n, topics, stamps_ns(meta.samples, meta.dt))
    return Motion(
        robot=robot,
        gait=gait,
        gait_name=meta.gait,
        dt=meta.dt,
        footsteps=tuple(
            Footstep(Side[s.side.upper()], s.x, s.y, s.yaw, s.z) for s in meta.footsteps
        ),
        provenance=meta.provenance,
        scene=Scene(
            boxes=tuple(Box(**box.model_dump()) for box in meta.scene.boxes),
            balls=tuple(Ball(**ball.model_dump()) for ball in meta.scene.balls),
        ),
        **arrays,
    )


def _read_attachments(path: Path, reader: McapReader) -> tuple[Robot, Gait]:
    limits = {"gait.yaml": MAX_ATTACHMENT, "robot.yaml": MAX_FILE, "robot.urdf": MAX_URDF}
    for name, limit in limits.items():
        if name not in reader.contents.attachments:
            raise MotionFileError(path, f"attachment {name} is missing")
        if reader.contents.attachments[name].data_size > limit:
            raise MotionFileError(path, f"attachment {name} is larger than {limit // 1000} kB")
    texts = [reader.read_attachment(name) for name in limits]
    for (name, limit), text in zip(limits.items(), texts, strict=True):
        if len(text) > limit:
            raise MotionFileError(path, f"attachment {name} is larger than it says")
    gait, robot, urdf = (text.decode() for text in texts)
    return (
        build_robot(robot, urdf, f"{path}: robot.yaml"),
        parse_gait(gait, f"{path}: gait.yaml", any_name=True),
    )


def _check_topics(
    path: Path, reader: McapReader, topics: list[SampleTopic], n_samples: int
) -> None:
    expected = {topic: (kind, 1) for topic, kind in ONCE_TOPICS.items()}
    expected |= {topic.name: (topic.kind, n_samples) for topic in topics}
    expected[SUPPORT_TOPIC] = ("std_msgs/String", n_samples)
    for topic, (kind, count) in expected.items():
        if topic not in reader.topics:
            raise MotionFileError(path, f"topic {topic} is missing")
        if reader.kind(topic) != full_name(kind):
            raise MotionFileError(path, f"topic {topic} is {reader.kind(topic)}, not {kind}")
        if reader.count(topic) != count:
            raise MotionFileError(
                path, f"topic {topic} has {reader.count(topic)} messages, not {count}"
            )
