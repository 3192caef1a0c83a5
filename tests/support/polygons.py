"""Support polygons of planned soles, by Qhull."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from mgs.core.contact import Support
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory


def support_hull(robot: Robot, tasks: TaskTrajectory, sample: int) -> np.ndarray:
    """Corners (m, 2) of the support polygon at one sample, counter-clockwise [m]."""
    corners = []
    for side in Support(tasks.support[sample]).sides:
        x, y, _, _, _, sine, cosine = tasks.soles[sample, side]
        yaw, sole = 2.0 * np.arctan2(sine, cosine), robot.sole_spec(side)
        ahead = 0.5 * sole.length * np.array([np.cos(yaw), np.sin(yaw)])
        beside = 0.5 * sole.width * np.array([-np.sin(yaw), np.cos(yaw)])
        corners += [[x, y] + i * ahead + j * beside for i in (-1, 1) for j in (-1, 1)]
    return np.array(corners)[ConvexHull(corners).vertices]
