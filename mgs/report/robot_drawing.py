"""Drawing of a robot from its collision boxes, in parallel projection.

The faces that are turned to the viewer are drawn, farther faces first. Shapes other than boxes are
drawn as their bounding boxes.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from numpy.typing import ArrayLike

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.report.canvas import SIDE_COLOURS
from mgs.robot import Robot, shape_corners
from mgs.robot.limbs import joint_chain

TRUNK_COLOUR, GHOST_COLOUR = "0.72", "0.6"
# indices of `UNIT_CORNERS` of each face, counter-clockwise as seen from outside
FACES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)


@dataclass(frozen=True, eq=False)
class View:
    """Parallel projection: unit vectors in the world to the right, up and towards the viewer."""

    right: Array
    up: Array
    towards: Array

    def project(self, points: ArrayLike) -> Array:
        """Picture coordinates (..., 2) [m] of points (..., 3) in the world."""
        points = np.asarray(points, dtype=float)
        return np.stack([points @ self.right, points @ self.up], axis=-1)


def view_from(azimuth_deg: float, elevation_deg: float) -> View:
    """View from a direction [deg]: azimuth 0 is from the front (+x), 90 from the left (+y)."""
    azimuth, elevation = np.radians([azimuth_deg, elevation_deg])
    flat = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    towards = np.cos(elevation) * flat + np.array([0.0, 0.0, np.sin(elevation)])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return View(right, np.cross(towards, right), towards)


FRONT = view_from(0.0, 0.0)
RIGHT_SIDE = view_from(-90.0, 0.0)  # the robot walks to the right of the picture


def draw_robot(
    axes: Axes,
    robot: Robot,
    q: Array,
    view: View,
    *,
    offset: tuple[float, float] = (0.0, 0.0),
    ghost: bool = False,
    zorder: float = 3.0,
) -> None:
    """Draw the robot at configuration q (7 + n,).

    Args:
        axes: axes in metres.
        robot: robot model.
        q: configuration.
        view: projection.
        offset: offset (2,) of picture coordinates [m].
        ghost: draw outlines only, for a pose for comparison.
        zorder: drawing order relative to other artists.
    """
    faces = box_corners(robot, q)[:, FACES]  # (b, 6, 4, 3)
    normals = _normals(faces)
    visible = (normals @ view.towards) > 1e-9
    order = np.argsort((faces @ view.towards).mean(axis=-1)[visible])
    outlines = (view.project(faces)[visible] + np.asarray(offset))[order]
    light = 0.62 + 0.38 * np.abs(normals @ _light(view))
    colours = (light[..., None] * _colours(robot)[:, None])[visible][order]
    axes.add_collection(
        PolyCollection(
            list(outlines),
            facecolor="none" if ghost else colours,
            edgecolor=GHOST_COLOUR if ghost else 0.6 * colours,
            linewidth=0.5 if ghost else 0.35,
            linestyle="--" if ghost else "-",
            zorder=zorder,
        )
    )


def _light(view: View) -> Array:
    direction = view.towards + 0.9 * view.up + 0.35 * view.right
    return direction / np.linalg.norm(direction)


def box_corners(robot: Robot, q: Array) -> Array:
    """Corners (b, 8, 3) in the world of the boxes of a robot at configuration q (7 + n,) [m]."""
    geometry = robot.geometry
    data, placements = robot.model.createData(), geometry.createData()
    pin.updateGeometryPlacements(robot.model, data, geometry, placements, q)
    R = np.stack([T.rotation for T in placements.oMg])
    origin = np.stack([T.translation for T in placements.oMg])
    return np.asarray(origin[:, None] + np.einsum("bij,bcj->bci", R, _local_corners(robot)))


def _normals(faces: Array) -> Array:
    """Outward unit normals (b, 6, 3) of faces (b, 6, 4, 3)."""
    normals = np.cross(faces[..., 1, :] - faces[..., 0, :], faces[..., 3, :] - faces[..., 0, :])
    return np.asarray(normals / np.linalg.norm(normals, axis=-1, keepdims=True))


@functools.lru_cache(maxsize=8)
def _local_corners(robot: Robot) -> Array:
    return shape_corners(robot.geometry)


@functools.lru_cache(maxsize=8)
def _colours(robot: Robot) -> Array:
    """Colours (b, 3) of all shapes, for left limbs, right limbs and trunk."""
    colours = []
    limbs = {side: _limb_joints(robot, side) for side in Side}
    for item in robot.geometry.geometryObjects:
        side = next((s for s in Side if item.parentJoint in limbs[s]), None)
        colours.append(to_rgb(TRUNK_COLOUR if side is None else SIDE_COLOURS[side]))
    return np.array(colours)


def _limb_joints(robot: Robot, side: Side) -> set[int]:
    """Joints that move the sole or hand of this side but not of the other side."""

    def moving(which: Side) -> set[int]:
        frames = (robot.sole_frames[which], robot.hand_frames[which])
        return {joint for frame in frames for joint in joint_chain(robot, frame)}

    return moving(side) - moving(side.other)
