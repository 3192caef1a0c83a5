"""Frames of adversarial motion priors: columns, velocities, toes, contacts and cycles."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import numpy as np
import pytest

from mgs.core.contact import Support
from mgs.core.errors import MotionFileError
from mgs.motion import Motion
from mgs.motion.cycle import find_cycle
from mgs.motion_file.export import export_motion
from mgs.motion_file.formats import FORMATS
from tests.support.loaders import Loaded, amp_json, open_duck_json, rotate_wxyz
from tests.support.mujoco_oracle import mujoco_model
from tests.support.shipped import generated

GAIT = "coman/walk_arc"
RELATIVE = 1e-3
FINER = 10


@pytest.fixture(scope="module")
def motion() -> Motion:
    return generated(GAIT).stages.motion


def load(motion: Motion, fmt: str, path: Path, fps: float | None = None) -> Loaded:
    export_motion(motion, path, fmt, fps=fps)
    return amp_json(path, motion.robot.n) if fmt == "amp" else open_duck_json(path)[0]


@pytest.mark.parametrize("fmt", ["amp", "open-duck"])
@pytest.mark.slow_if("amp", "open")
def test_velocities_are_the_derivatives_of_the_places(motion: Motion, fmt: str, tmp_path: Path):
    """Of the root in the world, after the loader has turned them, and of the joints."""
    coarse = load(motion, fmt, tmp_path / "a.json")
    fine = load(motion, fmt, tmp_path / "b.json", 50.0 * FINER)
    k = FINER * np.arange(1, len(coarse.root) - 1)
    h = 2.0 / (50.0 * FINER)
    assert coarse.root_velocity is not None
    assert coarse.joint_velocity is not None
    place = (fine.root[k + 1, :3] - fine.root[k - 1, :3]) / h
    assert_close(place, coarse.root_velocity[1:-1, :3])
    w, xyz = fine.root[k, 3:4], -fine.root[k, 4:]
    dq = (fine.root[k + 1, 3:] - fine.root[k - 1, 3:]) / h
    turning = 2.0 * (dq[:, :1] * xyz + w * dq[:, 1:] + np.cross(dq[:, 1:], xyz))
    assert_close(turning, coarse.root_velocity[1:-1, 3:])
    joints = (fine.joints[k + 1] - fine.joints[k - 1]) / h
    assert_close(joints, coarse.joint_velocity[1:-1])
    assert not coarse.root_velocity[[0, -1]].any()


def assert_close(found: np.ndarray, expected: np.ndarray) -> None:
    assert np.abs(found - expected).max() < RELATIVE * np.abs(expected).max()


@pytest.mark.parametrize("fmt", ["amp", "open-duck"])
def test_toes_are_the_soles_seen_from_the_root(motion: Motion, fmt: str, tmp_path: Path):
    """Places by MuJoCo; velocities by differences of places in frames ten times as fine."""
    export_motion(motion, tmp_path / "a.json", fmt)
    export_motion(motion, tmp_path / "b.json", fmt, fps=50.0 * FINER)
    frames, fine = (
        np.array(json.loads((tmp_path / name).read_text())["Frames"])
        for name in ("a.json", "b.json")
    )
    robot, n = motion.robot, motion.robot.n
    model = mujoco_model(robot)
    data = mujoco.MjData(model)
    place, speed = slice(7 + n, 13 + n), slice(19 + 2 * n, 25 + 2 * n)
    for k in range(0, len(frames), 10):
        root = frames[k, [0, 1, 2, 6, 3, 4, 5]]
        data.qpos[:] = [*root, *frames[k, 7 : 7 + n]]
        mujoco.mj_kinematics(model, data)
        for side, spec in enumerate((robot.spec.soles.left, robot.spec.soles.right)):
            link = model.body(spec.link).id
            sole = data.xpos[link] + data.xmat[link].reshape(3, 3) @ np.array(spec.position)
            conj = root[3:] * [1, -1, -1, -1]
            seen = rotate_wxyz(conj, sole - root[:3])
            assert np.abs(seen - frames[k, place][3 * side : 3 * side + 3]).max() < 1e-6
    k = FINER * np.arange(1, len(frames) - 1)
    slope = (fine[k + 1, place] - fine[k - 1, place]) * (50.0 * FINER / 2.0)
    assert_close(slope, frames[1:-1, speed])


def test_contacts_are_those_of_the_plan(motion: Motion, tmp_path: Path):
    exported = export_motion(motion, tmp_path / "a.json", "open-duck")
    _, content = open_duck_json(tmp_path / "a.json")
    support = exported.sampled.support
    expected = [[s != Support.RIGHT, s != Support.LEFT] for s in support]
    assert np.array_equal(content["contacts"], np.array(expected, dtype=float))
    assert 0.0 < content["contacts"].mean() < 1.0


@pytest.mark.parametrize("fmt", ["amp", "open-duck"])
def test_a_cycle_ends_with_its_first_frame(motion: Motion, fmt: str, tmp_path: Path):
    """Loaders wrap from the last frame to the first: (frames - 1) * duration is the period."""
    path = tmp_path / "a.json"
    cycle = find_cycle(motion)
    export_motion(motion, path, fmt, cycle)
    content = json.loads(path.read_text())
    frames = np.array(content["Frames"])
    assert content["LoopMode"] == "Wrap"
    period = cycle.n_samples * motion.dt
    assert (len(frames) - 1) * content["FrameDuration"] == pytest.approx(period, rel=1e-12)
    joints = slice(7, 7 + motion.robot.n)
    assert np.array_equal(frames[0, joints], frames[-1, joints])
    assert content["EnableCycleOffsetRotation"]  # the walk turns
    recorded = FORMATS[fmt].read(path)
    assert recorded.extra["loop"]
    steps = np.diff(frames[:, joints], axis=0)
    wrap = np.abs(steps[0] - steps[-1]).max()
    assert wrap < 1.5 * np.abs(np.diff(steps, axis=0)).max()


def test_a_cycle_of_open_duck_states_its_mean_velocity(motion: Motion, tmp_path: Path):
    cycle = find_cycle(motion)
    export_motion(motion, tmp_path / "a.json", "open-duck", cycle)
    _, content = open_duck_json(tmp_path / "a.json")
    period = content["Placo"]["period"]
    mean = np.array([content["Vel_x"], content["Vel_y"], content["Yaw"]])
    assert mean * period == pytest.approx(cycle.displacement, rel=1e-9)
    assert int(content["Placo"]["startend_double_support_ratio"] * content["FPS"]) == 0
    assert int(period * content["FPS"] + 1e-9) == len(content["Frames"]) - 1


def test_the_clock_is_not_rounded(motion: Motion, tmp_path: Path):
    export_motion(motion, tmp_path / "a.json", "amp", fps=30.0)
    assert json.loads((tmp_path / "a.json").read_text())["FrameDuration"] == 1.0 / 30.0


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"Frames": [[1.0, 2.0], [3.0]]}, "Frames should be an array of numbers"),
        ({"Frames": [[0.0] * 26]}, "26 columns"),
        ({"Frames": None}, "Frames is missing"),
        ({"FrameDuration": 0.0}, "FrameDuration should be one positive number"),
        ({"FrameDuration": "fast"}, "FrameDuration should be one positive number"),
        ({"Joints": ["a", "a"]}, "Joints has the same name twice"),
        ({"Joints": ["a"]}, "Joints has 1 names for"),
    ],
)
def test_damage_is_named(motion: Motion, change: dict[str, object], problem: str, tmp_path: Path):
    path = tmp_path / "a.json"
    export_motion(motion, path, "amp", fps=5.0)
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    with pytest.raises(MotionFileError, match=problem):
        FORMATS["amp"].read(path)
