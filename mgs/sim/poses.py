"""Poses of soles and torso along a replay, and when they mean a fall."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.geometry import sole_corners
from mgs.robot import Robot
from mgs.sim.measure import angle_between

FALL_TILT = float(np.radians(45.0))  # of the torso's vertical against the plan's
FALL_HEIGHT = 0.6  # of the base above the ground, relative to the plan's


def on_ground(robot: Robot, q: Array, height: float = 0.0) -> Array:
    """Configuration (7 + n,) like q, its lowest sole corner at a height [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    lowest = np.inf
    for side, frame in zip(Side, robot.sole_frames, strict=True):
        spec, pose = robot.sole_spec(side), data.oMf[frame]
        corners = sole_corners(np.zeros(3), spec.length, spec.width)
        heights = pose.translation[2] + corners @ pose.rotation[2, :2]
        lowest = min(lowest, float(heights.min()))
    out = q.copy()
    out[2] += height - lowest
    return out


def fallen(up: Array, up_plan: Array, height: Array, height_plan: Array) -> NDArray[np.bool_]:
    """Where (...) the torso's vertical (..., 3) or the base's height (...) [m] gave up the plan."""
    down = (angle_between(up, up_plan) > FALL_TILT) | (height < FALL_HEIGHT * height_plan)
    return np.asarray(down)


def poses_along(robot: Robot, q: Array, data: pin.Data | None = None) -> tuple[Array, Array]:
    """Soles (M, 2, 7) and the world's vertical seen from the torso (M, 3) at q (M, 7 + n)."""
    data = robot.model.createData() if data is None else data
    soles, up = np.empty((len(q), 2, 7)), np.empty((len(q), 3))
    model, (left, right), torso = robot.model, robot.sole_frames, robot.torso_frame
    for k, row in enumerate(q):
        pin.forwardKinematics(model, data, row)
        soles[k, 0] = pin.SE3ToXYZQUAT(pin.updateFramePlacement(model, data, left))
        soles[k, 1] = pin.SE3ToXYZQUAT(pin.updateFramePlacement(model, data, right))
        up[k] = pin.updateFramePlacement(model, data, torso).rotation[2]
    return soles, up
