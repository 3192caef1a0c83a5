"""Topics with one message per sample, and the parts of a motion that they hold.

A `SampleTopic` assigns each slot of its message to a part of an array of `Motion`, for writing and
for reading. /support is not among them, since its messages have three lengths. Topics with a single
message are made in `latched_topics`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Side, Support
from mgs.motion_file.cdr import Layout, Slot, message_layout
from mgs.motion_file.transforms import LinkTree
from mgs.robot import Robot

WORLD = "world"  # name of the world frame in tf
START_NS = 10**9  # [ns] stamp of the first sample; tf2 interprets 0 as "latest"
STAMP = Slot("stamp", 2, "<i4")  # seconds and nanoseconds
COMMANDS_TOPIC = "/joint_commands"
SUPPORT_TOPIC = "/support"
TF_TOPIC = "/tf"


@dataclass(frozen=True)
class SampleTopic:
    """A topic with one message of fixed length per sample."""

    name: str
    kind: str
    layout: Layout
    parts: Mapping[str, tuple[str, Any]]  # slot: array of Motion, and part of a sample

    def columns(self, arrays: Mapping[str, Any], samples: slice) -> dict[str, NDArray[Any]]:
        """Parts of the arrays of a motion by slot, as views that can be read and written."""
        return {slot: arrays[name][samples][part] for slot, (name, part) in self.parts.items()}


def field_shapes(n: int) -> dict[str, tuple[int, ...]]:
    """Shape of one sample for each float array of a Motion with n joints."""
    return {
        "q": (7 + n,),
        "v": (6 + n,),
        "torque": (n,),
        "com": (3,),
        "com_ref": (3,),
        "zmp": (2,),
        "zmp_ref": (2,),
        "soles": (2, 7),
        "soles_ref": (2, 7),
        "hands": (2, 7),
        "hands_ref": (2, 3),
        "torso": (7,),
        "torso_ref": (4,),
    }


def stamps_ns(n_samples: int, dt: float) -> NDArray[np.uint64]:
    """Log times (N,) of the samples [ns]."""
    times: NDArray[np.uint64] = np.rint(np.arange(n_samples) * dt * 1e9).astype(np.uint64)
    return times + np.uint64(START_NS)


def split_stamps(times_ns: NDArray[np.uint64]) -> NDArray[np.int32]:
    """Seconds and nanoseconds (N, 2) of times (N,) [ns]."""
    return np.stack(np.divmod(times_ns, np.uint64(10**9)), axis=1).astype(np.int32)


def sample_topics(robot: Robot, tree: LinkTree) -> list[SampleTopic]:
    """All topics with one message of fixed length per sample."""
    topics = [_joint_states(robot), _base_twist(tree), _tf(tree)]
    for name in ("com", "zmp"):
        topics += [_point(f"/{name}", name), _point(f"/{name}_reference", f"{name}_ref")]
    for side in Side:
        topics += [
            _pose(f"/sole/{side.label}", "soles", np.s_[:, side]),
            _pose(f"/sole/{side.label}_reference", "soles_ref", np.s_[:, side]),
            _pose(f"/hand/{side.label}", "hands", np.s_[:, side]),
            _hand_reference(f"/hand/{side.label}_reference", side),
        ]
    return [*topics, _pose("/torso", "torso", np.s_[:]), _torso_reference()]


def support_layouts() -> dict[Support, Layout]:
    """The three messages of /support."""
    return {s: message_layout("std_msgs/String", {"data": s.label}) for s in Support}


def _header(frame: str) -> dict[str, Any]:
    return {"stamp": STAMP, "frame_id": frame}


def _joint_states(robot: Robot) -> SampleTopic:
    kind, n = "sensor_msgs/JointState", robot.n
    value = {
        "header": _header(""),
        "name": robot.joint_names,
        "position": Slot("position", n),
        "velocity": Slot("velocity", n),
        "effort": Slot("effort", n),
    }
    parts = {
        "position": ("q", np.s_[:, FLOATING_BASE_NQ:]),
        "velocity": ("v", np.s_[:, FLOATING_BASE_NV:]),
        "effort": ("torque", np.s_[:]),
    }
    return SampleTopic("/joint_states", kind, message_layout(kind, value), parts)


def joint_commands(robot: Robot) -> SampleTopic:
    """Commanded joint angles; derived from the motion when it is written."""
    kind = "sensor_msgs/JointState"
    position = Slot("position", robot.n)
    value = {"header": _header(""), "name": robot.joint_names, "position": position}
    return SampleTopic(COMMANDS_TOPIC, kind, message_layout(kind, value), {})


def _base_twist(tree: LinkTree) -> SampleTopic:
    """Velocity of the root link in its own frame, for which ROS has no standard topic."""
    kind = "geometry_msgs/TwistStamped"
    layout = message_layout(kind, {"header": _header(tree.root), "twist": Slot("twist", 6)})
    return SampleTopic("/base_twist", kind, layout, {"twist": ("v", np.s_[:, :6])})


def _tf(tree: LinkTree) -> SampleTopic:
    """Transforms: the base pose is read, the slots `link 0` ... are derived when writing."""
    kind = "tf2_msgs/TFMessage"
    links = [(WORLD, tree.root, "base")]
    links += [(parent, child, f"link {i}") for i, (parent, child) in enumerate(tree.moving)]
    transforms = [
        {"header": _header(parent), "child_frame_id": child, "transform": Slot(slot, 7)}
        for parent, child, slot in links
    ]
    layout = message_layout(kind, {"transforms": transforms})
    return SampleTopic(TF_TOPIC, kind, layout, {"base": ("q", np.s_[:, :7])})


def _point(topic: str, name: str) -> SampleTopic:
    """Topic of a point; a ZMP has two coordinates, and z = 0."""
    kind, n_axes = "geometry_msgs/PointStamped", field_shapes(0)[name][0]
    slots = {axis: Slot(axis, 1) for axis in "xyz"[:n_axes]}
    layout = message_layout(kind, {"header": _header(WORLD), "point": slots})
    parts = {axis: (name, np.s_[:, i : i + 1]) for i, axis in enumerate(slots)}
    return SampleTopic(topic, kind, layout, parts)


def _pose(topic: str, name: str, part: Any) -> SampleTopic:
    kind = "geometry_msgs/PoseStamped"
    layout = message_layout(kind, {"header": _header(WORLD), "pose": Slot("pose", 7)})
    return SampleTopic(topic, kind, layout, {"pose": (name, part)})


def _hand_reference(topic: str, side: Side) -> SampleTopic:
    """Planned position of a hand; it has no orientation task, the quaternion is the identity."""
    kind = "geometry_msgs/PoseStamped"
    pose = {"position": Slot("position", 3), "orientation": {"w": 1.0}}
    layout = message_layout(kind, {"header": _header(WORLD), "pose": pose})
    return SampleTopic(topic, kind, layout, {"position": ("hands_ref", np.s_[:, side])})


def _torso_reference() -> SampleTopic:
    """Planned orientation of the torso, which has no position task."""
    kind = "geometry_msgs/QuaternionStamped"
    value = {"header": _header(WORLD), "quaternion": Slot("orientation", 4)}
    layout = message_layout(kind, value)
    parts = {"orientation": ("torso_ref", np.s_[:])}
    return SampleTopic("/torso_reference", kind, layout, parts)
