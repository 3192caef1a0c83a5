"""Topics with a single message that only viewers use: paths of CoM and ZMP, scene, and soles.

A reader neither needs nor reads them, so that files without them are motion files too. Soles are
boxes in the frames of their links, with which /tf moves them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.geometry import quat_xyzw_from_rpy, quat_xyzw_from_yaw
from mgs.core.scene import Scene
from mgs.motion import Motion
from mgs.motion_file.cdr import ENCAPSULATION, Counted, Layout, Slot, element_layout, message_layout
from mgs.motion_file.topics import STAMP, START_NS, WORLD, split_stamps, stamps_ns
from mgs.robot import Robot

VIEWER_TOPICS = {
    "/com_path": "nav_msgs/Path",
    "/zmp_path": "nav_msgs/Path",
    "/scene": "visualization_msgs/MarkerArray",
    "/soles": "visualization_msgs/MarkerArray",
}
FIRST_STAMP = dict(zip(("sec", "nanosec"), divmod(START_NS, 10**9), strict=True))
MARKER_CUBE, MARKER_SPHERE = 1, 2
THICKNESS = 0.002  # [m] of a drawn sole
SIDE_COLORS = {Side.LEFT: (0.2, 0.4, 0.9, 0.9), Side.RIGHT: (0.9, 0.4, 0.2, 0.9)}
BOX_COLOR, BALL_COLOR = (0.7, 0.72, 0.76, 1.0), (0.9, 0.62, 0.0, 1.0)
MOST_POSES = 4000  # of a path; evenly spread over a longer motion


def viewer_messages(motion: Motion) -> dict[str, Layout]:
    """Messages of all topics for viewers, by topic; the ZMP of a fall has no path."""
    kept = np.unique(np.linspace(0, motion.n_samples - 1, MOST_POSES).round().astype(np.intp))
    com, zmp = motion.com[kept], np.zeros((len(kept), 3))
    zmp[:, :2] = motion.zmp[kept]
    stamps = split_stamps(stamps_ns(motion.n_samples, motion.dt)[kept])
    planned = len(kept) if motion.gait.is_balanced else 0
    kind = VIEWER_TOPICS["/scene"]
    return {
        "/com_path": path_message(com, stamps),
        "/zmp_path": path_message(zmp[:planned], stamps[:planned]),
        "/scene": message_layout(kind, {"markers": _scene_markers(motion.scene)}),
        "/soles": message_layout(kind, {"markers": _sole_markers(motion.robot)}),
    }


def path_message(points: Array, stamps: Any) -> Layout:
    """Path through points (m, 3) at times (m, 2) in seconds and nanoseconds, in the world."""
    header = {"stamp": FIRST_STAMP, "frame_id": WORLD}
    head = message_layout("nav_msgs/Path", {"header": header, "poses": Counted(len(points), [])})
    pose = {
        "header": {"stamp": STAMP, "frame_id": WORLD},
        "pose": {"position": Slot("position", 3), "orientation": {"w": 1.0}},
    }
    # every pose begins at a multiple of 8 bytes and has a multiple of 8 bytes, so all are alike
    item = element_layout("geometry_msgs/PoseStamped", pose, head.size - len(ENCAPSULATION))
    rows = item.encode(len(points), {"stamp": stamps, "position": points})
    return Layout(np.concatenate([head.template, rows.reshape(-1)]), ())


def _scene_markers(scene: Scene) -> list[dict[str, Any]]:
    boxes = [
        _marker(
            "boxes", i, MARKER_CUBE, WORLD,
            ([box.x, box.y, 0.5 * box.height], quat_xyzw_from_yaw(box.yaw)),
            (box.length, box.width, box.height), BOX_COLOR,
        )
        for i, box in enumerate(scene.boxes)
    ]  # fmt: skip
    balls = [
        _marker(
            "balls", i, MARKER_SPHERE, WORLD,
            ([ball.x, ball.y, ball.radius], quat_xyzw_from_yaw(0.0)),
            (2.0 * ball.radius,) * 3, BALL_COLOR,
        )
        for i, ball in enumerate(scene.balls)
    ]  # fmt: skip
    return [*boxes, *balls]


def _sole_markers(robot: Robot) -> list[dict[str, Any]]:
    markers = []
    for side in Side:
        sole = robot.sole_spec(side)
        pose = (sole.position, quat_xyzw_from_rpy(sole.rpy))
        size = (sole.length, sole.width, THICKNESS)
        marker = _marker("soles", int(side), MARKER_CUBE, sole.link, pose, size, SIDE_COLORS[side])
        markers.append(marker | {"frame_locked": True})
    return markers


def _marker(
    namespace: str,
    number: int,
    kind: int,
    frame: str,
    pose: tuple[list[float], Array],
    scale: tuple[float, ...],
    color: tuple[float, ...],
) -> dict[str, Any]:
    position, quat = pose
    return {
        "header": {"stamp": FIRST_STAMP, "frame_id": frame},
        "ns": namespace,
        "id": number,
        "type": kind,
        "pose": {
            "position": dict(zip("xyz", position, strict=True)),
            "orientation": dict(zip("xyzw", quat.tolist(), strict=True)),
        },
        "scale": dict(zip("xyz", scale, strict=True)),
        "color": dict(zip("rgba", color, strict=True)),
    }
