"""Motion files: reading back, reading by other libraries, and the refusal of damaged files.

The oracles are rosbags, mcap's own reader with mcap_ros2's decoder, and Pinocchio.
"""

from __future__ import annotations

import functools
import itertools
import json
import struct
import subprocess
import sys
import tempfile
import tracemalloc
import zlib
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import mcap.writer
import numpy as np
import pinocchio as pin
import pytest
import yaml
import zstandard
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import NonSeekingReader, make_reader
from mcap.records import Chunk, MessageIndex, Statistics
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from numpy.testing import assert_allclose
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

import mgs
from mgs import motion_file
from mgs.core.contact import Side, Support
from mgs.core.errors import MgsError, MotionFileError, OutputExistsError
from mgs.gait import BalanceGait
from mgs.motion import Motion
from mgs.motion.dynamics import differentiate
from mgs.motion.servo_commands import servo_commands
from mgs.motion_file import read_info, read_motion, write_motion
from mgs.motion_file.cdr import message_layout
from mgs.pipeline import run_stages
from mgs.robot import Robot, load_robot
from tests.support.crooked import crooked_robot
from tests.support.motion_files import ARRAYS, SIDED, assert_same, random_motion
from tests.support.strategies import balance_gait, figure_eight, sine

STORE = get_typestore(Stores.ROS2_HUMBLE)
START_NS = 10**9
VIEWER = {"/com_path", "/zmp_path", "/scene", "/soles"}
ONCE = {"/robot_description", "/tf_static", "/footsteps", "/joint_trajectory", *VIEWER}
CUBE = 1  # visualization_msgs/Marker
LIBRARY = struct.pack("<I", len(f"mgs {mgs.__version__}"))  # length of its name in the header
SHORT = message_layout("std_msgs/String", {"data": "up"})  # no message of /support


def stamp_ns(stamp: Any) -> int:
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)


def times_ns(motion: Motion) -> list[int]:
    return [START_NS + round(k * motion.dt * 1e9) for k in range(motion.n_samples)]


@pytest.fixture(scope="module", params=["melson", "crooked"])
def motion(request: pytest.FixtureRequest) -> Motion:
    return random_motion(load_robot("melson") if request.param == "melson" else crooked_robot(1))


