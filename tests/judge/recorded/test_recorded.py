"""Motions of others on a robot: layouts, quaternions, joints, the base, supports."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from clean_motions import shipped

import mgs
from mgs.core.errors import ConfigError
from mgs.judge.motion_checks import TRACKING, check_motion
from mgs.judge.recorded import Choices, layouts, motion_of, read_placed
from mgs.motion.sampled import sample
from mgs.motion_file import read_motion, write_motion
from mgs.motion_file.formats import FORMATS, Options
from mgs.robot import load_robot
from mgs.robot.orders import robot_order

NOT_HERE = {"protomotions": "torch", "rosbag2": "rosbags"}  # layouts that need more than mgs
HAVE_BASE = ("unitree-csv", "beyondmimic", "mjlab", "holosoma", "gmr", "locomujoco", "isaaclab-amp")


def exported(name: str, layout: str, folder: Path) -> Path:
    """A shipped gait in a layout."""
    entry = FORMATS[layout]
    path = folder / f"motion{entry.suffix}"
    entry.write(sample(shipped(name), entry.fps), path, Options())
    return path


@pytest.mark.parametrize("layout", HAVE_BASE)
@pytest.mark.parametrize("name", ["melson/walk_arc", "coman/walk_arc"])
def test_an_export_is_recognised_and_passes_the_checks_of_its_motion(
    layout: str, name: str, tmp_path: Path
):
    path, fps = exported(name, layout, tmp_path), FORMATS[layout].fps
    robot = load_robot(name.partition("/")[0])
    found, placed = read_placed(path, robot, None, Choices(fps=fps or 30.0))
    assert found == layout
    expected = sample(shipped(name), fps or (30.0 if layout == "unitree-csv" else None))
    gap = np.abs(placed.given.q[:, 7:] - expected.joints).max()
    assert gap < 1e-6  # single precision
    motion = motion_of(placed, found, path.name, mgs.__version__, "imported")
    checks = {check.name: check for check in check_motion(motion)}
    assert all(check.ok for check in checks.values()), [c for c in checks.values() if not c.ok]
    assert not set(checks) & set(TRACKING)
    target = tmp_path / "imported.mcap"
    write_motion(motion, target)
    again = read_motion(target)
    assert again.gait.motion == "recorded"
    np.testing.assert_array_equal(again.q, motion.q)


def test_the_base_is_found_from_the_contacts_of_the_soles(tmp_path: Path):
    """Joints alone: a walk goes the way that it was planned to go."""
    motion = shipped("melson/walk_arc")
    path = exported("melson/walk_arc", "csv", tmp_path)
    _, placed = read_placed(path, motion.robot, None, Choices())
    assert placed.base == "contacts"
    np.testing.assert_allclose(placed.given.q[:, :3], motion.q[:, :3], atol=2e-3)  # [m], 8 steps
    dots = np.abs(np.sum(placed.given.q[:, 3:7] * motion.q[:, 3:7], axis=1))
    np.testing.assert_allclose(dots, 1.0, atol=1e-5)


@pytest.mark.parametrize("roll", [0, 1])
def test_the_order_of_quaternions_is_found_by_how_the_robot_stands(roll: int, tmp_path: Path):
    motion = shipped("melson/walk_arc")
    q = motion.q.copy()
    q[:, 3:7] = np.roll(q[:, 3:7], roll, axis=1)  # 1: scalar part first, as Kimodo writes it
    path = tmp_path / "walk.csv"
    np.savetxt(path, np.hstack([q[:, :7], _depth_first(motion)]), delimiter=",")
    layout, placed = read_placed(path, motion.robot, None, Choices(fps=100.0))
    assert layout == "unitree-csv"
    assert any(("wxyz, not xyzw" in note) == bool(roll) for note in placed.notes if "quat" in note)
    np.testing.assert_allclose(placed.given.q[:, 3:7], motion.q[:, 3:7], atol=1e-9)


def _depth_first(motion: mgs.Motion) -> np.ndarray:

    names = robot_order(motion.robot, "depth-first").joints
    return motion.q[:, [7 + motion.robot.joint_names.index(name) for name in names]]


def test_a_rate_that_the_file_does_not_state_is_asked_for(tmp_path: Path):
    path = exported("melson/walk_arc", "unitree-csv", tmp_path)
    with pytest.raises(ConfigError, match="--fps"):
        read_placed(path, load_robot("melson"), None, Choices())


def test_an_order_of_quaternions_that_cannot_be_found_out_is_asked_for(tmp_path: Path):
    """Half way between both: the robot lies still on its side, which no order makes standing."""
    robot = load_robot("melson")
    q = np.tile(robot.standing_q, (50, 1))
    q[:, 3:7] = [0.5, 0.5, 0.5, 0.5]
    path = tmp_path / "still.csv"
    np.savetxt(path, q, delimiter=",")
    with pytest.raises(ConfigError, match="--quaternion xyzw"):
        read_placed(path, robot, "unitree-csv", Choices(fps=50.0))
    _, placed = read_placed(path, robot, "unitree-csv", Choices(fps=50.0, quaternion="wxyz"))
    assert "quaternions taken wxyz, as asked for" in placed.notes


def test_a_table_with_names_of_joints_keeps_the_others_in_the_posture(tmp_path: Path):
    robot = load_robot("melson")
    path = tmp_path / "named.csv"
    angle = robot.posture[robot.joint_names.index("left_knee_pitch")] + 0.1
    lines = ["time,left_knee_pitch,tail", *(f"{0.02 * k:g},{angle},0.5" for k in range(30))]
    path.write_text("\n".join(lines))
    layout, placed = read_placed(path, robot, None, Choices())
    assert layout == "joint-table"
    told = " ".join(placed.notes)
    assert "left out: tail" in told and "half-sitting posture: left_hip_yaw" in told
    joints = placed.given.q[:, 7:]
    changed = joints[0] != robot.posture
    assert [robot.joint_names[j] for j in np.flatnonzero(changed)] == ["left_knee_pitch"]


def test_joints_without_names_are_taken_in_the_order_that_is_asked_for(tmp_path: Path):
    """A table of Isaac Lab's order in a layout that is depth first by itself."""
    motion = shipped("melson/walk_arc")
    names = robot_order(motion.robot, "breadth-first").joints
    columns = [7 + motion.robot.joint_names.index(name) for name in names]
    path = tmp_path / "walk.csv"
    np.savetxt(path, np.hstack([motion.q[:, :7], motion.q[:, columns]]), delimiter=",")
    choices = Choices(fps=100.0, order="breadth-first")
    _, placed = read_placed(path, motion.robot, "unitree-csv", choices)
    np.testing.assert_allclose(placed.given.q, motion.q, atol=1e-12)
    told = "the joints without names are taken breadth-first: waist_yaw, left_hip_yaw, ..."
    assert told in placed.notes


