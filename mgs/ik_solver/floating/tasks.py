"""Tasks of a floating-base robot: values, Jacobian and errors, in buffers that updates refill.

Generalised coordinates q (7 + n,) with velocity v (6 + n,), the base twist in the base frame first.
Rows of positions and rotations are in the world frame; orientation errors are rotation vectors
(log map) of R_ref R^T.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.geometry import rotations_from_quat_xyzw
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

WORLD_ALIGNED = pin.LOCAL_WORLD_ALIGNED
# Parts that a task vector is made of, with their rows.
SIZES = {
    "left_sole": 6, "right_sole": 6, "torso": 3, "com": 3, "com_xy": 2, "com_z": 1,
    "left_hand": 3, "right_hand": 3,
}  # fmt: skip
COM_AXES = {"com": slice(0, 3), "com_xy": slice(0, 2), "com_z": slice(2, 3)}


def parts_of(names: Iterable[str], tasks: TaskTrajectory) -> tuple[str, ...]:
    """Parts of tasks named as in a gait file; hands of which nothing is asked are left out."""
    hands = tuple(f"{side.label}_hand" for side in Side if tasks.hands_asked[side])
    groups = {"soles": ("left_sole", "right_sole"), "hands": hands}
    return tuple(part for name in names for part in groups.get(name, (name,)))


@dataclass(frozen=True, eq=False)
class BodyTargets:
    """References of a task vector of m rows at every sample."""

    x: Array  # (N, m) positions; rows of rotations are 0
    rotations: Array  # (N, r, 3, 3) of the parts that have one, in their order
    steps: Array  # (N, m) x[k] - x[k-1], rotation vectors in the rows of rotations; 0 at k = 0


def body_targets(parts: tuple[str, ...], tasks: TaskTrajectory, com: ComTrajectory) -> BodyTargets:
    """References for `parts`, in their order."""
    hands = tasks.hands + com.position[:, None]
    x, steps, rotations = [], [], []
    for part in parts:
        zeros = np.zeros((tasks.n_samples, 3))
        if part in COM_AXES:
            x.append(com.position[:, COM_AXES[part]])
        elif part.endswith("hand"):
            x.append(hands[:, Side[part.split("_")[0].upper()]])
        elif part == "torso":
            rotations.append(rotations_from_quat_xyzw(tasks.torso))
            x.append(zeros)
        else:
            poses = tasks.soles[:, Side[part.split("_")[0].upper()]]
            rotations.append(rotations_from_quat_xyzw(poses[:, 3:]))
            x.append(np.concatenate([poses[:, :3], zeros], axis=1))
        step = np.zeros_like(x[-1])
        step[1:] = np.diff(x[-1], axis=0)
        if part == "torso" or part.endswith("sole"):
            step[:, -3:] = _turns(rotations[-1])
        steps.append(step)
    return BodyTargets(
        x=np.ascontiguousarray(np.concatenate(x, axis=1)),
        rotations=np.stack(rotations, axis=1) if rotations else np.empty((len(x[0]), 0, 3, 3)),
        steps=np.ascontiguousarray(np.concatenate(steps, axis=1)),
    )


def _turns(rotations: Array) -> Array:
    """Rotation vectors (N, 3) from each rotation (N, 3, 3) to the next, 0 for the first."""
    turns = np.zeros((len(rotations), 3))
    for k in np.flatnonzero(np.any(rotations[1:] != rotations[:-1], axis=(1, 2))) + 1:
        turns[k] = pin.log3(rotations[k] @ rotations[k - 1].T)
    return turns


class BodyTasks:
    """Values and Jacobian of a task vector made of parts, in the order given.

    Attributes:
        J: (m, 6 + n) Jacobian with respect to v.
        f: (m,) positions; rows of rotations are 0.
        rows: rows of each part.
        com: (3,) a view of the CoM.
    """

    def __init__(self, robot: Robot, parts: tuple[str, ...]) -> None:
        self.model, self.data = robot.model, robot.model.createData()
        self.parts = parts
        self.rows: dict[str, slice] = {}
        start = 0
        for part in parts:
            self.rows[part] = slice(start, start + SIZES[part])
            start += SIZES[part]
        self.m = start
        self.J = np.zeros((start, robot.model.nv))
        self._at_rest = np.zeros(robot.model.nv)
        self.f = np.zeros(start)
        self.com: Array = self.data.com[0]
        frames = {
            "left_sole": robot.sole_frames[Side.LEFT],
            "right_sole": robot.sole_frames[Side.RIGHT],
            "torso": robot.torso_frame,
            "left_hand": robot.hand_frames[Side.LEFT],
            "right_hand": robot.hand_frames[Side.RIGHT],
        }
        # What `update` copies where, as views made once: frame, Jacobian rows, position, rotation.
        self._coms = [
            (self.J[self.rows[p]], self.f[self.rows[p]], COM_AXES[p])
            for p in parts
            if p in COM_AXES
        ]
        self._points, self._turning = [], []
        for part in parts:
            if part in COM_AXES:
                continue
            first, used = self.rows[part], frames[part]
            if part == "torso":
                self._turning.append((used, self.J[first]))
            elif part.endswith("hand"):
                self._points.append((used, self.J[first], self.f[first], slice(0, 3)))
            else:
                position = self.f[first][:3]
                self._points.append((used, self.J[first], position, slice(0, 6)))
        turning = [p for p in parts if p == "torso" or p.endswith("sole")]
        self._turns = [slice(self.rows[p].stop - 3, self.rows[p].stop) for p in turning]
        # views that follow every update
        self._rotations_T = [self.data.oMf[frames[p]].rotation.T for p in turning]

    def update(self, q: Array) -> None:
        """Refill J and f at q (7 + n,)."""
        model, data = self.model, self.data
        J_com = pin.jacobianCenterOfMass(model, data, q, False)  # also places joints, fills data.J
        for J, f, axes in self._coms:
            J[:] = J_com[axes]
            f[:] = self.com[axes]
        for frame, J, f, axes in self._points:
            f[:] = pin.updateFramePlacement(model, data, frame).translation
            J[:] = pin.getFrameJacobian(model, data, frame, WORLD_ALIGNED)[axes]
        for frame, J in self._turning:
            pin.updateFramePlacement(model, data, frame)
            J[:] = pin.getFrameJacobian(model, data, frame, WORLD_ALIGNED)[3:]

    def com_velocity_derivative(self, q: Array, v: Array) -> Array:
        """Derivative (3, 6 + n) of J_com(q) v by q, at constant v (6 + n,)."""
        model, data = self.model, self.data
        pin.computeForwardKinematicsDerivatives(model, data, q, v, self._at_rest)
        pin.centerOfMass(model, data, pin.KinematicLevel.VELOCITY, True)
        return pin.getCenterOfMassVelocityDerivatives(model, data)

    def error(self, x: Array, rotations: Array, out: Array) -> None:
        """Target minus actual (m,) for one row of `BodyTargets.x` and `.rotations`."""
        np.subtract(x, self.f, out=out)
        for i, rows in enumerate(self._turns):
            out[rows] = pin.log3(rotations[i].dot(self._rotations_T[i]))
