"""Patterns for hrpsys, matrices for iCub and bags of ROS 2, read by other libraries."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import scipy.io
from hypothesis import given
from hypothesis import strategies as st
from rosbags.highlevel import AnyReader

from mgs.core.errors import MgsError, MotionFileError
from mgs.motion import Motion
from mgs.motion.cycle import find_cycle
from mgs.motion_file import read_motion
from mgs.motion_file.export import export_motion
from mgs.motion_file.formats import FORMATS
from mgs.motion_file.formats.robots.openhrp import quat_of, rpy_of
from mgs.robot.unit import JointCorrection, UnitSpec, unit_of
from tests.support.shipped import generated


@pytest.fixture(scope="module")
def walk() -> Motion:
    return generated("melson/walk_practical").stages.motion


# --- hrpsys --------------------------------------------------------------------------------------


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_roll_pitch_and_yaw_are_those_of_pinocchio(roll: float, pitch: float, yaw: float):
    quat = pin.Quaternion(pin.rpy.rpyToMatrix(roll, pitch, yaw)).coeffs()
    assert np.allclose(rpy_of(quat[None]), [[roll, pitch, yaw]], rtol=0, atol=1e-6)
    again = quat_of(np.array([[roll, pitch, yaw]]))[0]
    assert abs(abs(again @ quat) - 1.0) < 1e-12


def test_a_pattern_holds_joints_waist_and_zmp(walk: Motion, tmp_path: Path):
    """The ZMP is in the frame of the root link: with its pose it is the planned one again."""
    export_motion(walk, tmp_path / "a", "openhrp", fps=100.0)
    assert sorted(p.name for p in (tmp_path / "a").iterdir()) == [
        *("motion.pos", "motion.waist", "motion.zmp"),
    ]
    pos, waist, zmp = (np.loadtxt(tmp_path / f"a/motion.{n}") for n in ("pos", "waist", "zmp"))
    for table in (pos, waist, zmp):
        assert np.allclose(table[:, 0], walk.times, rtol=0, atol=1e-9)
    assert np.abs(pos[:, 1:] - walk.q[:, 7:]).max() < 1e-12
    for k in range(0, walk.n_samples, 37):
        base = pin.SE3(pin.rpy.rpyToMatrix(*waist[k, 4:]), waist[k, 1:4])
        assert base.isApprox(pin.XYZQUATToSE3(walk.q[k, :7]), 1e-9)
        assert np.allclose(base.act(zmp[k, 1:]), [*walk.zmp_ref[k], 0.0], rtol=0, atol=1e-9)


def test_a_pattern_of_a_cycle_is_that_part_of_the_walk(walk: Motion, tmp_path: Path):
    cycle = find_cycle(walk)
    export_motion(walk, tmp_path / "a", "openhrp", cycle, fps=100.0)
    export_motion(walk, tmp_path / "b", "openhrp", fps=100.0)
    part, whole = (np.loadtxt(tmp_path / f"{name}/motion.zmp") for name in "ab")
    assert len(part) == cycle.n_samples
    same = whole[cycle.start : cycle.start + cycle.n_samples, 1:]
    assert np.abs(part[:, 1:] - same).max() < 1e-9


# --- iCub ----------------------------------------------------------------------------------------


def test_a_matrix_is_read_by_matlab_s_rules(walk: Motion, tmp_path: Path):
    export_motion(walk, tmp_path / "a.mat", "blf-mat")
    data = (tmp_path / "a.mat").read_bytes()
    assert data[124:128] == b"\x00\x01IM"  # level 5, little-endian
    found = scipy.io.loadmat(io.BytesIO(data), squeeze_me=True)
    assert found["traj"].dtype == np.float64
    assert np.array_equal(found["traj"], walk.q[:, 7:])
    assert found["joints_list"].tolist() == list(walk.robot.joint_names)
    assert float(found["sampling_time"]) == 0.01


def test_a_matrix_of_somebody_else_has_no_names(tmp_path: Path):
    scipy.io.savemat(tmp_path / "a.mat", {"traj": np.eye(3)})
    recorded = FORMATS["blf-mat"].read(tmp_path / "a.mat")
    assert recorded.joint_names is None and recorded.fps is None
    assert np.array_equal(recorded.joints, np.eye(3))


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"other": np.eye(2)}, "traj is missing"),
        ({"traj": np.ones(3), "joints_list": ["a"]}, "different numbers"),
        ({"traj": np.full((2, 2), np.nan)}, "the value nan"),
        ({"traj": np.eye(2), "sampling_time": -1.0}, "positive number"),
    ],
)
def test_a_damaged_matrix_is_refused(arrays: dict[str, Any], message: str, tmp_path: Path):
    scipy.io.savemat(tmp_path / "a.mat", arrays)
    with pytest.raises(MotionFileError, match=message):
        FORMATS["blf-mat"].read(tmp_path / "a.mat")


@pytest.mark.parametrize("data", [b"", b"MATLAB", bytes(200), b"MATLAB 5.0" + bytes(500)])
def test_what_is_no_matrix_is_refused(data: bytes, tmp_path: Path):
    (tmp_path / "a.mat").write_bytes(data)
    with pytest.raises(MgsError, match=r"a\.mat"):
        FORMATS["blf-mat"].read(tmp_path / "a.mat")


# --- ROS 2 ---------------------------------------------------------------------------------------


def joint_states(bag: Path, topic: str) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Times [s], positions and names of a topic, read by rosbags."""
    times, positions, names = [], [], []
    with AnyReader([bag]) as reader:
        chosen = [c for c in reader.connections if c.topic == topic]
        for connection, stamp, data in reader.messages(connections=chosen):
            message: Any = reader.deserialize(data, connection.msgtype)
            times.append(stamp * 1e-9)
            positions.append(message.position)
            names = list(message.name)
    return np.array(times), np.array(positions), names


