"""Formats with links, loaded as trainers load them and compared with MuJoCo."""

from __future__ import annotations

import functools
from collections import deque
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from mgs.gait import list_gaits, load_gait
from mgs.motion import Motion
from mgs.motion_file.export import export_motion
from mgs.motion_file.formats import FORMATS
from mgs.pipeline import generate
from mgs.robot import Robot, load_robot
from mgs.robot.orders import robot_order
from tests.support import loaders
from tests.support.loaders import Loaded
from tests.support.mujoco_oracle import joint_order, mujoco_model
from tests.support.shipped import generated

LOADERS: dict[str, Callable[[Path], Loaded]] = {
    "beyondmimic": loaders.tracking_npz,
    "mjlab": loaders.tracking_npz,
    "holosoma": loaders.holosoma_npz,
    "isaaclab-amp": loaders.isaaclab_amp_npz,
    "sonic": loaders.sonic_folder,
}
COM = {"beyondmimic", "isaaclab-amp"}  # whose velocities are those of centres of mass
BREADTH_FIRST = {"beyondmimic", "isaaclab-amp", "sonic"}
GAITS = ["melson/walk_arc", "coman/walk_arc"]
PLACE = 1e-5  # [m]
RELATIVE = 1e-3  # of the largest velocity
FINER = 10


@functools.cache
def oracle(name: str) -> tuple[Robot, mujoco.MjModel]:
    robot = generated(name).robot
    return robot, mujoco_model(robot)


def orders(model: mujoco.MjModel, breadth_first: bool) -> tuple[list[int], list[str]]:
    """Bodies and names of joints in the order of Isaac Lab or of MuJoCo, from MuJoCo's tree."""
    bodies = list(range(1, model.nbody))
    if breadth_first:
        bodies, waiting = [], deque([1])
        while waiting:
            bodies.append(waiting.popleft())
            waiting += [k for k in range(1, model.nbody) if model.body_parentid[k] == bodies[-1]]
    joints = [model.joint(model.body_jntadr[body]).name for body in bodies[1:]]
    return bodies, joints


def load(motion: Motion, fmt: str, path: Path, fps: float | None = None) -> Loaded:
    export_motion(motion, path, fmt, fps=fps)
    return LOADERS[fmt](path)


def forward(model: mujoco.MjModel, found: Loaded, names: list[str]) -> tuple[np.ndarray, ...]:
    """Places and orientations of links, and their centres of mass, by MuJoCo (T, nbody, .)."""
    data = mujoco.MjData(model)
    index = [names.index(name) for name in joint_order(model)]
    rows = []
    for root, joints in zip(found.root, found.joints, strict=True):
        data.qpos[:] = [*root, *joints[index]]
        mujoco.mj_kinematics(model, data)
        rows.append((data.xpos.copy(), data.xquat.copy(), data.xipos.copy()))
    return tuple(np.array(column) for column in zip(*rows, strict=True))


@pytest.mark.parametrize("name", GAITS)
@pytest.mark.parametrize("fmt", LOADERS)
def test_links_are_where_mujoco_has_them(name: str, fmt: str, tmp_path: Path):
    _, model = oracle(name)
    bodies, joints = orders(model, fmt in BREADTH_FIRST)
    found = load(generated(name).stages.motion, fmt, tmp_path / "a")
    names = [model.body(body).name for body in bodies]
    assert found.joint_names in (None, joints)
    assert found.link_names in (None, names)
    place, quat, _ = forward(model, found, joints)
    assert np.abs(place[:, bodies] - found.position).max() < PLACE
    assert np.abs(np.abs(np.sum(quat[:, bodies] * found.quat_wxyz, axis=-1)) - 1.0).max() < 1e-6


@pytest.mark.slow_if("coman/walk_arc")
@pytest.mark.parametrize("name", GAITS)
@pytest.mark.parametrize("fmt", LOADERS)
def test_velocities_are_the_derivatives_of_the_places(name: str, fmt: str, tmp_path: Path):
    """Places come from an export with ten times as many frames, and from MuJoCo."""
    motion = generated(name).stages.motion
    _, model = oracle(name)
    bodies, joints = orders(model, fmt in BREADTH_FIRST)
    coarse = load(motion, fmt, tmp_path / "a")
    fine = load(motion, fmt, tmp_path / "b", FORMATS[fmt].fps * FINER)
    place, quat, com = forward(model, fine, joints)
    points = (com if fmt in COM else place)[:, bodies]
    fps = coarse.fps * FINER
    k = FINER * np.arange(1, len(coarse.joints) - 1)
    assert close(difference(points, k) * fps, coarse.velocity[1:-1])
    turning = angular_velocities(quat[:, bodies], k) * fps
    assert close(turning, coarse.angular_velocity[1:-1])
    assert close(difference(fine.joints, k) * fps, coarse.joint_velocity[1:-1])
    assert not coarse.joint_velocity[[0, -1]].any()
    assert not coarse.velocity[[0, -1]].any()


