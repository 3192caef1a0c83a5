"""The moment about the vertical that friction under one sole can give.

The wrench that a rectangular sole, half as long as X and half as wide as Y, can pass on is the one
that forces at its four corners can have, each in the friction pyramid |f_x|, |f_y| <= m f_z along
the edges of the sole. About the centre of the sole, with forces f and moments n in its axes,

    n_z <= m (X + Y) f_z - |Y f_x + m n_x| - |X f_y + m n_y|
    n_z >= -m (X + Y) f_z + |Y f_x - m n_x| + |X f_y - m n_y|

as S. Caron, Q.-C. Pham and Y. Nakamura show ("Stability of surface contacts for humanoid robots:
closed-form formulae of the contact wrench cone for rectangular support areas", ICRA 2015). With
m = mu / sqrt(2) the pyramids lie inside the friction cones of coefficient mu, so that forces that
hold the sole exist. This moment is the most that any distribution of the pressure with the same
centre of pressure allows: pressure that gathers at this point turns the sole about it freely.
"""

from __future__ import annotations

import math

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FRICTION
from mgs.core.contact import Side, Support
from mgs.core.geometry import rotate_planar, yaw_from_quat_xyzw
from mgs.motion import Motion
from mgs.motion.dynamics import WholeBodyMotion


def yaw_moments(motion: Motion, body: WholeBodyMotion) -> tuple[Array, Array]:
    """Moment (N,) about the vertical through the ZMP, and the largest one of its sign [N m].

    Not a number where both soles are in support.
    """
    needed = np.full(motion.n_samples, np.nan)
    available = needed.copy()
    for side in Side:
        k = motion.support == Support.single(side)
        spec = motion.robot.sole_spec(side)
        wrench, zmp, sole = body.wrench[k], body.zmp[k], body.soles[k, side]
        low, high = yaw_limits(wrench, zmp, sole, spec.length, spec.width)
        needed[k] = yaw_moment(wrench, zmp)
        available[k] = np.where(needed[k] < 0.0, -low, high)
    return needed, available


def yaw_moment(wrench: Array, zmp: Array) -> Array:
    """Moment (m,) about the vertical through points (m, 2), of wrenches (m, 6) about the origin."""
    return np.asarray(wrench[:, 5] - zmp[:, 0] * wrench[:, 1] + zmp[:, 1] * wrench[:, 0])


def yaw_limits(
    wrench: Array, zmp: Array, sole: Array, length: float, width: float, friction: float = FRICTION
) -> tuple[Array, Array]:
    """Least and largest moment (m,) about the vertical through the ZMP that one sole can give.

    Both are 0 where the tangential force alone lets the sole slide. A ZMP beyond an edge counts as
    on the edge, since another check says that it is beyond.

    Args:
        wrench: (m, 6) force [N] and moment [N m] about the world origin, of the ground on the sole.
        zmp: (m, 2) zero-moment point at the height of the sole [m].
        sole: (m, 7) pose of the level sole in the world.
        length: length of the sole along its x axis [m].
        width: width of the sole along its y axis [m].
        friction: Coulomb coefficient of the pair of sole and ground.
    """
    m, X, Y = friction / math.sqrt(2.0), 0.5 * length, 0.5 * width
    heading = yaw_from_quat_xyzw(sole[:, 3:])
    fx, fy = rotate_planar(wrench[:, :2], -heading).T
    fz = wrench[:, 2]
    x, y = np.clip(rotate_planar(zmp - sole[:, :2], -heading), [-X, -Y], [X, Y]).T
    nx, ny = y * fz, -x * fz
    most = m * (X + Y) * fz
    high = most - np.abs(Y * fx + m * nx) - np.abs(X * fy + m * ny)
    low = np.abs(Y * fx - m * nx) + np.abs(X * fy - m * ny) - most
    to_zmp = x * fy - y * fx  # moment about the centre of the sole, of the force at the ZMP
    holds = (np.abs(fx) <= m * fz) & (np.abs(fy) <= m * fz)
    return np.where(holds, low - to_zmp, 0.0), np.where(holds, high - to_zmp, 0.0)
