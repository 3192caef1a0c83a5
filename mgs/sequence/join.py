"""Motions moved in the plane and put one behind the other."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.contact import Footstep
from mgs.dynamics import align_quaternion_signs
from mgs.geometry import (
    compose_planar,
    planar_inverse,
    planar_middle,
    quat_multiply,
    quat_xyzw_from_yaw,
    rotate_planar,
)
from mgs.motion import Motion
from mgs.robot import FLOATING_BASE_NQ

Array = NDArray[np.float64]


def displacement(before: Motion, after: Motion) -> Array:
    """Planar pose (3,) of the frame of `after`, for it to begin where `before` ends."""
    end, begin = planar_middle(before.soles_ref[-1]), planar_middle(after.soles_ref[0])
    return compose_planar(end, planar_inverse(begin))


def last_sample(motion: Motion) -> Motion:
    """The motion's last sample alone."""
    arrays: dict[str, Any] = {name: array[-1:] for name, array in _arrays(motion).items()}
    return dataclasses.replace(motion, **arrays)


def _arrays(motion: Motion) -> dict[str, NDArray[Any]]:
    return {name: value for name, value in vars(motion).items() if isinstance(value, np.ndarray)}


def moved(motion: Motion, pose: Array) -> Motion:
    """The motion seen from a frame in which its own has the planar pose (3,)."""
    turn = quat_xyzw_from_yaw(pose[2])

    def place(points: Array) -> Array:  # (..., 2) or (..., 3)
        out = points.copy()
        out[..., :2] = rotate_planar(points[..., :2], pose[2]) + pose[:2]
        return out

    def pose_of(poses: Array) -> Array:  # (..., 7)
        return np.concatenate([place(poses[..., :3]), quat_multiply(turn, poses[..., 3:])], axis=-1)

    q = motion.q.copy()
    q[:, :FLOATING_BASE_NQ] = pose_of(motion.q[:, :FLOATING_BASE_NQ])
    return dataclasses.replace(
        motion,
        footsteps=tuple(_moved_footstep(step, pose) for step in motion.footsteps),
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
    )


def _moved_footstep(step: Footstep, pose: Array) -> Footstep:
    x, y, yaw = compose_planar(pose, [step.x, step.y, step.yaw])
    return Footstep(step.side, float(x), float(y), float(yaw))


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
    solvers = list(dict.fromkeys(str(m.solver["solver"]) for m in motions))
    solver: dict[str, object] = {"solver": ", ".join(solvers), "parts": [m.solver for m in motions]}
    return dataclasses.replace(first, footsteps=footsteps, solver=solver, **arrays)
