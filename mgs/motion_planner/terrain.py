"""Stairs and obstacles: the heights of footsteps, and swings that keep clear of edges."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Footstep
from mgs.core.curves import at_rest, evaluate
from mgs.core.errors import InfeasibleGaitError
from mgs.core.geometry import polygon_margins, rectangle_gaps, sole_corners
from mgs.core.scene import Box, ground_below
from mgs.motion_planner.motion_plan import SwingPath
from mgs.robot import Robot

N_ALONG = 101  # number of places of a swing that are checked
# Shapes of a swing that are tried: 0 rises, moves and falls at once, 1 one after the other.
SQUARENESS = np.linspace(0.0, 1.0, 11)
ROUNDING = 1e-9  # [m]


def corners_of(robot: Robot, footstep: Footstep) -> Array:
    """Corners (4, 2) of a footstep [m]."""
    sole = robot.sole_spec(footstep.side)
    return sole_corners([footstep.x, footstep.y, footstep.yaw], sole.length, sole.width)


def stand_on(
    robot: Robot, footsteps: tuple[Footstep, ...], boxes: tuple[Box, ...]
) -> list[Footstep]:
    """Footsteps raised to the tops of the boxes below them.

    Raises:
        InfeasibleGaitError: a footstep stands over the edge of a box.
    """
    if not boxes:
        return list(footsteps)
    placed = []
    for number, footstep in enumerate(footsteps):
        corners = corners_of(robot, footstep)
        z = float(ground_below(boxes, corners))
        tops = [box for box in boxes if box.height == z]
        insides = [float(polygon_margins(corners, box.corners).min()) for box in tops]
        if z > 0.0 and max(insides) < 0.0:
            raise InfeasibleGaitError(
                f"footstep {number} stands {-1e3 * max(insides):.1f} mm over the edge of a box "
                f"{z:g} m high; move the footstep or use a longer box in walk.boxes"
            )
        placed.append(replace(footstep, z=z))
    return placed


def refuse_crossing(
    robot: Robot, start: Footstep, target: Footstep, support: Footstep, number: int
) -> None:
    """Raise InfeasibleGaitError where the swing sole would strike the other leg on its way."""
    path = _planar_path(start, target, np.linspace(0.0, 1.0, N_ALONG))
    gaps = rectangle_gaps(_corners_at(robot, target, path), corners_of(robot, support))
    if gaps.min() < 0.0:
        raise InfeasibleGaitError(
            f"on its way to footstep {number} the {target.side.label} foot would strike the other "
            f"leg, by {-1e3 * gaps.min():.1f} mm; use a larger walk.step_width or a smaller step"
        )


def swing_over(
    robot: Robot, start: Footstep, target: Footstep, plan: SwingParameters
) -> SwingPath | None:
    """The least square swing that keeps clear of boxes; None where there is no box on the way.

    Raises:
        InfeasibleGaitError: even the squarest swing comes closer to an edge than the clearance.
    """
    path = _planar_path(start, target, np.linspace(0.0, 1.0, N_ALONG))
    ground = ground_below(plan.boxes, _corners_at(robot, target, path))
    if not ground.any():
        return None
    apex = float(ground.max()) + plan.step_height
    for squareness in SQUARENESS:
        swing = _square_swing(start, target, apex, plan.duration, float(squareness))
        room = _room(robot, target, swing, plan)
        if room >= 0.0:
            return swing
    raise InfeasibleGaitError(
        f"the swing to ({target.x:.3f}, {target.y:.3f}) m comes "
        f"{1e3 * (plan.clearance + room):.1f} mm close to an edge, "
        f"but walk.clearance is {1e3 * plan.clearance:.1f} mm; use a greater walk.step_height or "
        "a smaller walk.clearance"
    )


@dataclass(frozen=True)
class SwingParameters:
    """Requirements on a swing over boxes."""

    boxes: tuple[Box, ...]
    step_height: float  # highest point above the highest ground on the way [m]
    clearance: float  # least height of the sole above a box that it does not stand on [m]
    duration: float  # of the swing [s]


def _planar_path(start: Footstep, target: Footstep, along: Array) -> Array:
    """Planar poses (m, 3) at parts (m,) of the straight way between two footsteps."""
    a, b = (np.array([f.x, f.y, f.yaw]) for f in (start, target))
    return np.asarray(a + along[:, None] * (b - a))


def _corners_at(robot: Robot, footstep: Footstep, poses: Array) -> Array:
    """Corners (m, 4, 2) of the sole of a footstep at planar poses (m, 3)."""
    sole = robot.sole_spec(footstep.side)
    return sole_corners(poses, sole.length, sole.width)


def _square_swing(
    start: Footstep, target: Footstep, apex: float, duration: float, squareness: float
) -> SwingPath:
    """A swing up to the apex [m], along and down: all at once (0) or one after the other (1)."""
    overlap = 0.15 * (1.0 - squareness)
    rise, fall = 0.35 + overlap, 0.65 - overlap
    set_off, arrive = 0.3 * squareness, 1.0 - 0.3 * squareness
    a, b = ([f.x, f.y, f.yaw] for f in (start, target))
    return SwingPath(
        planar=at_rest(duration * np.array([0.0, set_off, arrive, 1.0]), [a, a, b, b]),
        height=at_rest(
            duration * np.array([0.0, rise, fall, 1.0]), [[start.z], [apex], [apex], [target.z]]
        ),
    )


def _room(robot: Robot, target: Footstep, swing: SwingPath, plan: SwingParameters) -> float:
    """Least height of the sole above boxes, minus the clearance [m].

    A sole that is entirely above a box, as at lift-off and landing, needs no clearance.
    """
    times = np.linspace(0.0, plan.duration, N_ALONG)
    corners = _corners_at(robot, target, evaluate(swing.planar, times))
    height = evaluate(swing.height, times)[:, 0]
    room = np.full(N_ALONG, np.inf)
    for box in plan.boxes:
        covered = rectangle_gaps(corners, box.corners) < 0.0
        margins = polygon_margins(corners.reshape(-1, 2), box.corners).reshape(N_ALONG, 4)
        needed = np.where(margins.min(axis=1) >= 0.0, 0.0, plan.clearance)
        room = np.minimum(room, np.where(covered, height - box.height - needed, np.inf))
    return float(room.min()) + ROUNDING
