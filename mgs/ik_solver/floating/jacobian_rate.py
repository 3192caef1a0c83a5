"""The product of the rate of the task Jacobian and the velocity, dJ/dt v.

It is the acceleration of the tasks while no generalised velocity changes.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.ik_solver.floating.tasks import WORLD_ALIGNED, BodyTasks
from mgs.robot import Robot


class JacobianRate:
    """dJ/dt v of the rows of some tasks, in the world frame [m/s^2] and [rad/s^2].

    Points accelerate by their classical acceleration, d2x/dt2, not by the spatial one.
    """

    def __init__(self, robot: Robot, tasks: BodyTasks) -> None:
        self.model, self.data = robot.model, robot.model.createData()
        self.zero = np.zeros(robot.model.nv)
        rows = tasks.rows
        self._coms = [(rows[part], part.axes) for part in tasks.parts if part.frame is None]
        self._frames = [
            (rows[part], part.frame(robot), part.twist) for part in tasks.parts if part.frame
        ]

    def product(self, q: Array, v: Array, out: Array) -> None:
        """Fill out (m,) with dJ/dt v at q (7 + n,) and v (6 + n,)."""
        model, data = self.model, self.data
        pin.centerOfMass(model, data, q, v, self.zero, False)  # also places and moves the joints
        for rows, axes in self._coms:
            out[rows] = data.acom[0][axes]
        for rows, frame, twist in self._frames:
            pin.updateFramePlacement(model, data, frame)
            motion = pin.getFrameClassicalAcceleration(model, data, frame, WORLD_ALIGNED)
            out[rows] = motion.vector[twist]
