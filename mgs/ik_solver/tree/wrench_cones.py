"""Wrenches that a sole can bear: its friction and its rectangle, as linear inequalities.

Coulomb friction and a contact rectangle that may only be pushed bound the wrench by 16 half-spaces:
S. Caron, Q.-C. Pham and Y. Nakamura, "Stability of surface contacts for humanoid robots:
closed-form formulae of the contact wrench cone for rectangular support areas", ICRA 2015.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FRICTION
from mgs.core.contact import Side
from mgs.core.geometry import rotations_from_quat_xyzw
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

N_CONE = 16  # half-spaces that bound the wrench of one sole


def wrench_cones(robot: Robot, side: Side, tasks: TaskTrajectory, wrenches: Array) -> Array:
    """Rows U (N, 16, 6) with U w <= 0 for the wrenches w about the world origin of one sole.

    A motion too fast for statics may put the planned centre of pressure beside the sole; the
    rectangle is then widened to contain it.

    Args:
        robot: gives the rectangle.
        side: the sole.
        tasks: give the poses of the sole.
        wrenches: (N, 2, 6) planned wrenches of both soles about the world origin [N] and [N m].
    """
    spec, poses, w = robot.sole_spec(side), tasks.soles[:, side], wrenches[:, side]
    R, p = rotations_from_quat_xyzw(poses[:, 3:]), poses[:, :3]
    load = np.maximum(w[:, 2], 1e-12)
    pressure = np.stack([-w[:, 4] / load, w[:, 3] / load, 0.0 * load], axis=1) - p
    local = np.abs(np.einsum("nji,nj->ni", R, pressure))  # R^T pressure
    x = np.maximum(0.5 * spec.length, local[:, 0])
    y = np.maximum(0.5 * spec.width, local[:, 1])
    # w_local = [R^T f; R^T (m - p x f)]
    to_local = np.zeros((len(p), 6, 6))
    to_local[:, :3, :3] = to_local[:, 3:, 3:] = R.transpose(0, 2, 1)
    to_local[:, 3:, :3] = -R.transpose(0, 2, 1) @ skew(p)
    return cone_of_rectangle(x, y, FRICTION) @ to_local


def cone_of_rectangle(x: Array, y: Array, mu: float) -> Array:
    """Rows (N, 16, 6) for half lengths x and half widths y (N,), in the sole's frame."""
    U = np.zeros((len(x), N_CONE, 6))
    U[:, :4, 0], U[:, :4, 1] = [1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]
    U[:, :4, 2] = -mu
    U[:, 4:8, 3], U[:, 4:8, 4] = [1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]
    U[:, 4:6, 2], U[:, 6:8, 2] = -y[:, None], -x[:, None]
    row = 8
    for turn in (1.0, -1.0):  # the moment about the vertical, either way
        for a in (1.0, -1.0):
            for b in (1.0, -1.0):
                U[:, row, 0], U[:, row, 1] = a * y, b * x
                U[:, row, 2] = -mu * (x + y)
                U[:, row, 3], U[:, row, 4] = turn * a * mu, turn * b * mu
                U[:, row, 5] = turn
                row += 1
    return U


def skew(p: Array) -> Array:
    """Matrices (..., 3, 3) of p x, for p (..., 3)."""
    S = np.zeros((*p.shape, 3))
    S[..., 0, 1], S[..., 0, 2], S[..., 1, 2] = -p[..., 2], p[..., 1], -p[..., 0]
    S[..., 1, 0], S[..., 2, 0], S[..., 2, 1] = p[..., 2], -p[..., 1], p[..., 0]
    return S
