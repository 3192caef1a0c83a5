"""What is on the ground beside the robot: boxes to step on or over, balls to kick."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from mgs.core.arrays import Array
from mgs.core.geometry import rectangle_gaps, sole_corners
from mgs.core.limits import MAX_CROWD


@dataclass(frozen=True)
class Box:
    """A box on the ground z = 0, by the centre of its rectangle; world frame."""

    x: float  # [m]
    y: float  # [m]
    yaw: float  # [rad]
    length: float  # along its x [m]
    width: float  # along its y [m]
    height: float  # of its top [m]

    @property
    def corners(self) -> Array:
        """Corners (4, 2) from above, counter-clockwise [m]."""
        return sole_corners([self.x, self.y, self.yaw], self.length, self.width)


@dataclass(frozen=True)
class Ball:
    """A ball that rests on the ground until it is struck, and the strike that is planned."""

    x: float  # [m]
    y: float  # [m]
    radius: float  # [m]
    mass: float  # [kg]
    time: float  # of contact [s]
    direction: float  # in which it shall go [rad]
    speed: float  # of the sole at contact [m/s]


# Coulomb coefficient of a ball, on the ground and on the foot. With that of rubber soles, 1, a
# pushed ball would be wedged between the two, since it rubs on the foot as much as on the ground.
BALL_FRICTION = 0.3


@dataclass(frozen=True)
class Scene:
    """Everything on the ground but the robot."""

    boxes: tuple[Box, ...] = ()
    balls: tuple[Ball, ...] = ()


EMPTY = Scene()


PLACE = 0.1  # [m] side of the square in which boxes are counted


def is_crowded(boxes: Sequence[Box]) -> bool:
    """Whether more than MAX_CROWD boxes touch one square with the sides PLACE.

    A sole on so many boxes has as many times four contacts, and the time that engines need for a
    step grows with the cube of their number. Boxes count with their sides along x and y.
    """
    if len(boxes) <= MAX_CROWD:
        return False
    corners = np.array([box.corners for box in boxes])  # (n, 4, 2)
    low, high = corners.min(axis=1), corners.max(axis=1) + PLACE
    for x in low[:, 0]:  # a square that touches the most boxes can be moved until it begins there
        now = (low[:, 0] <= x) & (x <= high[:, 0])
        if np.count_nonzero(now) <= MAX_CROWD:
            continue
        begins, ends = np.sort(low[now, 1]), np.sort(high[now, 1])
        touched = np.arange(1, len(begins) + 1) - np.searchsorted(ends, begins, side="left")
        if touched.max() > MAX_CROWD:
            return True
    return False


def ground_below(boxes: tuple[Box, ...], corners: ArrayLike) -> Array:
    """Height (...) of the highest ground that convex quadrilaterals (..., 4, 2) cover [m]."""
    corners = np.asarray(corners, dtype=float)
    height = np.zeros(corners.shape[:-2])
    for box in boxes:
        covered = rectangle_gaps(corners, box.corners) < 0.0
        height = np.maximum(height, np.where(covered, box.height, 0.0))
    return height
