"""The support polygon: the convex hull of the soles that are in contact, from above."""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Support
from mgs.core.geometry import convex_hull, sole_corners, yaw_from_quat_xyzw
from mgs.robot.robot import Robot


def support_polygon(robot: Robot, soles: Array, support: Support) -> Array:
    """Corners (m, 2) of the support polygon [m], counter-clockwise, in the world frame.

    Args:
        robot: the robot, whose soles are rectangles.
        soles: poses (2, 7) of the left and the right sole: position [m] and quaternion xyzw.
        support: which of them are in contact.
    """
    corners = []
    for side in support.sides:
        pose, sole = soles[side], robot.sole_spec(side)
        planar = [pose[0], pose[1], float(yaw_from_quat_xyzw(pose[3:]))]
        corners.append(sole_corners(planar, sole.length, sole.width))
    return convex_hull(np.concatenate(corners))
