"""Jdot v: the acceleration of tasks while no generalised velocity changes."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.ik_solver.floating.tasks import COM_AXES, WORLD_ALIGNED
from mgs.robot import Robot

SOLE_AXES, HAND_AXES, TURN_AXES = slice(0, 6), slice(0, 3), slice(3, 6)


class JacobianRate:
    """Jdot v of the rows of `BodyTasks` with the same parts; world frame [m/s^2] and [rad/s^2].

    Points accelerate by their classical acceleration, d2x/dt2, not by the spatial one.
    """

    def __init__(self, robot: Robot, parts: tuple[str, ...], rows: dict[str, slice]) -> None:
        self.model, self.data = robot.model, robot.model.createData()
        self.zero = np.zeros(robot.model.nv)
        self._coms = [(rows[part], COM_AXES[part]) for part in parts if part in COM_AXES]
        self._frames = []
        for part in parts:
            if part == "torso":
                self._frames.append((rows[part], robot.torso_frame, TURN_AXES))
            elif part not in COM_AXES:
                label, kind = part.split("_")
                side = Side[label.upper()]
                frame = (robot.sole_frames if kind == "sole" else robot.hand_frames)[side]
                axes = SOLE_AXES if kind == "sole" else HAND_AXES
                self._frames.append((rows[part], frame, axes))

    def product(self, q: Array, v: Array, out: Array) -> None:
        """Fill out (m,) with Jdot v at q (7 + n,), v (6 + n,)."""
        model, data = self.model, self.data
        pin.centerOfMass(model, data, q, v, self.zero, False)  # also places and moves the joints
        for rows, axes in self._coms:
            out[rows] = data.acom[0][axes]
        for rows, frame, axes in self._frames:
            pin.updateFramePlacement(model, data, frame)
            motion = pin.getFrameClassicalAcceleration(model, data, frame, WORLD_ALIGNED)
            out[rows] = motion.vector[axes]
