"""Logs of joints as other programs write them."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from mcap_ros2.writer import Writer as RosWriter
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

from mgs.core.errors import ConfigError, MotionFileError
from mgs.motion_file.cdr import schema_text
from mgs.motion_file.joint_log import read_csv_log, write_joint_log
from mgs.motion_file.joint_log_ros import read_joint_log

NAMES = ("hip", "knee_ä", "a")
TIMES = 1000.25 + 0.02 * np.arange(50)  # [s]
ANGLES = np.sin(TIMES[:, None] + np.arange(3.0))  # [rad]


def mcap_log(path: Path, topics: dict[str, np.ndarray], stamped: bool = True) -> None:
    """An MCAP file by the library of its makers, with the messages of several topics."""
    with path.open("wb") as stream:
        writer = RosWriter(stream)
        kind = "sensor_msgs/msg/JointState"
        schema = writer.register_msgdef(kind, schema_text("sensor_msgs/JointState"))
        other = writer.register_msgdef("std_msgs/msg/String", "string data")
        for k, time in enumerate(TIMES):
            for topic, angles in topics.items():
                stamp = {"sec": int(time), "nanosec": round(time % 1.0 * 1e9)} if stamped else {}
                writer.write_message(
                    topic=topic,
                    schema=schema,
                    message={
                        "header": {
                            "stamp": stamp or {"sec": 0, "nanosec": 0},
                            "frame_id": "x" * (k % 5),
                        },
                        "name": list(NAMES),
                        "position": angles[k].tolist(),
                        "velocity": [],
                        "effort": [1.0] * (k % 3),
                    },
                    log_time=round(time * 1e9),
                    publish_time=round(time * 1e9),
                )
            writer.write_message(topic="/chat", schema=other, message={"data": "no joints"})
        writer.finish()


def bag(folder: Path, plugin: StoragePlugin) -> None:
    """A bag by the library rosbags."""
    types = get_typestore(Stores.ROS2_HUMBLE)
    stamp, header, state = (
        types.types[name]
        for name in (
            "builtin_interfaces/msg/Time", "std_msgs/msg/Header", "sensor_msgs/msg/JointState",
        )
    )  # fmt: skip
    with BagWriter(folder, version=9, storage_plugin=plugin) as writer:
        connection = writer.add_connection("/joints", state.__msgtype__, typestore=types)
        for time, row in zip(TIMES, ANGLES, strict=True):
            message = state(
                header=header(
                    stamp=stamp(sec=int(time), nanosec=round(time % 1.0 * 1e9)), frame_id=""
                ),
                name=list(NAMES),
                position=row,
                velocity=np.zeros(0),
                effort=np.zeros(0),
            )
            raw = types.serialize_cdr(message, state.__msgtype__)
            writer.write(connection, round(time * 1e9), raw)


def test_a_csv_log_reads_back_with_its_gaps(tmp_path):
    angles = ANGLES.copy()
    angles[3, 1] = np.nan
    path = tmp_path / "log.csv"
    write_joint_log(path, NAMES, TIMES, angles, command=2.0 * ANGLES)
    log = read_csv_log(path)
    assert (log.names, log.is_motion_time) == (NAMES, True)
    np.testing.assert_allclose(log.times, TIMES, atol=1e-6)
    np.testing.assert_array_equal(log.position, angles)
    np.testing.assert_array_equal(log.command, 2.0 * ANGLES)


def test_columns_may_bear_the_names_of_the_joints_and_lines_any_order(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("timestamp, hip, position.knee\n2.0, 0.5, 0.1\n\n1.0, 0.25,\n")
    log = read_joint_log(path)
    assert (log.names, log.is_motion_time, log.command) == (("hip", "knee"), False, None)
    assert log.times.tolist() == [1.0, 2.0]
    np.testing.assert_array_equal(log.position, [[0.25, np.nan], [0.5, 0.1]])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "names no column for the time"),
        ("hip,knee\n1,2\n", "names no column for the time"),
        ("time\n1\n", "holds no joint angles"),
        ("time,hip\n", "holds no joint angles"),
        ("time,hip\n1\n", "line 2 has 1 cells, the head line 2"),
        ("time,hip\n1,2\n2,two\n", "line 3, column hip: 'two' is no number"),
        ("time,hip\n,2\n", "a line has no time"),
    ],
)
def test_a_malformed_csv_log_is_refused_with_its_line(tmp_path, text, words):
    path = tmp_path / "log.csv"
    path.write_text(text)
    with pytest.raises(ConfigError) as caught:
        read_joint_log(path)
    assert words in str(caught.value)


@pytest.mark.parametrize("stamped", [True, False])
def test_an_mcap_log_of_another_program_is_read(tmp_path, stamped):
    path = tmp_path / "log.mcap"
    mcap_log(path, {"/joints": ANGLES}, stamped)
    log = read_joint_log(path)
    assert log.names == NAMES
    np.testing.assert_allclose(log.times, TIMES, atol=1e-6)
    np.testing.assert_array_equal(log.position, ANGLES)


def test_one_of_several_topics_is_chosen(tmp_path):
    path = tmp_path / "log.mcap"
    mcap_log(path, {"/left": ANGLES, "/right": -ANGLES})
    with pytest.raises(ConfigError, match="has joint states on /left, /right; choose one"):
        read_joint_log(path)
    np.testing.assert_array_equal(read_joint_log(path, "/right").position, -ANGLES)
    with pytest.raises(ConfigError, match="no joint states on topic /up; there are /left, /right"):
        read_joint_log(path, "/up")


@pytest.mark.parametrize("plugin", list(StoragePlugin))
def test_a_bag_is_read(tmp_path, plugin):
    folder = tmp_path / "bag"
    bag(folder, plugin)
    log = read_joint_log(folder)
    assert log.names == NAMES
    np.testing.assert_allclose(log.times, TIMES, atol=1e-6)
    np.testing.assert_array_equal(log.position, ANGLES)


def test_without_rosbags_a_bag_in_sqlite_is_refused_with_the_remedy(tmp_path, monkeypatch):
    folder = tmp_path / "bag"
    bag(folder, StoragePlugin.SQLITE3)
    monkeypatch.setitem(sys.modules, "rosbags.rosbag2", None)
    with pytest.raises(ConfigError, match="pip install rosbags"):
        read_joint_log(folder)


def test_files_that_are_no_logs_are_refused(tmp_path):
    (tmp_path / "empty").mkdir()
    with pytest.raises(ConfigError, match="holds no MCAP or SQLite file"):
        read_joint_log(tmp_path / "empty")
    path = tmp_path / "log.mcap"
    mcap_log(path, {})
    with pytest.raises(ConfigError, match="holds no messages of type"):
        read_joint_log(path)
    path.write_bytes(b"no MCAP file")
    with pytest.raises(MotionFileError, match="not an MCAP file"):
        read_joint_log(path)


def test_a_damaged_message_is_refused(tmp_path):
    """Every truncation, and every byte of the lengths, of a message inside a sound file."""
    from mgs.motion_file.joint_log_ros import _joint_state

    types = get_typestore(Stores.ROS2_HUMBLE)
    state = types.types["sensor_msgs/msg/JointState"]
    header = types.types["std_msgs/msg/Header"]
    stamp = types.types["builtin_interfaces/msg/Time"](sec=1, nanosec=2)
    none = np.zeros(0)
    message = state(header(stamp, ""), list(NAMES), ANGLES[0], none, none)
    raw = bytes(types.serialize_cdr(message, state.__msgtype__))
    for size in range(len(raw) - 8):  # the last eight bytes are empty lists, which are not read
        with pytest.raises(Exception) as caught:
            _joint_state(raw[:size])
        assert isinstance(caught.value, ValueError) or "unpack" in str(caught.value)
    at = raw.index(b"\x03\x00\x00\x00")  # the number of names
    with pytest.raises(ValueError, match="names"):
        _joint_state(raw[:at] + b"\xff\xff\xff\x7f" + raw[at + 4 :])
