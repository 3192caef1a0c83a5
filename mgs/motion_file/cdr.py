"""Encoding of ROS 2 messages in CDR, for a whole trajectory at once.

Little-endian plain CDR (XCDR1: OMG DDS-XTypes 1.3, 7.4, in the encapsulation of DDSI-RTPS 2.3, 10):
a message consists of the four bytes 00 01 00 00 and a body in which every number is aligned to its
own size. A string is its length, its text and a zero byte, which the length includes. A sequence is
its length and its elements.

The messages of a topic differ in a few numbers only. A `Layout` is a message encoded once, with
`Slot`s for those numbers; it then fills or reads N messages as one array (N, size) of bytes.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]
Columns = Mapping[str, NDArray[Any]]

ENCAPSULATION = b"\x00\x01\x00\x00"
PRIMITIVES = {
    "bool": "?",
    "uint8": "B",
    "int32": "i",
    "uint32": "I",
    "float32": "f",
    "float64": "d",
}

# Fields of the message types that we write, constants left out (ROS 2 Humble and later).
DEFINITIONS = {
    "builtin_interfaces/Duration": ("int32 sec", "uint32 nanosec"),
    "builtin_interfaces/Time": ("int32 sec", "uint32 nanosec"),
    "geometry_msgs/Point": ("float64 x", "float64 y", "float64 z"),
    "geometry_msgs/PointStamped": ("std_msgs/Header header", "geometry_msgs/Point point"),
    "geometry_msgs/Pose": ("geometry_msgs/Point position", "geometry_msgs/Quaternion orientation"),
    "geometry_msgs/PoseStamped": ("std_msgs/Header header", "geometry_msgs/Pose pose"),
    "geometry_msgs/Quaternion": ("float64 x", "float64 y", "float64 z", "float64 w"),
    "geometry_msgs/QuaternionStamped": (
        "std_msgs/Header header",
        "geometry_msgs/Quaternion quaternion",
    ),
    "geometry_msgs/Transform": (
        "geometry_msgs/Vector3 translation",
        "geometry_msgs/Quaternion rotation",
    ),
    "geometry_msgs/TransformStamped": (
        "std_msgs/Header header",
        "string child_frame_id",
        "geometry_msgs/Transform transform",
    ),
    "geometry_msgs/Twist": ("geometry_msgs/Vector3 linear", "geometry_msgs/Vector3 angular"),
    "geometry_msgs/TwistStamped": ("std_msgs/Header header", "geometry_msgs/Twist twist"),
    "geometry_msgs/Wrench": ("geometry_msgs/Vector3 force", "geometry_msgs/Vector3 torque"),
    "geometry_msgs/WrenchStamped": ("std_msgs/Header header", "geometry_msgs/Wrench wrench"),
    "geometry_msgs/Vector3": ("float64 x", "float64 y", "float64 z"),
    "nav_msgs/Path": ("std_msgs/Header header", "geometry_msgs/PoseStamped[] poses"),
    "sensor_msgs/CompressedImage": ("std_msgs/Header header", "string format", "uint8[] data"),
    "sensor_msgs/JointState": (
        "std_msgs/Header header",
        "string[] name",
        "float64[] position",
        "float64[] velocity",
        "float64[] effort",
    ),
    "std_msgs/ColorRGBA": ("float32 r", "float32 g", "float32 b", "float32 a"),
    "std_msgs/Header": ("builtin_interfaces/Time stamp", "string frame_id"),
    "std_msgs/String": ("string data",),
    "tf2_msgs/TFMessage": ("geometry_msgs/TransformStamped[] transforms",),
    "trajectory_msgs/JointTrajectory": (
        "std_msgs/Header header",
        "string[] joint_names",
        "trajectory_msgs/JointTrajectoryPoint[] points",
    ),
    "trajectory_msgs/JointTrajectoryPoint": (
        "float64[] positions",
        "float64[] velocities",
        "float64[] accelerations",
        "float64[] effort",
        "builtin_interfaces/Duration time_from_start",
    ),
    "visualization_msgs/Marker": (
        "std_msgs/Header header",
        "string ns",
        "int32 id",
        "int32 type",
        "int32 action",
        "geometry_msgs/Pose pose",
        "geometry_msgs/Vector3 scale",
        "std_msgs/ColorRGBA color",
        "builtin_interfaces/Duration lifetime",
        "bool frame_locked",
        "geometry_msgs/Point[] points",
        "std_msgs/ColorRGBA[] colors",
        "string texture_resource",
        "sensor_msgs/CompressedImage texture",
        "visualization_msgs/UVCoordinate[] uv_coordinates",
        "string text",
        "string mesh_resource",
        "visualization_msgs/MeshFile mesh_file",
        "bool mesh_use_embedded_materials",
    ),
    "visualization_msgs/MarkerArray": ("visualization_msgs/Marker[] markers",),
    "visualization_msgs/MeshFile": ("string filename", "uint8[] data"),
    "visualization_msgs/UVCoordinate": ("float32 u", "float32 v"),
}


def full_name(kind: str) -> str:
    """Full name of a message type: `std_msgs/msg/String` for `std_msgs/String`."""
    package, name = kind.split("/")
    return f"{package}/msg/{name}"


def schema_text(kind: str) -> str:
    """Definition of a message type and of all types in it, in the form `ros2msg`."""
    kinds = [kind]
    _collect(kind, kinds)
    texts = ["\n".join(DEFINITIONS[k]) + "\n" for k in kinds]
    heads = [f"{'=' * 80}\nMSG: {k}\n" for k in kinds[1:]]
    return texts[0] + "".join(h + t for h, t in zip(heads, texts[1:], strict=True))


def _collect(kind: str, found: list[str]) -> None:
    """Add the types used in `kind`, depth first, in order of appearance."""
    for line in DEFINITIONS[kind]:
        part = line.split()[0].removesuffix("[]")
        if part in DEFINITIONS and part not in found:
            found.append(part)
            _collect(part, found)


@dataclass(frozen=True)
class Slot:
    """Place of `count` numbers of one type that change from message to message.

    It represents a sequence of that length or a nested message of that many numbers.
    """

    name: str
    count: int
    dtype: str = "<f8"

    @property
    def size(self) -> int:
        """Number of encoded bytes."""
        return self.count * np.dtype(self.dtype).itemsize


@dataclass(frozen=True)
class Counted:
    """Sequence with `count` elements, of which only the first ones are given."""

    count: int
    items: Sequence[Any]


@dataclass(frozen=True)
class Layout:
    """Bytes (size,) that all messages of a topic share, and slots with their byte offsets."""

    template: Bytes
    slots: tuple[tuple[Slot, int], ...]

    @property
    def size(self) -> int:
        """Length of one message [bytes]."""
        return len(self.template)

    def fill(self, rows: Bytes, columns: Columns) -> None:
        """Write N messages into rows (N, size), from columns (N, count) by the name of a slot."""
        rows[:] = self.template
        for slot, offset in self.slots:
            rows[:, offset : offset + slot.size].view(slot.dtype)[:] = columns[slot.name]

    def encode(self, n: int, columns: Columns) -> Bytes:
        """Encode n messages (n, size) from columns (n, count) by the name of a slot."""
        rows = np.empty((n, self.size), dtype=np.uint8)
        self.fill(rows, columns)
        return rows

    def decode(self, rows: Bytes) -> dict[str, NDArray[Any]]:
        """Decode messages (N, size) to columns (N, count) by the name of a slot; overwrites `rows`.

        Raises:
            ValueError: a byte outside the slots differs from the layout.
        """
        columns: dict[str, NDArray[Any]] = {}
        for slot, offset in self.slots:
            part = rows[:, offset : offset + slot.size]
            values = part.view(slot.dtype)
            if slot.name not in columns:
                columns[slot.name] = values.copy()
            elif not np.array_equal(columns[slot.name], values):
                raise ValueError(f"two values of {slot.name} in one message differ")
            part[:] = 0  # as in the template
        if not (rows == self.template).all():
            raise ValueError("a message is not laid out as expected")
        return columns


def message_layout(kind: str, value: Mapping[str, Any]) -> Layout:
    """Layout of a message from nested mappings; missing fields are zero or empty."""
    encoder = _Encoder(0)
    encoder.put(kind, value)
    return encoder.layout(ENCAPSULATION)


def element_layout(kind: str, value: Mapping[str, Any], position: int) -> Layout:
    """Layout of an element that starts at byte `position` of the body of a message."""
    encoder = _Encoder(position)
    encoder.put(kind, value)
    return encoder.layout(b"")


class _Encoder:
    """Encoder of the body of a message."""

    def __init__(self, position: int) -> None:
        self.position = position
        self.data = bytearray()
        self.slots: list[tuple[Slot, int]] = []

    def layout(self, head: bytes) -> Layout:
        template = np.frombuffer(head + self.data, dtype=np.uint8)
        return Layout(template, tuple((slot, len(head) + at) for slot, at in self.slots))

    def put(self, kind: str, value: Any) -> None:
        """Append a value; None means zero or empty."""
        if isinstance(value, Slot):
            self.put_slot(kind, value)
        elif kind.endswith("[]"):
            self.put_sequence(kind.removesuffix("[]"), () if value is None else value)
        elif kind == "string":
            self.put_string(value or "")
        elif kind in PRIMITIVES:
            self.put_number(PRIMITIVES[kind], 0 if value is None else value)
        else:
            self.put_struct(kind, value or {})

    def put_slot(self, kind: str, slot: Slot) -> None:
        if kind.endswith("[]"):
            self.put_number("I", slot.count)
        self.align(np.dtype(slot.dtype).itemsize)
        self.slots.append((slot, len(self.data)))
        self.data += bytes(slot.size)

    def put_sequence(self, kind: str, value: Sequence[Any] | Counted) -> None:
        counted = value if isinstance(value, Counted) else Counted(len(value), value)
        self.put_number("I", counted.count)
        for item in counted.items:
            self.put(kind, item)

    def put_string(self, text: str) -> None:
        data = text.encode() + b"\0"
        self.put_number("I", len(data))
        self.data += data

    def put_number(self, code: str, number: float) -> None:
        packed = struct.pack(f"<{code}", number)
        self.align(len(packed))
        self.data += packed

    def put_struct(self, kind: str, value: Mapping[str, Any]) -> None:
        fields = [line.split() for line in DEFINITIONS[kind]]
        if unknown := set(value).difference(name for _, name in fields):
            raise KeyError(f"{kind} has no field {', '.join(sorted(unknown))}")
        for field_kind, name in fields:
            self.put(field_kind, value.get(name))

    def align(self, size: int) -> None:
        self.data += bytes(-(self.position + len(self.data)) % size)
