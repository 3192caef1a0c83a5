"""Topics for viewers, as rosbags decodes them, and a layout that shows them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from mgs.core.contact import Side
from mgs.core.scene import Ball, Box, Scene
from mgs.motion import Motion
from mgs.motion_file import read_info, read_motion, write_motion
from mgs.motion_file.viewer_topics import VIEWER_TOPICS
from mgs.robot import Robot
from tests.support.motion_files import assert_same, random_motion

STORE = get_typestore(Stores.ROS2_HUMBLE)
LAYOUT = Path(__file__).parents[2] / "docs" / "viewers" / "foxglove_layout.json"
SCENE = Scene((Box(0.3, -0.1, 0.5, 0.2, 0.4, 0.05),), (Ball(0.2, 0.1, 0.04, 0.05, 1.0, 0.0, 0.5),))


@pytest.fixture(scope="module")
def motion(melson: Robot) -> Motion:
    from dataclasses import replace

    return replace(random_motion(melson, 30), scene=SCENE)


@pytest.fixture(scope="module")
def file(motion: Motion, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_motion(motion, tmp_path_factory.mktemp("motion") / "motion.mcap")


@pytest.fixture(scope="module")
def messages(file: Path) -> dict[str, Any]:
    with AnyReader([file], default_typestore=STORE) as reader:
        return {
            connection.topic: reader.deserialize(data, connection.msgtype)
            for connection, _, data in reader.messages()
            if connection.topic in VIEWER_TOPICS
        }


def xyz(vector: Any) -> list[float]:
    return [vector.x, vector.y, vector.z]


def test_paths_run_through_every_sample(messages: dict[str, Any], motion: Motion):
    for topic, points in (("/com_path", motion.com), ("/zmp_path", motion.zmp)):
        path = messages[topic]
        assert path.header.frame_id == "world" and len(path.poses) == motion.n_samples
        found = np.array([xyz(pose.pose.position) for pose in path.poses])
        np.testing.assert_array_equal(found[:, : points.shape[1]], points)
        stamps = [p.header.stamp.sec + 1e-9 * p.header.stamp.nanosec for p in path.poses]
        np.testing.assert_allclose(stamps, 1.0 + motion.times, atol=1e-9)
        assert {(p.header.frame_id, p.pose.orientation.w) for p in path.poses} == {("world", 1.0)}


def test_a_long_path_is_thinned_out(melson: Robot, tmp_path: Path):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mgs.motion_file.viewer_topics.MOST_POSES", 7)
        path = write_motion(random_motion(melson, 50), tmp_path / "a.mcap")
    with AnyReader([path], default_typestore=STORE) as reader:
        wanted = [c for c in reader.connections if c.topic == "/com_path"]
        ((_, _, data),) = reader.messages(wanted)
        poses = reader.deserialize(data, "nav_msgs/msg/Path").poses
    assert len(poses) == 7
    assert xyz(poses[-1].pose.position) == random_motion(melson, 50).com[-1].tolist()


def test_boxes_and_balls_stand_on_the_ground(messages: dict[str, Any]):
    box, ball = messages["/scene"].markers
    assert (box.type, ball.type) == (1, 2)  # cube, sphere
    assert xyz(box.scale) == [0.2, 0.4, 0.05] and xyz(ball.scale) == [0.08] * 3
    assert box.pose.position.z == 0.025 and ball.pose.position.z == 0.04
    assert 2.0 * np.arctan2(box.pose.orientation.z, box.pose.orientation.w) == pytest.approx(0.5)


def test_soles_move_with_their_links(messages: dict[str, Any], motion: Motion):
    """The frame of the link times the pose of the marker is the pose of the sole."""
    model, data = motion.robot.model, motion.robot.model.createData()
    pin.framesForwardKinematics(model, data, motion.q[7])
    for side, marker in zip(Side, messages["/soles"].markers, strict=True):
        assert marker.frame_locked
        o = marker.pose.orientation
        T_link_sole = pin.XYZQUATToSE3(np.array([*xyz(marker.pose.position), o.x, o.y, o.z, o.w]))
        link = data.oMf[model.getFrameId(marker.header.frame_id)]
        sole = data.oMf[motion.robot.sole_frames[side]]
        np.testing.assert_allclose((link * T_link_sole).homogeneous, sole.homogeneous, atol=1e-12)


def test_a_file_without_them_is_read_too(melson: Robot, tmp_path: Path):
    """Files of earlier versions have none of these topics."""
    motion = random_motion(melson, 5)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mgs.motion_file.write.VIEWER_TOPICS", {})
        patch.setattr("mgs.motion_file.write.viewer_messages", lambda motion: {})
        path = write_motion(motion, tmp_path / "old.mcap")
    assert "/scene" not in {entry["topic"] for entry in read_info(path)["topics"]}
    assert_same(read_motion(path), motion)


def test_the_layout_for_foxglove_names_topics_of_the_file(file: Path):
    known = {entry["topic"] for entry in read_info(file)["topics"]}
    layout = json.loads(LAYOUT.read_text())
    named = set(re.findall(r"(?<=\")/[a-z_/]+", json.dumps(layout)))
    assert named <= known and {"/com_path", "/scene", "/soles", "/footsteps"} <= named
    panels = set(re.findall(r"\w+!\w+", json.dumps(layout["layout"])))
    assert panels == set(layout["configById"])
