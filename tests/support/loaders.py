"""Loaders of trainers, written anew from what these programs do with a file.

Each one takes a path and gives what the trainer has afterwards. They share no code with mgs, so
they are oracles of its writers; `tests.support.consumers` has the trainers' own loaders, where they
are installed.
"""

from __future__ import annotations

import csv
import json
import pickle
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

WXYZ_FROM_XYZW = [3, 0, 1, 2]
XYZW_FROM_WXYZ = [1, 2, 3, 0]


@dataclass
class Loaded:
    """Motion in the words of MuJoCo: root, joints and links in the order of the trainer."""

    fps: float
    root: np.ndarray  # (T, 7) x, y, z, quaternion w, x, y, z
    joints: np.ndarray  # (T, J)
    joint_velocity: np.ndarray | None = None
    position: np.ndarray | None = None  # (T, B, 3)
    quat_wxyz: np.ndarray | None = None  # (T, B, 4)
    velocity: np.ndarray | None = None  # (T, B, 3)
    angular_velocity: np.ndarray | None = None  # (T, B, 3)
    root_velocity: np.ndarray | None = None  # (T, 6) in the world, linear first
    joint_names: list[str] | None = None
    link_names: list[str] | None = None


def tracking_npz(path: Path) -> Loaded:
    """MotionLoader of whole_body_tracking and of mjlab: seven arrays, taken by index."""
    with np.load(path, allow_pickle=False) as data:
        found = {key: data[key] for key in data.files}
    for key in ("joint_pos", "joint_vel", "body_pos_w", "body_quat_w", "body_lin_vel_w"):
        assert found[key].dtype == np.float32, key
    assert found["fps"].shape == (1,)
    root = np.concatenate([found["body_pos_w"][:, 0], found["body_quat_w"][:, 0]], axis=1)
    return Loaded(
        float(found["fps"][0]), root, found["joint_pos"], found["joint_vel"],
        found["body_pos_w"], found["body_quat_w"], found["body_lin_vel_w"],
        found["body_ang_vel_w"],
    )  # fmt: skip


def holosoma_npz(path: Path) -> Loaded:
    """MotionLoader of holosoma: joints and links by name, the root's part of the joints skipped."""
    with np.load(path, allow_pickle=False) as data:
        found = {key: data[key] for key in data.files}
    names, links = found["joint_names"].tolist(), found["body_names"].tolist()
    assert found["joint_pos"].shape[1] == len(names) + 7
    assert found["joint_vel"].shape[1] == len(names) + 6
    assert found["body_pos_w"].shape[1] == len(links)
    return Loaded(
        float(found["fps"][0]), found["joint_pos"][:, :7], found["joint_pos"][:, 7:],
        found["joint_vel"][:, 6:], found["body_pos_w"], found["body_quat_w"],
        found["body_lin_vel_w"], found["body_ang_vel_w"],
        joint_names=names, link_names=links,
    )  # fmt: skip


def isaaclab_amp_npz(path: Path) -> Loaded:
    """MotionLoader of Isaac Lab's AMP tasks: everything by name."""
    with np.load(path, allow_pickle=False) as data:
        found = {key: data[key] for key in data.files}
    assert found["fps"].shape == () and found["fps"].dtype == np.int64
    names, links = found["dof_names"].tolist(), found["body_names"].tolist()
    position, quat = found["body_positions"], found["body_rotations"]
    return Loaded(
        float(found["fps"]), np.concatenate([position[:, 0], quat[:, 0]], axis=1),
        found["dof_positions"], found["dof_velocities"], position, quat,
        found["body_linear_velocities"], found["body_angular_velocities"],
        joint_names=names, link_names=links,
    )  # fmt: skip


def locomujoco_npz(path: Path) -> Loaded:
    """Trajectory.load of LocoMuJoCo: known keys only, qpos and qvel as MuJoCo has them."""
    known = {"joint_names", "frequency", "njnt", "jnt_type", "qpos", "qvel", "split_points"}
    with np.load(path, allow_pickle=False) as data:
        assert set(data.files) <= known
        found = {key: data[key] for key in data.files}
    names = found["joint_names"].tolist()
    assert int(found["njnt"]) == len(names) == len(found["jnt_type"])
    assert found["jnt_type"].tolist() == [0] + [3] * (len(names) - 1)
    assert found["split_points"].tolist() == [0, len(found["qpos"])]
    turning = rotate_wxyz(found["qpos"][:, 3:7], found["qvel"][:, 3:6])
    return Loaded(
        float(found["frequency"]), found["qpos"][:, :7], found["qpos"][:, 7:],
        found["qvel"][:, 6:], joint_names=names[1:],
        root_velocity=np.concatenate([found["qvel"][:, :3], turning], axis=1),
    )  # fmt: skip