def difference(values: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Derivatives at samples k, times the interval, by differences of order 6."""
    values = values.astype(float)
    weights = {1: 45.0, 2: -9.0, 3: 1.0}
    return sum(w * (values[k + j] - values[k - j]) for j, w in weights.items()) / 60.0


def angular_velocities(quat: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Angular velocities in the world at samples k, times the interval: 2 dq/dt conj(q)."""
    signs = np.sign(np.sum(quat[1:] * quat[:-1], axis=-1))
    quat = quat.copy()
    quat[1:] *= np.cumprod(signs, axis=0)[..., None]
    dq, q = difference(quat, k), quat[k]
    w, xyz = q[..., :1], -q[..., 1:]
    return 2.0 * (dq[..., :1] * xyz + w * dq[..., 1:] + np.cross(dq[..., 1:], xyz))


def close(found: np.ndarray, expected: np.ndarray) -> bool:
    return bool(np.abs(found - expected).max() < RELATIVE * np.abs(expected).max())


@pytest.mark.parametrize("fmt", ["beyondmimic", "mjlab"])
def test_velocities_of_the_other_point_would_be_told_apart(fmt: str, tmp_path: Path):
    """The test above distinguishes centres of mass from origins: they differ far more."""
    motion = generated("coman/walk_arc").stages.motion
    com = load(motion, "beyondmimic", tmp_path / "a").velocity
    origin = load(motion, "mjlab", tmp_path / "b").velocity
    recorded = FORMATS[fmt].read(tmp_path / ("a" if fmt == "beyondmimic" else "b"))
    assert recorded.links is not None
    assert recorded.links.velocity_of == ("com" if fmt == "beyondmimic" else "origin")
    difference_of_norms = np.abs(
        np.sort(np.linalg.norm(com, axis=-1)) - np.sort(np.linalg.norm(origin, axis=-1))
    )
    assert difference_of_norms.max() > 20 * RELATIVE * np.abs(origin).max()


def test_joints_of_a_g1_stand_as_isaac_lab_counts_them():
    """The permutation that GR00T's converter of motions has for the Unitree G1 (MJ_TO_IL)."""
    leg = ["hip_pitch", "hip_roll", "hip_yaw", "knee", "ankle_pitch", "ankle_roll"]
    arm = ["shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow", "wrist_roll"]
    arm += ["wrist_pitch", "wrist_yaw"]
    waist = ["waist_yaw", "waist_roll", "waist_pitch"]
    chains = [("pelvis", [f"left_{j}" for j in leg]), ("pelvis", [f"right_{j}" for j in leg])]
    chains += [("pelvis", waist), ("waist_pitch", [f"left_{j}" for j in arm])]
    chains += [("waist_pitch", [f"right_{j}" for j in arm])]
    links, joints, names = ["pelvis"], [], []
    for root, chain in chains:
        for parent, joint in zip([root, *chain], chain, strict=False):
            names.append(joint)
            links.append(joint)
            joints.append(
                f'<joint name="{joint}_joint" type="revolute"><parent link="{parent}"/>'
                f'<child link="{joint}"/></joint>'
            )
    urdf = "<robot>" + "".join(f'<link name="{link}"/>' for link in links) + "".join(joints)
    moving = tuple(sorted(f"{name}_joint" for name in names))
    robot = SimpleNamespace(urdf=urdf + "</robot>", source="g1", joint_names=moving)
    deep = robot_order(robot, "depth-first").joints  # type: ignore[arg-type]
    wide = robot_order(robot, "breadth-first").joints  # type: ignore[arg-type]
    to_isaac_lab = [0, 3, 6, 9, 13, 17, 1, 4, 7, 10, 14, 18, 2, 5, 8, 11, 15, 19, 21, 23, 25, 27]
    to_isaac_lab += [12, 16, 20, 22, 24, 26, 28]
    assert deep == tuple(f"{name}_joint" for name in names)
    assert [wide.index(name) for name in deep] == to_isaac_lab


@pytest.mark.slow
@pytest.mark.parametrize("name", [n for n in list_gaits() if load_gait(n).robot])
def test_links_of_every_shipped_gait_move_as_mujoco_moves_them(name: str, tmp_path: Path):
    """MuJoCo gets qpos and qvel of one file, and has to have the links of the others.

    Places within 1e-5 m; velocities of origins and of centres of mass, which MuJoCo computes from
    qvel, within 1e-4 of the largest one. Derivatives of places in ten times as many frames are the
    velocities within 1e-3 of the largest one.
    """
    gait = load_gait(name)
    motion = generate(load_robot(gait.robot), gait, name).motion
    for fmt in ("mjlab", "beyondmimic", "locomujoco"):
        export_motion(motion, tmp_path / fmt, fmt, fps=50.0)
    moved = loaders.locomujoco_npz(tmp_path / "locomujoco")
    with np.load(tmp_path / "locomujoco") as arrays:
        qvel = arrays["qvel"]
    export_motion(motion, tmp_path / "fine", "mjlab", fps=50.0 * FINER)
    fine, coarse = (loaders.tracking_npz(tmp_path / fmt) for fmt in ("fine", "mjlab"))
    k = FINER * np.arange(1, len(coarse.joints) - 1)
    assert close(difference(fine.position, k) * 50.0 * FINER, coarse.velocity[1:-1])
    model = mujoco_model(motion.robot)
    data, velocity = mujoco.MjData(model), np.zeros(6)
    assert moved.joint_names == list(joint_order(model))
    for fmt in ("mjlab", "beyondmimic"):
        found = loaders.tracking_npz(tmp_path / fmt)
        bodies, _ = orders(model, fmt in BREADTH_FIRST)
        scale = np.abs(found.velocity).max()
        for k in range(0, len(found.joints), 7):
            data.qpos[:] = [*moved.root[k], *moved.joints[k]]
            data.qvel[:] = qvel[k]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_comVel(model, data)
            assert np.abs(data.xpos[bodies] - found.position[k]).max() < PLACE
            for i, body in enumerate(bodies):
                mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, velocity, 0)
                arm = data.xipos[body] - data.xpos[body] if fmt in COM else np.zeros(3)
                speed = velocity[3:] + np.cross(velocity[:3], arm)
                assert np.abs(speed - found.velocity[k, i]).max() < 1e-4 * scale
                assert np.abs(velocity[:3] - found.angular_velocity[k, i]).max() < 1e-3
