"""Recorded replays: topics decoded by rosbags, and the replay as a motion for pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from mgs.core.constants import GRAVITY
from mgs.gait import load_gait
from mgs.motion import Motion
from mgs.motion_file import read_motion
from mgs.pipeline import run_stages
from mgs.robot import Robot
from mgs.sim import Replay, replay
from mgs.sim.record import as_motion, write_recorded
from tests.support.commands import SHORT_WALK
from tests.support.motion_files import assert_same

STORE = get_typestore(Stores.ROS2_HUMBLE)


@pytest.fixture(scope="module")
def motion(melson: Robot) -> Motion:
    changes = tuple(word for word in SHORT_WALK[1:] if word != "--set")
    return run_stages(melson, load_gait(SHORT_WALK[0], changes)).motion


@pytest.fixture(scope="module")
def walked(motion: Motion) -> Replay:
    return replay(motion, "mujoco")


@pytest.fixture(scope="module")
def file(motion: Motion, walked: Replay, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_recorded(motion, walked.trace, tmp_path_factory.mktemp("record") / "a.mcap")


@pytest.fixture(scope="module")
def messages(file: Path) -> dict[str, list[Any]]:
    found: dict[str, list[Any]] = {}
    with AnyReader([file], default_typestore=STORE) as reader:
        for connection, stamp, data in reader.messages():
            if connection.topic.startswith("/sim/"):
                message = reader.deserialize(data, connection.msgtype)
                found.setdefault(connection.topic, []).append((stamp, message))
    return found


def test_the_plan_of_a_recorded_file_is_the_motion(file: Path, motion: Motion):
    assert_same(read_motion(file), motion)


def test_joints_and_base_are_those_of_the_replay(
    messages: dict[str, list[Any]], walked: Replay, motion: Motion
):
    q = walked.trace.q
    times = [10**9 + round(k * motion.dt * 1e9) for k in range(len(q))]
    assert [stamp for stamp, _ in messages["/sim/joint_states"]] == times
    joints = np.array([m.position for _, m in messages["/sim/joint_states"]])
    np.testing.assert_array_equal(joints, q[:, 7:])
    base = [m.pose.position for _, m in messages["/sim/base"]]
    np.testing.assert_array_equal([[p.x, p.y, p.z] for p in base], q[:, :3])


def test_links_are_where_pinocchio_places_them(
    messages: dict[str, list[Any]], walked: Replay, motion: Motion
):
    model, data = motion.robot.model, motion.robot.model.createData()
    _, message = messages["/sim/tf"][150]
    placed = {"world": pin.SE3.Identity()}
    for item in message.transforms:
        t, r = item.transform.translation, item.transform.rotation
        pose = pin.XYZQUATToSE3(np.array([t.x, t.y, t.z, r.x, r.y, r.z, r.w]))
        placed[item.child_frame_id] = placed[item.header.frame_id] * pose
    pin.framesForwardKinematics(model, data, walked.trace.q[150])
    for name, pose in placed.items():
        if name != "world":
            frame = data.oMf[model.getFrameId(name.removeprefix("sim/"))]
            np.testing.assert_allclose(pose.homogeneous, frame.homogeneous, atol=1e-9)


def test_the_soles_bear_the_weight_and_the_zmp_is_below_the_com_at_rest(
    messages: dict[str, list[Any]], motion: Motion
):
    loads = [
        np.array([m.wrench.force.z for _, m in messages[f"/sim/contact/{side}"]])
        for side in ("left", "right")
    ]
    weight = motion.robot.mass * GRAVITY
    assert np.mean(sum(loads)[-30:]) == pytest.approx(weight, rel=0.02)
    point = messages["/sim/zmp"][-1][1].point
    np.testing.assert_allclose([point.x, point.y], motion.com[-1, :2], atol=2e-3)


def test_a_replay_as_a_motion_ends_beside_its_plan(motion: Motion, walked: Replay):
    shown = as_motion(motion, walked.trace, "replay")
    assert shown.n_samples == len(walked.trace.t) > motion.n_samples  # with its tail
    assert shown.gait_name == "replay"
    gap = np.linalg.norm(shown.com[-1, :2] - motion.com[-1, :2])
    assert 0.0 < gap < walked.position_error + 5e-3