def unitree_csv(path: Path) -> Loaded:
    """csv_to_npz of whole_body_tracking and mjlab; the rate is 30 unless the user says another."""
    motion = np.loadtxt(path, delimiter=",")
    root = np.concatenate([motion[:, :3], motion[:, 3:7][:, WXYZ_FROM_XYZW]], axis=1)
    return Loaded(30.0, root, motion[:, 7:])


def gmr_pickle(path: Path) -> Loaded:
    """load_robot_motion of GMR."""
    found = pickle.loads(path.read_bytes())
    root = np.concatenate([found["root_pos"], found["root_rot"][:, WXYZ_FROM_XYZW]], axis=1)
    local = found["local_body_pos"]
    turn = np.broadcast_to(root[:, None, 3:], (*local.shape[:2], 4))
    return Loaded(
        found["fps"], root, found["dof_pos"], link_names=found["link_body_list"],
        position=root[:, None, :3] + rotate_wxyz(turn, local),
    )  # fmt: skip


def motion_lib_pickle(path: Path) -> tuple[Loaded, dict[str, Any]]:
    """Motion library of PHC: the root from pose_aa, which is what it computes links from."""
    ((_, entry),) = pickle.loads(path.read_bytes()).items()
    assert isinstance(entry["fps"], int)
    assert entry["pose_aa"].shape == (len(entry["dof"]), 1 + entry["dof"].shape[1], 3)
    root = np.concatenate(
        [entry["root_trans_offset"], entry["root_rot"][:, WXYZ_FROM_XYZW]], axis=1
    )
    return Loaded(entry["fps"], root, entry["dof"]), entry


def sonic_folder(path: Path) -> Loaded:
    """MotionDataReader of GR00T SONIC, which takes 50 Hz."""

    def table(name: str, width: int) -> np.ndarray:
        with (path / name).open(newline="") as stream:
            head, *rows = csv.reader(stream)
        assert len(head) == len(rows[0])
        found = np.array(rows, dtype=float)
        return found.reshape(len(rows), -1, width) if width > 1 else found

    lines = (path / "metadata.txt").read_text().splitlines()
    after = lines[next(k for k, line in enumerate(lines) if "Body part indexes:" in line) + 1]
    indexes = [int(number) for number in re.findall(r"\d+", after)]
    position, quat = table("body_pos.csv", 3), table("body_quat.csv", 4)
    assert indexes == list(range(position.shape[1]))
    return Loaded(
        50.0, np.concatenate([position[:, 0], quat[:, 0]], axis=1), table("joint_pos.csv", 1),
        table("joint_vel.csv", 1), position, quat, table("body_lin_vel.csv", 3),
        table("body_ang_vel.csv", 3),
    )  # fmt: skip


def amp_json(path: Path, joints: int) -> Loaded:
    """AMPLoader with the sizes of a humanoid: columns by place, root velocities turned."""
    content = json.loads(path.read_text())
    frames = np.array(content["Frames"])
    assert frames.shape[1] == 7 + joints + 6 + 6 + joints + 6
    root = np.concatenate([frames[:, :3], frames[:, 3:7][:, WXYZ_FROM_XYZW]], axis=1)
    at = 7 + joints + 6
    velocity = [rotate_wxyz(root[:, 3:], frames[:, at + k : at + k + 3]) for k in (0, 3)]
    at += 6
    return Loaded(
        1.0 / float(content["FrameDuration"]), root, frames[:, 7 : 7 + joints],
        frames[:, at : at + joints], root_velocity=np.concatenate(velocity, axis=1),
        joint_names=content["Joints"],
    )  # fmt: skip


def open_duck_json(path: Path) -> tuple[Loaded, dict[str, Any]]:
    """fit_poly of Open Duck: columns between the offsets of neighbours; all of one period."""
    content = json.loads(path.read_text())
    frames, offsets = np.array(content["Frames"]), content["Frame_offset"][0]

    def between(first: str, last: str) -> np.ndarray:
        return frames[:, offsets[first] : offsets[last]]

    quat = between("root_quat", "joints_pos")[:, WXYZ_FROM_XYZW]
    loaded = Loaded(
        content["FPS"], np.concatenate([between("root_pos", "root_quat"), quat], axis=1),
        between("joints_pos", "left_toe_pos"), between("joints_vel", "left_toe_vel"),
        root_velocity=between("world_linear_vel", "joints_vel"), joint_names=content["Joints"],
    )  # fmt: skip
    contacts = frames[:, offsets["foot_contacts"] : offsets["foot_contacts"] + 2]
    return loaded, {**content, "contacts": contacts}


def rotate_wxyz(quat: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Vectors turned by quaternions w, x, y, z."""
    w, xyz = quat[..., :1], quat[..., 1:]
    return vector + 2.0 * np.cross(xyz, np.cross(xyz, vector) + w * vector)
