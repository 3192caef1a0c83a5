"""Clean motions for `audit.py`: shipped gaits and others with random parameters, in other guises.

A clean motion passes every static check of `mgs validate`, which knows what was planned. It is then
cut, mirrored, turned, sampled at another rate and rounded, as motions are on their way through the
files of others; none of this makes it worse. Sampling is SciPy's (cubic and rotation splines).
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

import mgs
from mgs.core.arrays import Array
from mgs.core.errors import MgsError
from mgs.judge.audit import GivenMotion
from mgs.judge.audit.tree import joint_axes, joint_poses
from mgs.judge.motion_checks import check_motion
from mgs.motion import Motion
from mgs.robot import Robot, load_robot

# Thresholds of the audit were set on the first gaits; figures are those of the second ones.
FIRST = (
    "melson/walk_practical", "melson/walk_arc", "melson/walk_swinging", "melson/kick",
    "melson/squat", "melson/bow", "melson/sway", "melson/obstacle", "melson/pick_up_both",
    "coman/walk_forward", "coman/kick", "coman/sway", "coman/bow", "coman/walk_sideways",
)  # fmt: skip
HELD_OUT = (
    "melson/walk_5cm", "melson/walk_backward", "melson/walk_fastest", "melson/walk_sideways",
    "melson/walk_mixed", "melson/walk_to_pose", "melson/turn_in_place", "melson/figure_eight",
    "melson/walk_kick_walk", "melson/hand_eight", "melson/wave", "melson/squat_stretched",
    "melson/get_ready", "melson/pick_up", "melson/pick_up_left", "melson/walk_turn_walk",
    "coman/walk", "coman/walk_arc", "coman/walk_fastest", "coman/stairs", "coman/wave",
    "coman/hand_eight", "coman/pick_up",
)  # fmt: skip
RATES = (30.0, 50.0, 60.0, 100.0, 120.0, 200.0, 250.0)  # [Hz]
# of walks with random parameters: ranges by gait
WALKS: dict[str, dict[str, tuple[float, float]]] = {
    "melson/walk_practical": {
        "walk.step_length": (-0.02, 0.05), "walk.lateral": (0.0, 0.0), "walk.step_yaw": (-0.1, 0.1),
        "walk.single_support": (0.4, 0.9), "walk.double_support": (0.2, 0.6),
        "walk.step_height": (0.012, 0.03),
    },
    "coman/walk_forward": {
        "walk.step_length": (-0.05, 0.15), "walk.lateral": (0.0, 0.0), "walk.step_yaw": (-0.1, 0.1),
        "walk.single_support": (0.5, 0.9), "walk.double_support": (0.2, 0.6),
        "walk.step_height": (0.02, 0.05),
    },
}  # fmt: skip


@functools.cache
def shipped(name: str) -> Motion:
    """Motion of a shipped gait."""
    return mgs.generate(name.partition("/")[0], name)


def random_walk(rng: np.random.Generator) -> Motion:
    """A walk with random parameters that passes all static checks."""
    while True:
        name = str(rng.choice(list(WALKS)))
        settings: dict[str, Any] = {key: float(rng.uniform(*r)) for key, r in WALKS[name].items()}
        settings["walk.n_steps"] = int(rng.integers(2, 6))
        try:
            motion = mgs.generate(name.partition("/")[0], name, **settings)
        except MgsError:  # this robot cannot walk so
            continue
        if all(check.ok for check in check_motion(motion, collision_step=5)):
            return motion


def clean(rng: np.random.Generator, gaits: tuple[str, ...]) -> Iterator[GivenMotion]:
    """Clean motions without end; every fourth one is a walk with random parameters."""
    while True:
        chosen = shipped(str(rng.choice(gaits))) if rng.random() < 0.75 else random_walk(rng)
        yield disguise(chosen, rng)


def disguise(motion: Motion, rng: np.random.Generator) -> GivenMotion:
    """A motion cut, sampled anew, mirrored, turned and rounded at random."""
    given = resample(motion, float(rng.choice(RATES)), *_cut(motion, rng))
    if rng.random() < 0.5 and not motion.scene.boxes and given.payload is None:
        given = mirror(given)
    if not motion.scene.boxes:
        given = place(given, float(rng.uniform(-np.pi, np.pi)), rng.uniform(-2.0, 2.0, 2))
    return rounded(given, rng)


def _cut(motion: Motion, rng: np.random.Generator) -> tuple[float, float]:
    """First and last time [s] of a span of at least two seconds; half of the motions stay whole."""
    if rng.random() < 0.5 or motion.duration < 3.0:
        return 0.0, min(motion.duration, 20.0)
    length = rng.uniform(2.0, min(motion.duration, 15.0))
    start = rng.uniform(0.0, motion.duration - length)
    return float(start), float(start + length)


def resample(motion: Motion, rate: float, start: float, end: float) -> GivenMotion:
    """The motion from start to end [s] at another rate [Hz], velocities those of its splines."""
    times = motion.times
    t = start + np.arange(int((end - start) * rate + 1e-9) + 1) / rate
    joints, place_ = CubicSpline(times, motion.q[:, 7:]), CubicSpline(times, motion.q[:, :3])
    turn = RotationSpline(times, Rotation.from_quat(motion.q[:, 3:7]))
    R = turn(t)
    payload = motion.payload
    if payload is not None:
        payload = np.stack([np.interp(t, times, payload[:, side]) for side in (0, 1)], axis=1)
    return GivenMotion(
        robot=motion.robot,
        dt=1.0 / rate,
        q=np.concatenate([place_(t), R.as_quat(), joints(t)], axis=1),
        scene=motion.scene,
        joint_velocity=joints(t, 1),
        base_linear=place_(t, 1),
        base_angular=R.apply(turn(t, 1)),  # SciPy gives it in the frame of the base
        angular_frame="world",
        payload=payload,
    )


def mirror(given: GivenMotion) -> GivenMotion:
    """The motion as seen in a mirror at the plane y = 0, for a robot that is symmetric."""
    partner, sign = mirror_map(given.robot)
    flip = np.array([1.0, -1.0, 1.0])
    q = given.q.copy()
    q[:, :3] *= flip
    q[:, 3:7] *= [-1.0, 1.0, -1.0, 1.0]
    q[:, 7:] = sign * given.q[:, 7:][:, partner]
    assert given.joint_velocity is not None
    assert given.base_linear is not None
    assert given.base_angular is not None
    return dataclasses.replace(
        given,
        q=q,
        joint_velocity=sign * given.joint_velocity[:, partner],
        base_linear=given.base_linear * flip,
        base_angular=given.base_angular * -flip,
    )


@functools.cache
def _mirror_map(name: str) -> tuple[Any, Array]:
    robot = load_robot(name)
    q = np.zeros((1, 7 + robot.n))
    q[0, 6] = 1.0
    poses, axes = joint_poses(robot, q), joint_axes(robot)
    p = poses.p[2:, 0]
    a = np.einsum("jik,jk->ji", poses.R[2:, 0], axes[2:])
    partner, sign = np.empty(robot.n, dtype=int), np.empty(robot.n)
    for j in range(robot.n):  # joint j + 2 of the model is column j: all have one coordinate
        gap = np.linalg.norm(p - p[j] * [1.0, -1.0, 1.0], axis=1)
        turned = a @ (a[j] * [-1.0, 1.0, -1.0])
        partner[j] = int(np.argmin(gap + 10.0 * (1.0 - np.abs(turned))))
        sign[j] = np.sign(turned[partner[j]])
    return partner, sign


def mirror_map(robot: Robot) -> tuple[Any, Array]:
    """For each joint the one on the other side (n,), and the sign (n,) of its angle in a mirror."""
    return _mirror_map(robot.spec.name)


def place(given: GivenMotion, yaw: float, to: Array) -> GivenMotion:
    """The motion turned by yaw [rad] about the vertical and moved by `to` (2,) [m]."""
    turn = Rotation.from_euler("z", yaw)
    q = given.q.copy()
    q[:, :3] = turn.apply(q[:, :3])
    q[:, :2] += to
    q[:, 3:7] = (turn * Rotation.from_quat(q[:, 3:7])).as_quat()
    assert given.base_linear is not None
    assert given.base_angular is not None
    angular = given.base_angular
    if given.angular_frame == "world":
        angular = turn.apply(angular)
    return dataclasses.replace(
        given, q=q, base_linear=turn.apply(given.base_linear), base_angular=angular
    )


def rounded(given: GivenMotion, rng: np.random.Generator) -> GivenMotion:
    """Numbers as files keep them: double, single precision, six or five decimals."""
    kind = int(rng.integers(4))
    if kind == 0:
        return given
    q = given.q.astype(np.float32).astype(float) if kind == 1 else np.round(given.q, 7 - kind + 1)
    q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1, keepdims=True)
    return dataclasses.replace(given, q=q)
