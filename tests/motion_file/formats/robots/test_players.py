"""Files for motion players of robots, decoded by general libraries as each player decodes them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.errors import ConfigError, MgsError, MotionFileError
from mgs.motion import Motion
from mgs.motion.cycle import find_cycle
from mgs.motion_file.export import Exported, export_motion
from mgs.motion_file.formats import FORMATS, Options
from mgs.motion_file.formats.robots.flow_text import number
from mgs.motion_file.formats.robots.nubots import SERVOS
from tests.support.bus_robots import motion_for
from tests.support.shipped import generated

FPS = 12.5  # [Hz] of most tests, so that PyYAML reads their files quickly
APPROACH = 1.5  # [s]


@pytest.fixture(scope="module")
def walk() -> Motion:
    return generated("melson/walk_practical").stages.motion


def exported(walk: Motion, fmt: str, path: Path, **changes: Any) -> Exported:
    options = Options(approach=APPROACH, remarks=("a remark: with a colon",))
    return export_motion(motion_for(fmt, walk), path, fmt, options=options, **changes)


def floats(value: Any) -> list[float]:
    """All numbers in nested lists; none may be a whole number or a text."""
    if isinstance(value, list):
        return [x for entry in value for x in floats(entry)]
    assert type(value) is float
    return [value]


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_is_the_same_number_in_json_and_in_yaml(value: float):
    text = number(value)
    assert json.loads(text) == value
    found = yaml.safe_load(text)  # YAML 1.1, as most programs on robots read it
    assert type(found) is float and found == value


# --- ros2_control ------------------------------------------------------------------------------


def test_a_controller_accepts_the_trajectory(walk: Motion, tmp_path: Path):
    """What joint_trajectory_controller checks: lengths, rising times, rest at the end."""
    written = exported(walk, "jtc", tmp_path / "a.yaml", fps=FPS)
    found = yaml.safe_load((tmp_path / "a.yaml").read_text())
    assert sorted(found) == ["joint_names", "points"]
    assert found["joint_names"] == list(walk.robot.joint_names)
    points = found["points"]
    times = [p["time_from_start"]["sec"] * 10**9 + p["time_from_start"]["nanosec"] for p in points]
    assert times[0] == 0 and np.all(np.diff(times) > 0)
    assert np.allclose(np.array(times) * 1e-9, written.sampled.times, rtol=0, atol=1e-9)
    for key, values in (
        ("positions", written.sampled.joints),
        ("velocities", written.sampled.joint_velocity),
        ("accelerations", written.sampled.joint_acceleration),
    ):
        table = np.array([floats(point[key]) for point in points])
        assert np.array_equal(table, values), key
    assert not np.any(points[0]["velocities"]) and not np.any(points[-1]["velocities"])


def test_the_trajectory_is_a_message_of_ros(walk: Motion, tmp_path: Path):
    """Its fields fill trajectory_msgs/JointTrajectory, by the definitions of rosbags."""
    from rosbags.typesys import Stores, get_typestore

    types: Any = get_typestore(Stores.ROS2_HUMBLE)
    exported(walk, "jtc", tmp_path / "a.yaml", fps=FPS)
    found = yaml.safe_load((tmp_path / "a.yaml").read_text())
    point, time = (
        types.types[name]
        for name in ("trajectory_msgs/msg/JointTrajectoryPoint", "builtin_interfaces/msg/Duration")
    )
    header = types.types["std_msgs/msg/Header"](
        stamp=types.types["builtin_interfaces/msg/Time"](0, 0), frame_id=""
    )
    points = [
        point(
            **{k: np.array(p[k]) for k in ("positions", "velocities", "accelerations")},
            effort=np.zeros(0),
            time_from_start=time(**p["time_from_start"]),
        )
        for p in found["points"]
    ]
    kind = "trajectory_msgs/msg/JointTrajectory"
    message = types.types[kind](header, found["joint_names"], points)
    again = types.deserialize_cdr(types.serialize_cdr(message, kind), kind)
    assert again.joint_names == list(walk.robot.joint_names)
    assert np.array_equal(again.points[-1].positions, walk.q[-1, 7:])


@pytest.mark.parametrize("fmt", ["jtc", "play-motion2", "rosbag2"])
def test_a_cycle_that_never_rests_is_refused(walk: Motion, fmt: str, tmp_path: Path):
    with pytest.raises(ConfigError, match=f"format {fmt} holds whole motions"):
        export_motion(walk, tmp_path / "a", fmt, find_cycle(walk))
    assert list(tmp_path.iterdir()) == []


def test_parameters_of_play_motion2_have_the_types_that_its_node_demands(
    walk: Motion, tmp_path: Path
):
    """String array, double array, double array, and positions for each joint and time."""
    written = exported(walk, "play-motion2", tmp_path / "a.yaml", fps=FPS)
    tree = yaml.safe_load((tmp_path / "a.yaml").read_text())
    motions = tree["/play_motion2"]["ros__parameters"]["motions"]
    (name,) = motions
    assert name == "melson_walk_practical"  # a point or a slash would be a level of parameters
    motion = motions[name]
    assert motion["joints"] == list(walk.robot.joint_names)
    positions, times = floats(motion["positions"]), floats(motion["times_from_start"])
    assert len(positions) == len(times) * len(motion["joints"])
    assert np.array_equal(np.reshape(positions, (len(times), -1)), written.sampled.joints)
    assert np.array_equal(times, written.sampled.times)
    assert "a remark: with a colon" in motion["meta"]["description"]


# --- teams of the RoboCup -----------------------------------------------------------------------


def rest_to_rest(s: np.ndarray) -> np.ndarray:
    """Polynomial of the fifth degree from 0 to 1 without speed or acceleration at its ends."""
    return 10 * s**3 - 15 * s**4 + 6 * s**5


def test_an_animation_of_the_bit_bots_is_played_as_planned(walk: Motion, tmp_path: Path):
    """The oracle is their player: keyframes in degrees, one polynomial between two of them."""
    written = exported(walk, "bitbots", tmp_path / "a.json")
    found = json.loads((tmp_path / "a.json").read_text())
    assert {"name", "author", "description", "version", "last_edited", "keyframes"} == set(found)
    frames = found["keyframes"]
    at = np.cumsum([frame["duration"] + frame["pause"] for frame in frames]) - APPROACH
    assert np.allclose(at, walk.times, rtol=0, atol=1e-9)
    names = walk.robot.joint_names
    goals = np.radians([[frame["goals"][name] for name in names] for frame in frames])
    assert np.abs(goals - walk.q[:, 7:]).max() < 1e-12
    # joints between two frames, against the spline through the planned samples
    times = np.arange(0.0, walk.duration, 0.003)
    k = np.minimum((times / walk.dt).astype(int), len(at) - 2)
    s = rest_to_rest((times - at[k]) / walk.dt)[:, None]
    played = goals[k] + s * (goals[k + 1] - goals[k])
    from mgs.core.spline import evaluate, spline_at_rest

    plan, _, _ = evaluate(spline_at_rest(walk.q[:, 7:], walk.dt), times)
    _, note = written.written.notes  # the first one is the remark
    told = float(re.search(r"at most ([\d.e-]+) rad", note).group(1))  # type: ignore[union-attr]
    worst = np.abs(played - plan).max()
    assert 0.8 * told < worst < 1.02 * told


def test_a_script_of_the_nubots_has_whole_milliseconds_and_their_servos(
    walk: Motion, tmp_path: Path
):
    written = exported(walk, "nubots", tmp_path / "a.yaml", fps=FPS)
    frames = yaml.safe_load((tmp_path / "a.yaml").read_text())
    durations = [frame["duration"] for frame in frames]
    assert all(type(duration) is int for duration in durations)
    at = np.cumsum(durations) * 1e-3 - APPROACH
    assert np.abs(at - written.sampled.times).max() <= 0.5e-3 + 1e-9
    motors = motion_for("nubots", walk).robot.spec.motors
    for frame, row in zip(frames, written.sampled.joints, strict=True):
        targets = {target["id"]: target for target in frame["targets"]}
        assert all(set(t) == {"id", "position", "gain", "torque"} for t in targets.values())
        for name, angle in zip(walk.robot.joint_names, row, strict=True):
            servo = targets[SERVOS[motors[name].id - 1]]
            assert type(servo["position"]) is float and servo["position"] == angle


def test_servos_of_the_nubots_are_numbered_as_on_their_robots():
    """From their ServoID: right before left, from shoulders to feet, then the head."""
    assert len(SERVOS) == 20
    assert [SERVOS[k] for k in (0, 1, 4, 6, 13, 17)] == [
        *("R_SHOULDER_PITCH", "L_SHOULDER_PITCH", "R_ELBOW", "R_HIP_YAW", "L_KNEE"),
        "L_ANKLE_ROLL",
    ]
    assert SERVOS[18:] == ("HEAD_YAW", "HEAD_PITCH")


def test_a_motion_of_the_hulks_has_every_field_of_their_robot(walk: Motion, tmp_path: Path):
    """Their reader refuses a file that lacks one; numbers become single precision."""
    motion = motion_for("hulks", walk)
    written = exported(walk, "hulks", tmp_path / "a.json")
    found = json.loads((tmp_path / "a.json").read_text())
    assert found["interpolation_mode"] == "linear"
    ((keyframes),) = [part["keyframes"] for part in found["motion"]]
    arm = {"shoulder_pitch", "shoulder_roll", "elbow_yaw", "elbow_roll", "wrist_yaw", "hand"}
    leg = {"hip_yaw_pitch", "hip_roll", "hip_pitch", "knee_pitch", "ankle_pitch", "ankle_roll"}
    fields = {"head": {"yaw", "pitch"}, "left_arm": arm, "right_arm": arm}
    fields |= {"left_leg": leg, "right_leg": leg}
    postures = [found["initial_positions"], *(frame["positions"] for frame in keyframes)]
    for posture in postures:
        assert {limb: set(joints) for limb, joints in posture.items()} == fields
    durations = [frame["duration"] for frame in keyframes]
    assert np.allclose(np.cumsum([0.0, *durations]), written.sampled.times, rtol=0, atol=1e-9)
    for joint, (limb, field) in {
        "LHipYawPitch": ("left_leg", "hip_yaw_pitch"),
        "RKneePitch": ("right_leg", "knee_pitch"),
        "LElbowRoll": ("left_arm", "elbow_roll"),
        "HeadYaw": ("head", "yaw"),
    }.items():
        column = [posture[limb][field] for posture in postures]
        j = motion.robot.joint_names.index(joint)
        assert np.array_equal(column, written.sampled.joints[:, j]), joint
        singles = np.float32(column)
        assert np.abs(singles - written.sampled.joints[:, j]).max() < 2e-7
    assert {posture["left_arm"]["hand"] for posture in postures} == {0.0}


def test_a_robot_without_the_joints_of_nao_is_refused(walk: Motion, tmp_path: Path):
    with pytest.raises(ConfigError, match="'left_hip_yaw' is no joint of NAO"):
        export_motion(walk, tmp_path / "a.json", "hulks")
    arms = tuple(n for n in motion_for("hulks", walk).robot.joint_names if "Elbow" in n)
    with pytest.raises(ConfigError, match="no joint is left_leg hip_yaw_pitch of NAO"):
        export_motion(
            motion_for("hulks", walk), tmp_path / "a.json", "hulks", options=Options(joints=arms)
        )


# --- NAO and Webots ------------------------------------------------------------------------------


def test_lists_for_naoqi_have_what_almotion_demands(walk: Motion, tmp_path: Path):
    """One list of angles and one of times for each name; times rise, and none is 0."""
    written = exported(walk, "naoqi", tmp_path / "a.json")
    found = json.loads((tmp_path / "a.json").read_text())
    assert found["isAbsolute"] is True
    assert len(found["names"]) == len(found["angleLists"]) == len(found["timeLists"]) == 19
    for j in range(19):
        times, angles = found["timeLists"][j], found["angleLists"][j]
        assert times[0] == APPROACH and np.all(np.diff(times) > 0)
        assert np.allclose(np.array(times) - APPROACH, written.sampled.times, rtol=0, atol=1e-9)
        assert angles == written.sampled.joints[:, j].tolist()


def test_a_motion_of_webots_has_its_form(walk: Motion, tmp_path: Path):
    written = exported(walk, "webots", tmp_path / "a.motion")
    head, *lines = (tmp_path / "a.motion").read_text().splitlines()
    assert head == ",".join(["#WEBOTS_MOTION", "V1.0", *walk.robot.joint_names])
    form = re.compile(r"(\d\d):(\d\d):(\d{3}),Pose(\d+),(.+)")
    for k, (line, row) in enumerate(zip(lines, written.sampled.joints, strict=True)):
        found = form.fullmatch(line)
        assert found is not None, line
        minutes, seconds, milliseconds, pose = map(int, found.groups()[:4])
        time = 60.0 * minutes + seconds + 1e-3 * milliseconds
        assert abs(time - written.sampled.times[k]) <= 0.5e-3 + 1e-9
        assert pose == k + 1 and seconds < 60
        assert [float(x) for x in found[5].split(",")] == row.tolist()


@pytest.mark.parametrize("fmt", ["webots", "nubots"])
def test_frames_less_than_a_millisecond_apart_are_refused(walk: Motion, fmt: str, tmp_path: Path):
    with pytest.raises(ConfigError, match="use at most 1000 Hz"):
        exported(walk, fmt, tmp_path / "a", fps=1500.0)


@pytest.mark.parametrize("fmt", ["webots", "naoqi", "hulks", "bitbots", "nubots"])
def test_a_cycle_ends_with_its_first_frame(walk: Motion, fmt: str, tmp_path: Path):
    motion = motion_for(fmt, walk)
    found = find_cycle(motion)
    written = export_motion(motion, tmp_path / "a", fmt, found)
    recorded = FORMATS[fmt].read(tmp_path / "a", motion.robot)
    assert np.array_equal(recorded.joints[0], recorded.joints[-1])
    assert recorded.n_frames == written.sampled.n_frames
    period = (recorded.n_frames - 1) / (recorded.fps or np.nan)
    assert period == pytest.approx(found.n_samples * motion.dt, abs=1.1e-3)


# --- files of others -----------------------------------------------------------------------------

GOOD: dict[str, str] = {
    "jtc": '{"joint_names": ["a"], "points": [{"positions": [1.0], "time_from_start": {"sec": 0}}, '
    '{"positions": [2], "time_from_start": {"nanosec": 20000000}}]}',
    "play-motion2": "/play_motion2:\n  ros__parameters:\n    motions:\n      wave:\n"
    "        joints: [a]\n        positions: [1.0, 2.0]\n        times_from_start: [0.0, 0.02]\n",
    "bitbots": '{"keyframes": [{"duration": 1, "goals": {"a": 57.29577951308232}}, '
    '{"duration": 0.02, "goals": {"a": 114.59155902616465}}]}',
    "nubots": "- duration: 500\n  targets:\n    - {id: R_KNEE, position: 1.0, gain: 30}\n"
    "- duration: 20\n  targets:\n    - {id: R_KNEE, position: 2.0, gain: 30}\n",
    "naoqi": '{"names": ["a"], "angleLists": [[1.0, 2.0]], "timeLists": [[1.0, 1.02]]}',
    "webots": "#WEBOTS_MOTION,V1.0,a\n00:00:000,Pose1,1.0\n00:00:020,Pose2,2.0\n",
}  # fmt: skip


@pytest.mark.parametrize("fmt", GOOD)
def test_a_file_of_somebody_else_is_read(fmt: str, tmp_path: Path):
    path = tmp_path / "a"
    path.write_text(GOOD[fmt])
    recorded = FORMATS[fmt].read(path)
    assert np.allclose(recorded.joints, [[1.0], [2.0]], rtol=0, atol=1e-12)
    assert recorded.fps == pytest.approx(50.0)
    assert recorded.joint_names == (None if fmt == "nubots" else ("a",))


BAD = [
    ("jtc", "{}", "should have the keys joint_names and points"),
    ("jtc", '{"joint_names": ["a"], "points": [1]}', "points should be mappings"),
    ("jtc", '{"joint_names": ["a"], "points": []}', "0 frames"),
    ("jtc", '{"joint_names": ["a"], "points": [{"positions": [1]}]}', "array of numbers"),
    ("jtc", '{"joint_names": ["a", "a"], "points": []}', "same name twice"),
    ("jtc", "[" * 100_000, "nested|not"),
    ("play-motion2", "a: 1", "should have one motion"),
    ("play-motion2", GOOD["play-motion2"].replace("[0.0, 0.02]", "[0.0]"), "shape"),
    ("bitbots", '{"keyframes": []}', "goals"),
    ("bitbots", '{"keyframes": [{"goals": {"a": 1}}, {"goals": {"b": 1}}]}', "same joints"),
    ("bitbots", GOOD["bitbots"].replace('"duration": 1,', '"duration": 1, "pause": 2,'), "pauses"),
    ("nubots", "a: 1", "list of frames"),
    ("nubots", "- duration: 20", "targets should be a list"),
    ("naoqi", "[]", "names, angleLists and timeLists"),
    ("naoqi", '{"names": ["a"], "angleLists": [[1]], "timeLists": [[1, 2]]}', "different times"),
    ("webots", "#WEBOTS_MOTION,V2.0,a\n", "first line"),
    ("webots", "#WEBOTS_MOTION,V1.0,a\n0:0,Pose1,1\n", "minutes:seconds:milliseconds"),
    ("webots", "#WEBOTS_MOTION,V1.0,a\n00:00:000,Pose1,*\n", "1 angles"),
    ("webots", "#WEBOTS_MOTION,V1.0,a\n00:00:000,Pose1,nan\n", "the value nan"),
    ("hulks", '{"motion": [{"keyframes": [1]}]}', "keyframes"),
    ("hulks", '{"motion": [{"keyframes": [{"duration": 1}]}]}', "array of numbers"),
]


@pytest.mark.parametrize(("fmt", "text", "message"), BAD)
def test_a_malformed_file_is_refused_with_its_name(
    fmt: str, text: str, message: str, tmp_path: Path
):
    path = tmp_path / "a"
    path.write_text(text)
    with pytest.raises(MgsError, match=message) as refused:
        FORMATS[fmt].read(path)
    assert isinstance(refused.value, MotionFileError | ConfigError)
    assert str(path) in str(refused.value)