@pytest.fixture(scope="module")
def file(motion: Motion, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The motion in a file of three chunks of samples."""
    path = tmp_path_factory.mktemp("motion") / "motion.mcap"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mgs.motion_file.write.SAMPLES_PER_CHUNK", 10)
        write_motion(motion, path)
    return path


@functools.cache
def small_file() -> bytes:
    """Bytes of a file to be damaged."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "small.mcap"
        write_motion(random_motion(crooked_robot(1), 3), path)
        return path.read_bytes()


@pytest.fixture(scope="module")
def messages(file: Path) -> dict[str, list[Any]]:
    """Messages of every topic as rosbags decodes them."""
    found: dict[str, list[Any]] = {}
    with AnyReader([file], default_typestore=STORE) as reader:
        for connection, _, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            found.setdefault(connection.topic, []).append(message)
    return found


# what we read back


def test_a_motion_read_back_equals_the_one_written_bit_for_bit(motion: Motion, file: Path) -> None:
    assert_same(read_motion(file), motion)


@pytest.mark.parametrize("n_samples", [1, 2, 500, 501])
def test_motions_of_any_length_are_read_back(n_samples: int, melson: Robot, tmp_path: Path) -> None:
    motion = random_motion(melson, n_samples)
    write_motion(motion, tmp_path / "a.mcap")
    assert_same(read_motion(tmp_path / "a.mcap"), motion)


def test_a_balance_motion_is_read_back_with_its_gait_and_its_torso(
    melson: Robot, tmp_path: Path
) -> None:
    gait = balance_gait(
        sine("com_y", 0.02, phase=1 / 3),
        figure_eight("right_hand", "yz", 0.1 + 0.2, 1 / 7),
        com_tolerance=1e-3,
    )
    motion = replace(random_motion(melson), gait=gait)
    write_motion(motion, tmp_path / "a.mcap")
    again = read_motion(tmp_path / "a.mcap")
    assert_same(again, motion)
    assert isinstance(again.gait, BalanceGait)
    assert again.gait.com_tolerance == 1e-3
    kinds = {t["topic"]: t["type"] for t in read_info(tmp_path / "a.mcap")["topics"]}
    assert kinds["/torso"] == "geometry_msgs/msg/PoseStamped"
    assert kinds["/torso_reference"] == "geometry_msgs/msg/QuaternionStamped"


def test_a_generated_balance_motion_without_hand_tasks_is_read_back(
    melson: Robot, tmp_path: Path
) -> None:
    motion = run_stages(melson, balance_gait(sine("com_y", 0.02))).motion
    assert motion.provenance.report["newton_updates"] >= 0
    write_motion(motion, tmp_path / "a.mcap")
    assert_same(read_motion(tmp_path / "a.mcap"), motion)


def test_the_same_motion_gives_the_same_bytes(motion: Motion, file: Path, tmp_path: Path) -> None:
    paths = [tmp_path / "a.mcap", tmp_path / "b.mcap"]
    for path in paths:
        write_motion(read_motion(file), path)
    assert paths[0].read_bytes() == paths[1].read_bytes()


def test_read_info_describes_a_file_without_decoding_messages(motion: Motion, file: Path) -> None:
    info = read_info(file)
    json.dumps(info)  # fit for --json
    counts = {topic["topic"]: topic["messages"] for topic in info["topics"]}
    assert {t for t, count in counts.items() if count == 1} == ONCE
    assert {count for t, count in counts.items() if t not in ONCE} == {motion.n_samples}
    assert info["duration"] == motion.duration
    assert info["bytes"] == file.stat().st_size
    assert [a["name"] for a in info["attachments"]] == ["gait.yaml", "robot.yaml", "robot.urdf"]
    values = info["metadata"]
    assert values["solver"] == json.loads(json.dumps(motion.provenance.to_dict()))
    assert values["mass"] == motion.robot.mass
    assert (values["gait"], values["dt"]) == (motion.gait_name, motion.dt)


def test_importing_motion_file_does_not_import_the_libraries_of_the_tests() -> None:
    code = "import mgs.motion_file, sys; print({'rosbags', 'mcap_ros2'} & set(sys.modules))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "set()"


# what others read


def test_rosbags_encodes_what_it_decodes_to_the_bytes_in_the_file(file: Path) -> None:
    with AnyReader([file], default_typestore=STORE) as reader:
        for connection, _, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            assert bytes(STORE.serialize_cdr(message, connection.msgtype)) == data


def test_both_readers_of_the_mcap_library_accept_every_checksum(file: Path) -> None:
    with file.open("rb") as stream:
        in_file = [(c.topic, m) for _, c, m in make_reader(stream, True).iter_messages()]
    with file.open("rb") as stream:
        reader = NonSeekingReader(stream, validate_crcs=True)
        in_stream = [(c.topic, m) for _, c, m in reader.iter_messages(log_time_order=False)]
    assert len(in_stream) == len(in_file) > 0
    assert sorted(map(repr, in_stream)) == sorted(map(repr, in_file))


def test_message_indexes_lead_to_each_message(file: Path) -> None:
    chunk, found, total = b"", 0, 0
    with file.open("rb") as stream:
        for record in StreamReader(stream, emit_chunks=True).records:
            if isinstance(record, Chunk):
                chunk = zstandard.decompress(record.data)
            elif isinstance(record, MessageIndex):
                for time, offset in record.records:
                    opcode, _, channel, _, log_time = struct.unpack_from("<BQHIQ", chunk, offset)
                    assert (opcode, channel, log_time) == (5, record.channel_id, time)
                    found += 1
            elif isinstance(record, Statistics):
                total = record.message_count
    assert found == total > 0


def test_chunk_indexes_lead_to_each_message_index(file: Path) -> None:
    with file.open("rb") as stream:
        summary = make_reader(stream).get_summary()
        assert summary is not None
        for chunk in summary.chunk_indexes:
            end = chunk.chunk_start_offset + chunk.chunk_length
            assert min(chunk.message_index_offsets.values()) == end
            for channel, offset in chunk.message_index_offsets.items():
                stream.seek(offset)
                opcode, length, found = struct.unpack("<BQH", stream.read(11))
                assert (opcode, found) == (7, channel)
                end += 9 + length
            assert end - chunk.chunk_start_offset - chunk.chunk_length == chunk.message_index_length


def test_chunks_follow_each_other_in_time(file: Path, motion: Motion) -> None:
    with file.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    spans = [(c.message_start_time, c.message_end_time) for c in summary.chunk_indexes]
    t = times_ns(motion)
    once = [(START_NS, START_NS)] * 2
    assert spans == [*once, (t[0], t[9]), (t[10], t[19]), (t[20], t[24])]
    assert summary.statistics is not None
    assert (summary.statistics.message_start_time, summary.statistics.message_end_time) == (
        t[0],
        t[-1],
    )


def test_log_publish_and_header_times_agree(file: Path, motion: Motion) -> None:
    stamps: dict[str, list[int]] = {}
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages():
            assert message.log_time == message.publish_time
            stamps.setdefault(channel.topic, []).append(message.log_time)
            parts = getattr(decoded, "transforms", getattr(decoded, "markers", [decoded]))
            for part in parts:
                if hasattr(part, "header") and channel.topic != "/joint_trajectory":
                    assert stamp_ns(part.header.stamp) == message.log_time
    assert {topic for topic, found in stamps.items() if found == [START_NS]} == ONCE
    assert all(found == times_ns(motion) for topic, found in stamps.items() if topic not in ONCE)


def test_every_channel_offers_its_quality_of_service_in_numbers(file: Path) -> None:
    with file.open("rb") as stream:
        reader = make_reader(stream)
        summary = reader.get_summary()
        assert reader.get_header().profile == "ros2"
    assert summary is not None
    for channel in summary.channels.values():
        (qos,) = yaml.safe_load(channel.metadata["offered_qos_profiles"])
        assert qos["durability"] == (1 if channel.topic in ONCE else 2)
        assert all(isinstance(qos[key], int) for key in ("history", "reliability", "liveliness"))
        assert channel.message_encoding == "cdr"
        assert summary.schemas[channel.schema_id].encoding == "ros2msg"


def test_rosbags_understands_the_quality_of_service(file: Path) -> None:
    with AnyReader([file], default_typestore=STORE) as reader:
        latched = {
            c.topic
            for c in reader.connections
            if c.ext.offered_qos_profiles[0].durability.name == "TRANSIENT_LOCAL"
        }
    assert latched == ONCE


def test_rosbags_and_mcap_ros2_read_the_same_numbers(file: Path, messages: Any) -> None:
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        counts = dict.fromkeys(messages, 0)
        for _, channel, _, decoded in reader.iter_decoded_messages():
            expected = messages[channel.topic][counts[channel.topic]]
            counts[channel.topic] += 1
            assert plain(decoded) == plain(expected)
    assert counts == {topic: len(found) for topic, found in messages.items()}


def plain(message: Any) -> Any:
    """A decoded message of either library as nested dictionaries and lists."""
    if isinstance(message, (str, int, float)):
        return message
    if isinstance(message, (bytes, np.ndarray)):
        return list(message)
    if isinstance(message, (list, tuple)):
        return [plain(item) for item in message]
    names = getattr(message, "__slots__", None) or [f.name for f in fields(message)]
    return {n: plain(getattr(message, n)) for n in names if not n.startswith("__")}


def test_joint_states_hold_angles_velocities_and_torques(messages: Any, motion: Motion) -> None:
    states = messages["/joint_states"]
    assert all(tuple(s.name) == motion.robot.joint_names for s in states)
    assert np.array_equal([s.position for s in states], motion.q[:, 7:])
    assert np.array_equal([s.velocity for s in states], motion.v[:, 6:])
    assert np.array_equal([s.effort for s in states], motion.torque)


def test_joint_commands_are_written_for_servos_with_a_stiffness(
    messages: Any, motion: Motion
) -> None:
    if motion.robot.spec.name != "melson":  # the other robot's servos have none
        assert "/joint_commands" not in messages
        return
    commands = messages["/joint_commands"]
    assert all(tuple(c.name) == motion.robot.joint_names for c in commands)
    assert np.array_equal([c.position for c in commands], servo_commands(motion).position)
    assert all(len(c.velocity) == len(c.effort) == 0 for c in commands)


def test_points_and_poses_are_those_of_the_motion(messages: Any, motion: Motion) -> None:
    for topic, values in {
        "/com": motion.com,
        "/com_reference": motion.com_ref,
        "/zmp": np.pad(motion.zmp, ((0, 0), (0, 1))),
        "/zmp_reference": np.pad(motion.zmp_ref, ((0, 0), (0, 1))),
    }.items():
        assert np.array_equal([xyz(m.point) for m in messages[topic]], values)
        assert {m.header.frame_id for m in messages[topic]} == {"world"}
    identity = np.tile([0.0, 0.0, 0.0, 1.0], (motion.n_samples, 1))
    for side in Side:
        for topic, values in {
            f"/sole/{side.label}": motion.soles[:, side],
            f"/sole/{side.label}_reference": motion.soles_ref[:, side],
            f"/hand/{side.label}": motion.hands[:, side],
            f"/hand/{side.label}_reference": np.hstack([motion.hands_ref[:, side], identity]),
        }.items():
            poses = [[*xyz(m.pose.position), *xyzw(m.pose.orientation)] for m in messages[topic]]
            assert np.array_equal(poses, values)
    poses = [[*xyz(m.pose.position), *xyzw(m.pose.orientation)] for m in messages["/torso"]]
    assert np.array_equal(poses, motion.torso)
    asked = messages["/torso_reference"]
    assert np.array_equal([xyzw(m.quaternion) for m in asked], motion.torso_ref)
    assert {m.header.frame_id for m in [*messages["/torso"], *asked]} == {"world"}


def test_support_and_base_twist_are_those_of_the_motion(messages: Any, motion: Motion) -> None:
    assert [m.data for m in messages["/support"]] == [Support(s).label for s in motion.support]
    twists = [[*xyz(m.twist.linear), *xyz(m.twist.angular)] for m in messages["/base_twist"]]
    assert np.array_equal(twists, motion.v[:, :6])


def test_the_trajectory_is_the_whole_motion_starting_now(messages: Any, motion: Motion) -> None:
    (trajectory,) = messages["/joint_trajectory"]
    assert stamp_ns(trajectory.header.stamp) == 0  # for ros2_control: at once
    assert tuple(trajectory.joint_names) == motion.robot.joint_names
    assert np.array_equal([p.positions for p in trajectory.points], motion.q[:, 7:])
    assert np.array_equal([p.velocities for p in trajectory.points], motion.v[:, 6:])
    _, accelerations = differentiate(motion.robot, motion.q, motion.dt)
    read = [p.accelerations for p in trajectory.points]
    assert_allclose(read, accelerations[:, 6:], rtol=0.0, atol=1e-7 * np.abs(accelerations).max())
    starts = [stamp_ns(p.time_from_start) + START_NS for p in trajectory.points]
    assert starts == times_ns(motion)


def test_transforms_put_together_are_the_forward_kinematics(messages: Any, motion: Motion) -> None:
    model = motion.robot.model
    data = model.createData()
    links = {f.name: i for i, f in enumerate(model.frames) if f.type == pin.FrameType.BODY}
    (static,) = messages["/tf_static"]
    for moving, q in zip(messages["/tf"], motion.q, strict=True):
        placed = {"world": pin.SE3.Identity()}
        for t in [*moving.transforms, *static.transforms]:  # parents come first
            placement = [*xyz(t.transform.translation), *xyzw(t.transform.rotation)]
            parent = placed[t.header.frame_id]
            placed[t.child_frame_id] = parent * pin.XYZQUATToSE3(np.array(placement))
        pin.framesForwardKinematics(model, data, q)
        assert set(placed) == {"world", *links}
        for link, frame in links.items():
            # 20 products of rotations of norm 1; the base is up to 1.5 m away
            np.testing.assert_allclose(placed[link], data.oMf[frame], rtol=0, atol=1e-14)


def test_footsteps_are_the_rectangles_of_the_soles(messages: Any, motion: Motion) -> None:
    (array,) = messages["/footsteps"]
    assert len(array.markers) == len(motion.footsteps)
    for i, (marker, step) in enumerate(zip(array.markers, motion.footsteps, strict=True)):
        sole = motion.robot.sole_spec(step.side)
        assert (marker.id, marker.ns, marker.type) == (i, step.side.label, CUBE)
        assert xyz(marker.pose.position) == [step.x, step.y, 0.0]
        turn = pin.rpy.matrixToRpy(
            pin.Quaternion(
                *xyzw(marker.pose.orientation)[-1:], *xyzw(marker.pose.orientation)[:3]
            ).matrix()
        )
        np.testing.assert_allclose(turn, [0.0, 0.0, step.yaw], rtol=0, atol=1e-12)
        assert xyz(marker.scale)[:2] == [sole.length, sole.width]


def test_the_robot_description_is_the_urdf(messages: Any, motion: Motion) -> None:
    (description,) = messages["/robot_description"]
    assert description.data == motion.robot.urdf


def xyz(value: Any) -> list[float]:
    return [value.x, value.y, value.z]


def xyzw(value: Any) -> list[float]:
    return [value.x, value.y, value.z, value.w]


# writing


def test_an_existing_file_is_kept_unless_forced(motion: Motion, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_text("mine")
    with pytest.raises(OutputExistsError):
        write_motion(motion, path)
    assert path.read_text() == "mine"
    write_motion(motion, path, force=True)
    assert_same(read_motion(path), motion)


def test_a_folder_is_never_replaced(motion: Motion, tmp_path: Path) -> None:
    with pytest.raises(MgsError, match="a folder, which is never replaced"):
        write_motion(motion, tmp_path, force=True)


def test_missing_folders_are_made(motion: Motion, tmp_path: Path) -> None:
    write_motion(motion, tmp_path / "a" / "b" / "c.mcap")
    assert_same(read_motion(tmp_path / "a" / "b" / "c.mcap"), motion)


def test_a_path_that_cannot_be_written_raises_an_mgs_error(motion: Motion, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(MgsError, match="cannot be written"):
        write_motion(motion, tmp_path / "file" / "a.mcap")


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError, OSError(28, "No space left")])
def test_a_failed_write_leaves_existing_files_unchanged(
    error: Any, motion: Motion, tmp_path: Path
) -> None:
    path = tmp_path / "a.mcap"
    path.write_text("mine")

    def fail(done: int, total: int) -> None:
        raise error

    with pytest.raises((KeyboardInterrupt, MemoryError, MgsError)):
        write_motion(motion, path, force=True, progress=fail)
    with pytest.raises((KeyboardInterrupt, MemoryError, MgsError)):
        write_motion(motion, tmp_path / "new" / "folder" / "a.mcap", progress=fail)
    assert [p.name for p in tmp_path.iterdir()] == ["a.mcap"]
    assert path.read_text() == "mine"


def test_progress_counts_up_to_all_samples(melson: Robot, tmp_path: Path) -> None:
    calls: list[tuple[int, int]] = []
    motion = random_motion(melson, 1201)
    write_motion(motion, tmp_path / "a", progress=lambda *call: calls.append(call))
    assert calls == [(500, 1201), (1000, 1201), (1201, 1201)]


@pytest.mark.parametrize(
    ("name", "value"), [*((name, np.nan) for name in (*ARRAYS, *SIDED)), ("com", -np.inf)]
)
def test_a_nan_is_neither_written_nor_read(
    name: str, value: float, melson: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion, path = random_motion(melson), tmp_path / "a.mcap"
    getattr(motion, name)[3].flat[-1] = value
    with pytest.raises(MotionFileError, match=f"{name} is not finite at t = 0.037 s"):
        write_motion(motion, path)
    assert not path.exists()
    monkeypatch.setattr("mgs.motion_file.write.find_problem", lambda motion: None)
    write_motion(motion, path)
    with pytest.raises(MotionFileError, match=f"{name} is not finite"):
        read_motion(path)


@pytest.mark.parametrize(
    "change",
    [
        {"torque": np.zeros((25, 1))},
        {"zmp": np.zeros((24, 2))},
        {"com": np.zeros((25, 3), dtype=np.float32)},
        {"support": np.full(25, 3, dtype=np.int8)},
        {"support": np.zeros(3, dtype=np.int8)},
        {"q": np.empty((0, 27))},
    ],
)
def test_arrays_that_do_not_fit_each_other_are_not_written(
    change: dict[str, Any], melson: Robot, tmp_path: Path
) -> None:
    motion = replace(random_motion(melson), **change)
    with pytest.raises(MotionFileError, match="not written"):
        write_motion(motion, tmp_path / "a.mcap")


def test_writing_takes_little_memory_however_long_the_motion(melson: Robot, tmp_path: Path) -> None:
    motion = random_motion(melson, 20_000)  # a trajectory message of 6.6 MB, 95 MB of messages
    tracemalloc.start()
    write_motion(motion, tmp_path / "a.mcap")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 8e6  # [bytes]; three chunks of samples


# what must be refused


def refused(path: Path) -> str:
    """Message of the MotionFileError that both ways of reading raise."""
    messages = []
    for read in (read_motion, read_info):
        with pytest.raises(MotionFileError, match=path.name) as caught:
            read(path)
        messages.append(str(caught.value))
    assert messages[0] == messages[1]
    return messages[0]


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    assert "no such file" in refused(tmp_path / "a.mcap")


def test_a_folder_is_refused(tmp_path: Path) -> None:
    assert "directory" in refused(tmp_path)


@pytest.mark.parametrize("content", [b"", b"\0", b"q: 1\n" * 100, b"\x89MCAP0\r\n"])
def test_a_file_of_another_format_is_refused(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(content)
    assert "not an MCAP file" in refused(path)


@pytest.mark.parametrize("crcs", [True, False])
@pytest.mark.parametrize("profile", ["", "ros2"])
def test_an_mcap_file_of_others_is_refused(profile: str, crcs: bool, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    writer = mcap.writer.Writer(str(path), enable_crcs=crcs)
    writer.start(profile, "test")
    schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
    writer.add_message(writer.register_channel("/a", "cdr", schema), 1, b"", 1)
    writer.finish()
    assert "not a motion file that mgs wrote" in refused(path)


def test_an_mcap_file_with_nothing_in_it_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    flags = {"repeat_channels": False, "repeat_schemas": False, "use_statistics": False}
    index = mcap.writer.IndexType.NONE
    writer = mcap.writer.Writer(str(path), index_types=index, use_summary_offsets=False, **flags)
    writer.start("ros2", "test")
    writer.finish()
    assert "not a motion file that mgs wrote" in refused(path)


def test_a_file_cut_anywhere_is_refused(tmp_path: Path) -> None:
    path, whole = tmp_path / "a.mcap", small_file()
    for size in itertools.chain(range(40), range(40, len(whole), 97), [len(whole) - 1]):
        path.write_bytes(whole[:size])
        refused(path)


@given(data=st.data())
def test_a_file_with_changed_bytes_is_refused(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    changed = damaged(data)
    path = tmp_path_factory.mktemp("damaged") / "a.mcap"
    path.write_bytes(changed)
    if changed == small_file():
        read_motion(path)
    else:
        refused(path)


@given(data=st.data())
def test_a_forged_file_gives_a_motion_or_is_refused(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("forged") / "a.mcap"
    path.write_bytes(sealed(damaged(data)))
    for read in (read_motion, read_info):
        try:
            read(path)
        except MotionFileError as error:
            assert "a.mcap" in str(error)


def damaged(data: st.DataObject) -> bytes:
    """The small file with some bytes changed, a piece cut out or something put in."""
    content = bytearray(small_file())
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(content) - 1))
        length = data.draw(st.sampled_from([0, 1, 1, 4, 8, 100]))
        content[at : at + length] = data.draw(st.binary(min_size=0, max_size=9))
    return bytes(content)


def sealed(content: bytes) -> bytes:
    """The content with checksums that hold, if it still has its ends."""
    if len(content) < 60:
        return content
    (start,) = struct.unpack_from("<Q", content, len(content) - 28)
    if not 13 <= start <= len(content) - 12:
        return content
    data = content[: start - 4] if start >= 4 else b""
    body = content[: start - 13]
    patched = body + content[start - 13 : start - 4] + struct.pack("<I", zlib.crc32(body))
    assert len(patched) == len(data) + 4
    summary = content[start:-12]
    return patched + summary + struct.pack("<I", zlib.crc32(summary)) + content[-8:]


def replaced(old: bytes, new: bytes) -> bytes:
    """The small file with a text outside the chunks replaced by one of the same length."""
    assert len(old) == len(new)
    assert old in small_file()
    return sealed(small_file().replace(old, new))


def test_sealing_changes_nothing_in_a_sound_file() -> None:
    assert sealed(small_file()) == small_file()


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        (b"ros2" + LIBRARY, b"ros1" + LIBRARY, "not a motion file"),
        (b"/com_reference", b"/com_referance", "/com_reference is missing"),
        (b"/msg/PointStamped", b"/msg/PointStampet", "not geometry_msgs/PointStamped"),
        (b"gait.yaml", b"gate.yaml", "gait.yaml is missing"),
        (b"schema_version\x01\0\0\x003", b"schema_version\x01\0\0\x001", "format '1'"),
        (b"0.0123", b"0.0124", "not in step with dt"),
        (b"0.0123", b"-0.123", "dt"),
        (b"step_length: 0.3", b"step_longth: 0.3", "did you mean 'step_length'"),
        (b"samples\x01\0\0\x003", b"samples\x01\0\0\x004", "has 3 messages, not 4"),
        (b'"clik"', b'"clik,', "not in the layout"),
    ],
)
def test_a_file_with_a_wrong_part_is_refused(
    old: bytes, new: bytes, problem: str, tmp_path: Path
) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(replaced(old, new))
    with pytest.raises(MotionFileError, match=problem):
        read_motion(path)


@pytest.mark.parametrize(
    ("name", "wrong", "problem"),
    [
        ("split_stamps", lambda right, times: right(times + np.uint64(1)), "a stamp in /joint_s"),
        ("stamps_ns", lambda right, n, dt: right(n, dt)[::-1], "not in step with dt"),
        ("link_tree", lambda right, robot: right(load_robot("melson")), "does not fit its topic"),
        ("link_tree", lambda right, r: replace(right(r), root="pelviz"), "not in the layout"),
        ("support_layouts", lambda right: dict.fromkeys(Support, right()[0]), None),
        ("support_layouts", lambda right: {s: SHORT for s in right()}, "/support says"),
    ],
)
def test_messages_that_contradict_the_rest_are_refused(
    name: str, wrong: Any, problem: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, motion = tmp_path / "a.mcap", random_motion(crooked_robot(1))
    right = getattr(motion_file.write, name)
    monkeypatch.setattr(f"mgs.motion_file.write.{name}", functools.partial(wrong, right))
    write_motion(motion, path)
    if problem is None:  # another motion, but a sound one
        assert not read_motion(path).support.any()
    else:
        with pytest.raises(MotionFileError, match=problem):
            read_motion(path)


def test_a_number_of_samples_beyond_the_file_takes_no_memory(
    melson: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.mcap"
    values = motion_file.write.metadata
    monkeypatch.setattr(
        "mgs.motion_file.write.metadata", lambda m: {**values(m), "samples": "1000000000"}
    )
    write_motion(random_motion(melson), path)
    with pytest.raises(MotionFileError, match="has 25 messages, not 1000000000"):
        read_motion(path)
    statistics = motion_file.mcap_writer.Statistics
    monkeypatch.setattr(
        "mgs.motion_file.mcap_writer.Statistics",
        lambda channel_message_counts, **counts: statistics(
            channel_message_counts=dict.fromkeys(channel_message_counts, 10**9), **counts
        ),
    )
    write_motion(random_motion(melson), path, force=True)
    with pytest.raises(MotionFileError, match="too small a file"):
        read_motion(path)
