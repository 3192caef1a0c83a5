"""Exports read by trainers' own loaders, where these are installed, and compared with MuJoCo."""

from __future__ import annotations

import functools
from pathlib import Path

import mujoco
import numpy as np
import pytest

from mgs.motion import Motion
from mgs.motion.link_motion import link_motion
from mgs.motion_file.export import Exported, export_motion
from mgs.robot import Robot
from tests.support.consumers import loaded_by
from tests.support.mujoco_oracle import joint_order, mujoco_model, place
from tests.support.shipped import generated

GAITS = ["melson/walk_arc", "coman/kick"]
PLACE = 1e-5  # [m]
SPEED = 1e-5  # of the largest velocity: single precision


@functools.cache
def motion_of(name: str) -> Motion:
    return generated(name).stages.motion


def mujoco_links(robot: Robot, exported: Exported) -> dict[str, np.ndarray]:
    """Places, orientations and velocities of links by MuJoCo, of the frames that were written."""
    model = mujoco_model(robot)
    data = mujoco.MjData(model)
    velocity = np.zeros(6)
    rows = []
    for q, v in zip(exported.sampled.q, exported.sampled.v, strict=True):
        place(model, data, robot, q, v)
        speeds = []
        for body in range(1, model.nbody):
            kind = mujoco.mjtObj.mjOBJ_XBODY
            mujoco.mj_objectVelocity(model, data, kind, body, velocity, 0)
            speeds.append(velocity.copy())
        rows.append((data.xpos[1:].copy(), data.xquat[1:].copy(), np.array(speeds)))
    position, quat, speed = (np.array(column) for column in zip(*rows, strict=True))
    return {"pos": position, "quat": quat, "lin": speed[..., 3:], "ang": speed[..., :3]}


def check_links(found: dict[str, np.ndarray], expected: dict[str, np.ndarray]) -> None:
    assert np.abs(found["body_pos_w"] - expected["pos"]).max() < PLACE
    along = np.abs(np.sum(found["body_quat_w"] * expected["quat"], axis=-1))
    assert np.abs(along - 1.0).max() < 1e-6
    for key, name in (("body_lin_vel_w", "lin"), ("body_ang_vel_w", "ang")):
        off = np.abs(found[key] - expected[name]).max()
        assert off < SPEED * np.abs(expected[name]).max()


@pytest.mark.parametrize("name", GAITS)
def test_mjlab(name: str, tmp_path: Path):
    motion = motion_of(name)
    exported = export_motion(motion, tmp_path / "a.npz", "mjlab")
    links = exported.written.links
    found = loaded_by("mjlab", tmp_path / "a.npz", str(len(links)))
    model = mujoco_model(motion.robot)
    assert links == tuple(model.body(i).name for i in range(1, model.nbody))
    assert exported.written.joints == joint_order(model)
    check_links(found, mujoco_links(motion.robot, exported))
    index = [motion.robot.joint_names.index(joint) for joint in joint_order(model)]
    assert np.abs(found["joint_pos"] - exported.sampled.joints[:, index]).max() < 1e-6


@pytest.mark.parametrize("name", GAITS)
def test_holosoma(name: str, tmp_path: Path):
    """It takes joints and links by their names, in the order of its own robot."""
    motion = motion_of(name)
    exported = export_motion(motion, tmp_path / "a.npz", "holosoma")
    model = mujoco_model(motion.robot)
    bodies = [model.body(i).name for i in range(1, model.nbody)]
    joints = sorted(motion.robot.joint_names)
    found = loaded_by("holosoma", tmp_path / "a.npz", ",".join(bodies), ",".join(joints))
    found["body_quat_w"] = np.roll(found["body_quat_w"], 1, axis=-1)  # it has x, y, z, w
    check_links(found, mujoco_links(motion.robot, exported))
    index = [motion.robot.joint_names.index(joint) for joint in joints]
    assert np.abs(found["joint_pos"] - exported.sampled.joints[:, index]).max() < 1e-6
    assert np.abs(found["joint_vel"] - exported.sampled.joint_velocity[:, index]).max() < 1e-5


@pytest.mark.parametrize("name", GAITS)
def test_loco_mujoco(name: str, tmp_path: Path):
    """MuJoCo places the links of its qpos where they are, and moves them as fast with its qvel."""
    motion = motion_of(name)
    exported = export_motion(motion, tmp_path / "a.npz", "locomujoco")
    found = loaded_by("loco_mujoco", tmp_path / "a.npz")
    model = mujoco_model(motion.robot)
    assert tuple(found["joint_names"][1:]) == joint_order(model)
    assert found["index"].tolist() == list(range(model.nq))
    assert found["split_points"].tolist() == [0, exported.sampled.n_frames]
    assert float(found["frequency"]) == exported.sampled.fps
    links = link_motion(exported.sampled)
    data = mujoco.MjData(model)
    speed = np.zeros(6)
    scale = np.abs(links.velocity).max()
    for k in range(0, exported.sampled.n_frames, 5):
        data.qpos[:], data.qvel[:] = found["qpos"][k], found["qvel"][k]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        assert np.abs(data.xpos[1:] - links.position[k]).max() < PLACE
        for body in range(1, model.nbody):
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, speed, 0)
            assert np.abs(speed[3:] - links.velocity[k, body - 1]).max() < 1e-4 * scale


def test_lerobot(tmp_path: Path):
    motion = motion_of(GAITS[0])
    exported = export_motion(motion, tmp_path / "set", "lerobot")
    found = loaded_by("lerobot", tmp_path / "set")
    assert tuple(found["names"]) == exported.written.joints
    index = [motion.robot.joint_names.index(joint) for joint in exported.written.joints]
    assert np.abs(found["action"] - exported.sampled.joints[:, index]).max() < 1e-6
    assert np.abs(found["timestamp"] - exported.sampled.times).max() < 1e-5
    assert int(found["fps"]) == 50
    assert str(found["task"]) == motion.gait_name
    assert np.allclose(found["mean"], exported.sampled.joints[:, index].mean(axis=0), atol=1e-6)


@pytest.mark.parametrize("name", GAITS)
def test_protomotions(name: str, tmp_path: Path):
    """Loaded by torch with nothing but tensors allowed, as ProtoMotions takes them."""
    torch = pytest.importorskip("torch", reason="torch is not installed")
    motion = motion_of(name)
    exported = export_motion(motion, tmp_path / "a.motion", "protomotions")
    content = torch.load(tmp_path / "a.motion", weights_only=True)
    tensors = {key: value for key, value in content.items() if key != "fps"}
    assert content["fps"] == exported.sampled.fps
    assert {value.dtype for value in tensors.values()} == {torch.float32, torch.bool}
    keys = {"pos": "body_pos_w", "vel": "body_lin_vel_w", "ang_vel": "body_ang_vel_w"}
    found = {new: tensors[f"rigid_body_{old}"].numpy() for old, new in keys.items()}
    found["body_quat_w"] = np.roll(tensors["rigid_body_rot"].numpy(), 1, axis=-1)
    check_links(found, mujoco_links(motion.robot, exported))
    contacts = tensors["rigid_body_contacts"].numpy()
    on_ground = [exported.written.links[k] for k in np.flatnonzero(contacts.any(axis=0))]
    soles = motion.robot.spec.soles
    assert set(on_ground) == {soles.left.link, soles.right.link}
    assert not contacts[:, contacts.any(axis=0)].all()
