"""Motions moved in the plane and put one behind the other."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Footstep
from mgs.core.geometry import (
    compose_planar,
    planar_inverse,
    planar_middle,
    quat_multiply,
    quat_xyzw_from_yaw,
    rotate_planar,
)
from mgs.core.scene import Scene
from mgs.motion import Motion
from mgs.motion.dynamics import align_quaternion_signs
from mgs.motion.provenance import provenance_of_sequence


@dataclass(frozen=True, eq=False)
class Displacement:
    """Planar pose of a frame and its height; soles stay level."""

    pose: Array  # (3,) x, y [m], yaw [rad]
    rise: float = 0.0  # [m]

    @property
    def inverse(self) -> Displacement:
        """Inverse displacement: the original frame, seen from this one."""
        return Displacement(planar_inverse(self.pose), -self.rise)


def displacement(before: Motion, after: Motion) -> Displacement:
    """What `after` has to be moved by to begin where `before` ends."""
    end, begin = before.soles_ref[-1], after.soles_ref[0]
    pose = compose_planar(planar_middle(end), planar_inverse(planar_middle(begin)))
    return Displacement(pose, float(end[:, 2].mean() - begin[:, 2].mean()))


def last_sample(motion: Motion) -> Motion:
    """The motion's last sample alone."""
    arrays: dict[str, Any] = {name: array[-1:] for name, array in _arrays(motion).items()}
    return dataclasses.replace(motion, **arrays)


def _arrays(motion: Motion) -> dict[str, NDArray[Any]]:
    return {name: value for name, value in vars(motion).items() if isinstance(value, np.ndarray)}


def moved(motion: Motion, by: Displacement) -> Motion:
    """The motion seen from a frame in which its own is displaced."""
    pose, turn = by.pose, quat_xyzw_from_yaw(by.pose[2])

    def place(points: Array) -> Array:  # (..., 2) or (..., 3)
        out = points.copy()
        out[..., :2] = rotate_planar(points[..., :2], pose[2]) + pose[:2]
        out[..., 2:] += by.rise
        return out

    def pose_of(poses: Array) -> Array:  # (..., 7)
        return np.concatenate([place(poses[..., :3]), quat_multiply(turn, poses[..., 3:])], axis=-1)

    q = motion.q.copy()
    q[:, :FLOATING_BASE_NQ] = pose_of(motion.q[:, :FLOATING_BASE_NQ])
    return dataclasses.replace(
        motion,
        footsteps=tuple(_moved_footstep(step, by) for step in motion.footsteps),
        q=q,
        com=place(motion.com),
        com_ref=place(motion.com_ref),
        zmp=place(motion.zmp),
        zmp_ref=place(motion.zmp_ref),
        soles=pose_of(motion.soles),
        soles_ref=pose_of(motion.soles_ref),
        hands=pose_of(motion.hands),
        hands_ref=place(motion.hands_ref),
        torso=pose_of(motion.torso),
        torso_ref=quat_multiply(turn, motion.torso_ref),
        scene=_moved_scene(motion.scene, by),
    )


def _moved_footstep(step: Footstep, by: Displacement) -> Footstep:
    x, y, yaw = compose_planar(by.pose, [step.x, step.y, step.yaw])
    return Footstep(step.side, float(x), float(y), float(yaw), step.z + by.rise)


def _moved_scene(scene: Scene, by: Displacement) -> Scene:
    """Boxes keep standing on the ground: a frame that is higher makes them higher."""
    boxes, balls = [], []
    for box in scene.boxes:
        x, y, yaw = compose_planar(by.pose, [box.x, box.y, box.yaw]).tolist()
        height = box.height + by.rise
        boxes.append(dataclasses.replace(box, x=x, y=y, yaw=yaw, height=height))
    for ball in scene.balls:
        x, y, direction = compose_planar(by.pose, [ball.x, ball.y, ball.direction]).tolist()
        balls.append(dataclasses.replace(ball, x=x, y=y, direction=direction))
    return Scene(tuple(boxes), tuple(balls))


def join(motions: list[Motion]) -> Motion:
    """One motion of several that begin where the one before ends; the first gives the gait.

    Of the two samples at a seam that of the one before is kept; velocities there are differences
    across it.
    """
    first = motions[0]
    parts = [_arrays(motion) for motion in motions]
    arrays: dict[str, Any] = {
        name: np.concatenate([array, *(part[name][1:] for part in parts[1:])])
        for name, array in parts[0].items()
    }
    seams = np.cumsum([m.n_samples - 1 for m in motions])[:-1]
    model = first.robot.model
    q, v = arrays["q"], arrays["v"]
    for k in (*seams, *(seams + 1)):
        if k < len(q) - 1:
            v[k] = pin.difference(model, q[k - 1], q[k + 1]) / (2.0 * first.dt)
    align_quaternion_signs(q[:, 3:7])
    footsteps = (*first.footsteps, *(step for m in motions[1:] for step in m.footsteps[2:]))
    provenance = provenance_of_sequence([m.provenance for m in motions])
    scene = Scene(
        boxes=tuple(dict.fromkeys(box for m in motions for box in m.scene.boxes)),
        balls=tuple(
            dataclasses.replace(ball, time=ball.time + first.dt * start)
            for start, m in zip([0, *seams.tolist()], motions, strict=True)
            for ball in m.scene.balls
        ),
    )
    return dataclasses.replace(
        first, footsteps=footsteps, provenance=provenance, scene=scene, **arrays
    )
