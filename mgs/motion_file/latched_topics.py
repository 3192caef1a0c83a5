"""Topics with a single message: robot, fixed links, footsteps and the whole trajectory.

They serve viewers and controllers and are ignored when a motion is read.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Footstep, Side
from mgs.core.geometry import quat_xyzw_from_yaw
from mgs.motion import Motion
from mgs.motion_file.cdr import Bytes, Counted, Layout, Slot, element_layout, message_layout
from mgs.motion_file.topics import START_NS, WORLD, split_stamps, stamps_ns
from mgs.motion_file.transforms import LinkTree
from mgs.robot import Robot

ONCE_TOPICS = {
    "/robot_description": "std_msgs/String",
    "/tf_static": "tf2_msgs/TFMessage",
    "/footsteps": "visualization_msgs/MarkerArray",
    "/joint_trajectory": "trajectory_msgs/JointTrajectory",
}
MARKER_CUBE = 1
MARKER_THICKNESS = 0.001  # [m]; viewers warn about 0
MARKER_COLORS = {Side.LEFT: (0.2, 0.4, 0.9, 0.6), Side.RIGHT: (0.9, 0.4, 0.2, 0.6)}
POINTS_AT_A_TIME = 2000
FIRST_STAMP = dict(zip(("sec", "nanosec"), divmod(START_NS, 10**9), strict=True))


def small_messages(motion: Motion, tree: LinkTree) -> dict[str, Layout]:
    """Messages of all topics with a single message but /joint_trajectory, by topic."""
    robot = motion.robot
    values: dict[str, dict[str, Any]] = {
        "/robot_description": {"data": robot.urdf},
        "/tf_static": {"transforms": _fixed_transforms(tree)},
        "/footsteps": {"markers": _footstep_markers(robot, motion.footsteps)},
    }
    return {topic: message_layout(ONCE_TOPICS[topic], value) for topic, value in values.items()}


def _fixed_transforms(tree: LinkTree) -> list[dict[str, Any]]:
    return [
        {
            "header": {"stamp": FIRST_STAMP, "frame_id": parent},
            "child_frame_id": child,
            "transform": {"translation": _xyz(pose[:3]), "rotation": _xyzw(pose[3:])},
        }
        for (parent, child), pose in zip(tree.fixed, tree.fixed_poses, strict=True)
    ]


def _footstep_markers(robot: Robot, footsteps: tuple[Footstep, ...]) -> list[dict[str, Any]]:
    """Boxes under the soles, numbered in the order of the footsteps."""
    markers = []
    for i, step in enumerate(footsteps):
        sole, position = robot.sole_spec(step.side), {"x": step.x, "y": step.y, "z": step.z}
        orientation = _xyzw(quat_xyzw_from_yaw(step.yaw))
        markers.append(
            {
                "header": {"stamp": FIRST_STAMP, "frame_id": WORLD},
                "ns": step.side.label,
                "id": i,
                "type": MARKER_CUBE,
                "pose": {"position": position, "orientation": orientation},
                "scale": {"x": sole.length, "y": sole.width, "z": MARKER_THICKNESS},
                "color": dict(zip("rgba", MARKER_COLORS[step.side], strict=True)),
            }
        )
    return markers


def _xyz(values: Array) -> dict[str, float]:
    return dict(zip("xyz", values.tolist(), strict=True))


def _xyzw(values: Array) -> dict[str, float]:
    return dict(zip("xyzw", values.tolist(), strict=True))


@dataclass(frozen=True)
class TrajectoryMessage:
    """Message of /joint_trajectory, made piece by piece since it may be larger than a chunk.

    Its stamp is 0, which asks a controller to start at once; any other stamp would be in the past.
    """

    motion: Motion
    times: NDArray[np.int32]  # (N, 2) seconds and nanoseconds from the start
    head: Layout  # layout up to the end of the first point
    point: Layout  # layout of each further point

    @property
    def size(self) -> int:
        """Length of the message [bytes]."""
        return self.head.size + (self.motion.n_samples - 1) * self.point.size

    def parts(self) -> Iterator[Bytes]:
        """Encode the message in pieces."""
        yield self.head.encode(1, self._columns(slice(0, 1))).reshape(-1)
        for k in range(1, self.motion.n_samples, POINTS_AT_A_TIME):
            columns = self._columns(slice(k, k + POINTS_AT_A_TIME))
            yield self.point.encode(len(columns["time"]), columns).reshape(-1)

    def _columns(self, samples: slice) -> dict[str, NDArray[Any]]:
        return {
            "positions": self.motion.q[samples, FLOATING_BASE_NQ:],
            "velocities": self.motion.v[samples, FLOATING_BASE_NV:],
            "accelerations": joint_accelerations(self.motion, samples),
            "time": self.times[samples],
        }


def joint_accelerations(motion: Motion, samples: slice) -> Array:
    """Accelerations (m, n) of the joints [rad/s^2] at m samples in a row, by second differences.

    The robot is at rest before the first sample and after the last one.
    """
    begin, end, _ = samples.indices(motion.n_samples)
    around = np.clip(np.arange(begin - 1, end + 1), 0, motion.n_samples - 1)
    return np.diff(motion.q[around, FLOATING_BASE_NQ:], n=2, axis=0) / motion.dt**2


def trajectory_message(motion: Motion) -> TrajectoryMessage:
    """Message that holds the whole motion as a JointTrajectory."""
    n = motion.robot.n
    point = {
        "positions": Slot("positions", n),
        "velocities": Slot("velocities", n),
        "accelerations": Slot("accelerations", n),
        "time_from_start": Slot("time", 2, "<i4"),
    }
    points = Counted(motion.n_samples, [point])
    value = {"joint_names": motion.robot.joint_names, "points": points}
    head = message_layout("trajectory_msgs/JointTrajectory", value)
    # a point ends 4 bytes after a multiple of 8, so all but the first are laid out alike
    rest = element_layout("trajectory_msgs/JointTrajectoryPoint", point, head.size - 4)
    times = stamps_ns(motion.n_samples, motion.dt) - np.uint64(START_NS)
    return TrajectoryMessage(motion, split_stamps(times), head, rest)