def test_a_bag_is_read_by_rosbags(walk: Motion, tmp_path: Path):
    bag = tmp_path / "bag"
    export_motion(walk, bag, "rosbag2")
    assert sorted(p.name for p in bag.iterdir()) == ["metadata.yaml", "motion.mcap"]
    times, positions, names = joint_states(bag, "/joint_states")
    assert names == list(walk.robot.joint_names)
    assert np.array_equal(positions, walk.q[:, 7:])
    assert np.allclose(times - 1.0, walk.times, rtol=0, atol=1e-9)
    with AnyReader([bag]) as reader:
        topics = {c.topic: c for c in reader.connections}
        counted = {c.topic: 0 for c in reader.connections}
        for connection, _, _ in reader.messages():
            counted[connection.topic] += 1
        assert counted == {name: c.msgcount for name, c in topics.items()}
        assert reader.message_count == sum(counted.values())
        assert reader.start_time == 10**9
        assert (reader.duration - 1) * 1e-9 == pytest.approx(walk.duration, abs=1e-8)
        (qos,) = topics["/robot_description"].ext.offered_qos_profiles  # type: ignore[union-attr]
        assert qos.durability.name == "TRANSIENT_LOCAL"
    motion = read_motion(bag / "motion.mcap")
    assert np.array_equal(motion.com, walk.com)


def test_a_bag_at_another_rate_is_a_motion_of_its_own(walk: Motion, tmp_path: Path):
    bag = tmp_path / "bag"
    exported = export_motion(walk, bag, "rosbag2", fps=250.0)
    times, positions, _ = joint_states(bag, "/joint_states")
    assert np.allclose(np.diff(times), 0.004, rtol=0, atol=2e-9)
    assert np.array_equal(positions, exported.sampled.joints)
    motion = read_motion(bag / "motion.mcap")
    assert motion.dt == 0.004
    assert np.abs(np.linalg.norm(motion.soles[..., 3:], axis=-1) - 1.0).max() < 1e-12
    assert np.array_equal(motion.com[::5], walk.com[::2])


def test_a_bag_for_one_robot_has_the_plan_and_its_commands(walk: Motion, tmp_path: Path):
    spec = UnitSpec(
        mgs=1, unit="7", robot="melson", joints={"waist_yaw": JointCorrection(zero_offset=0.1)}
    )
    bag = tmp_path / "bag"
    export_motion(walk, bag, "rosbag2", unit=unit_of(spec, walk.robot))
    _, plan, _ = joint_states(bag, "/joint_states")
    assert np.array_equal(plan, walk.q[:, 7:])
    _, commands, names = joint_states(bag, "/joint_commands/corrected")
    offset = np.where([name == "waist_yaw" for name in names], 0.1, 0.0)
    assert np.abs(commands + offset - plan).max() < 1e-12
