"""Tasks of a floating-base robot: values, Jacobian and errors, in buffers that updates refill.

The generalised velocity v (6 + n,) of a configuration q (7 + n,) starts with the base twist in the
base frame. Rows of positions and rotations are in the world frame; orientation errors are rotation
vectors (log map) of R_ref R^T.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.ik_solver.floating.parts import Part
from mgs.ik_solver.floating.targets import BodyTargets
from mgs.ik_solver.residuals import TaskRows, position_rows, turn_rows
from mgs.robot import Robot

WORLD_ALIGNED = pin.LOCAL_WORLD_ALIGNED


class BodyTasks:
    """Values and Jacobian of a task vector made of parts, in the order given.

    Attributes:
        m: number of rows.
        J: (m, 6 + n) Jacobian with respect to v.
        f: (m,) positions; rows of rotations are 0.
        rows: rows of each part.
    """

    def __init__(self, robot: Robot, parts: Sequence[Part]) -> None:
        self.model, self.data = robot.model, robot.model.createData()
        self.parts, self.rows = tuple(parts), rows_of(parts)
        self.m = sum(part.size for part in parts)
        self.J, self.f = np.zeros((self.m, robot.model.nv)), np.zeros(self.m)
        self._at_rest = np.zeros(robot.model.nv)
        # What `update` copies, as views made once; positions and rotations follow every update.
        self._frames: list[tuple[int, slice, Array]] = []  # frame, components, rows of J
        self._coms: list[tuple[slice, Array]] = []  # axes, rows of J
        self._points: list[tuple[Array, Array]] = []  # position, rows of f
        self._turns: list[tuple[slice, Array]] = []  # rows, transposed rotation
        for part in parts:
            self._add(part, None if part.frame is None else part.frame(robot))

    def _add(self, part: Part, frame: int | None) -> None:
        rows = self.rows[part]
        if frame is None:
            position = self.data.com[0]
            self._coms.append((part.axes, self.J[rows]))
        else:
            position = self.data.oMf[frame].translation
            self._frames.append((frame, part.twist, self.J[rows]))
            if part.turns:
                turned = slice(rows.start + part.n_axes, rows.stop)
                self._turns.append((turned, self.data.oMf[frame].rotation.T))
        if part.n_axes:
            self._points.append((position[part.axes], self.f[rows][: part.n_axes]))

    def update(self, q: Array) -> None:
        """Refill J and f at q (7 + n,)."""
        model, data = self.model, self.data
        J_com = pin.jacobianCenterOfMass(model, data, q, False)  # also places joints, fills data.J
        for axes, J in self._coms:
            J[:] = J_com[axes]
        for frame, twist, J in self._frames:
            pin.updateFramePlacement(model, data, frame)
            J[:] = pin.getFrameJacobian(model, data, frame, WORLD_ALIGNED)[twist]
        for position, f in self._points:
            f[:] = position

    def com_velocity_derivative(self, q: Array, v: Array) -> Array:
        """Derivative (3, 6 + n) of J_com(q) v by q, at constant v (6 + n,)."""
        model, data = self.model, self.data
        pin.computeForwardKinematicsDerivatives(model, data, q, v, self._at_rest)
        pin.centerOfMass(model, data, pin.KinematicLevel.VELOCITY, True)
        return pin.getCenterOfMassVelocityDerivatives(model, data)

    def error(self, x: Array, rotations: Array, out: Array) -> None:
        """Fill out (m,), target minus actual, for one row of `BodyTargets.x` and `.rotations`."""
        np.subtract(x, self.f, out=out)
        for (rows, R_T), R_ref in zip(self._turns, rotations, strict=True):
            out[rows] = pin.log3(R_ref.dot(R_T))


def rows_of(parts: Sequence[Part]) -> dict[Part, slice]:
    """Rows of each part of a task vector."""
    rows, start = {}, 0
    for part in parts:
        rows[part] = slice(start, start + part.size)
        start += part.size
    return rows


def measure_tasks(tasks: BodyTasks, targets: BodyTargets, configurations: Array) -> Array:
    """Target minus actual (N, m) along configurations (N, 7 + n)."""
    errors = np.empty((len(configurations), tasks.m))
    for k, q in enumerate(configurations):
        tasks.update(q)
        tasks.error(targets.x[k], targets.rotations[k], errors[k])
    return errors


def judged_rows(tasks: BodyTasks, parts: Sequence[Part]) -> list[TaskRows]:
    """Positions and orientations of some parts, each with its tolerance."""
    judged = []
    for part in parts:
        rows = tasks.rows[part]
        middle = rows.start + part.n_axes
        if part.n_axes:
            judged.append(position_rows(part.name, slice(rows.start, middle), part.tolerance))
        if part.turns:
            judged.append(turn_rows(part.name, slice(middle, rows.stop)))
    return judged