def test_angles_in_degrees_are_refused(tmp_path: Path):
    """A knee of 50 degrees is no knee of 50 rad; one damaged frame is for an audit to tell."""
    motion = shipped("melson/walk_arc")
    head = "time," + ",".join(motion.robot.joint_names)
    path = tmp_path / "walk.csv"
    table = np.column_stack([motion.times, np.rad2deg(motion.q[:, 7:])])
    np.savetxt(path, table, delimiter=",", header=head, comments="")
    for layout in (None, "joint-table"):
        with pytest.raises(ConfigError, match=r"beyond its range .* degrees, add --degrees"):
            read_placed(path, motion.robot, layout, Choices())
    table = np.column_stack([motion.times, motion.q[:, 7:]])
    table[7, 4] = 50.0
    np.savetxt(path, table, delimiter=",", header=head, comments="")
    _, placed = read_placed(path, motion.robot, None, Choices())
    assert placed.given.q[7, 10] == 50.0


def test_an_order_is_not_needed_where_joints_have_names(tmp_path: Path):
    path = exported("melson/walk_arc", "mjlab", tmp_path)
    robot = load_robot("melson")
    _, asked = read_placed(path, robot, "mjlab", Choices(order="breadth-first"))
    _, expected = read_placed(path, robot, "mjlab", Choices())
    np.testing.assert_array_equal(asked.given.q, expected.given.q)
    assert "the file names its joints: no order is needed" in asked.notes


def test_what_is_missing_is_asked_for_without_the_layouts_that_do_not_fit(tmp_path: Path):
    path = exported("melson/walk_arc", "unitree-csv", tmp_path)
    with pytest.raises(ConfigError) as caught:
        read_placed(path, load_robot("melson"), None, Choices())
    (told,) = str(caught.value).splitlines()
    assert told.startswith(f"{path}: as unitree-csv: the file states no rate; give it with --fps")


def test_an_ending_of_no_layout_is_told(tmp_path: Path):
    path = tmp_path / "walk.mjlab"
    path.write_bytes(b"")
    with pytest.raises(ConfigError, match=r"files of no layout end in '\.mjlab'; say which"):
        read_placed(path, load_robot("melson"), None, Choices())
    path = tmp_path / "walk"
    path.write_bytes(b"")
    with pytest.raises(ConfigError, match="files of no layout have no ending; say which"):
        read_placed(path, load_robot("melson"), None, Choices())


def test_a_file_of_another_robot_is_refused_with_the_reason(tmp_path: Path):
    path = exported("melson/walk_arc", "unitree-csv", tmp_path)
    with pytest.raises(ConfigError, match="19 joints without names, robot coman has 29"):
        read_placed(path, load_robot("coman"), None, Choices(fps=30.0))


def test_every_readable_layout_can_be_named():
    assert set(HAVE_BASE) < set(layouts())
