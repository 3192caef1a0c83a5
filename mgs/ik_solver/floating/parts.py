"""The parts that a task vector of a floating-base robot is made of, each described once.

A part is one frame of the robot, or its CoM, with the components of its velocity that the task
prescribes: linear velocity first, then angular velocity. Those components are rows of a Jacobian;
the same components of the position, and the orientation as a rotation vector, are rows of an error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import COM_TOLERANCE, POSITION_TOLERANCE
from mgs.core.contact import Side
from mgs.gait.ik import PartName, TaskName
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory


@dataclass(frozen=True, eq=False)
class Part:
    """One part of a task vector."""

    name: str  # in messages
    task: TaskName  # in gait files
    twist: slice  # components of the velocity (6,) that the task prescribes
    reference: Callable[[TaskTrajectory, Array], Array]
    """Poses (N, 7) or positions (N, 3) from the tasks and the CoM (N, 3); world frame [m]."""
    frame: Callable[[Robot], int] | None = None
    """Id of the frame in the robot's model; None: the CoM."""
    tolerance: float = POSITION_TOLERANCE  # of the position [m]

    @property
    def size(self) -> int:
        """Number of rows."""
        return int(self.twist.stop - self.twist.start)

    @property
    def axes(self) -> slice:
        """Coordinates of the position (3,) that the task prescribes, none of them for the torso."""
        return slice(min(self.twist.start, 3), min(self.twist.stop, 3))

    @property
    def n_axes(self) -> int:
        """Number of these coordinates, which are the first rows."""
        return int(self.axes.stop - self.axes.start)

    @property
    def turns(self) -> bool:
        """Whether the task prescribes an orientation; its rows are the last three."""
        return bool(self.twist.stop > 3)


def _sole(side: Side) -> Part:
    return Part(
        f"{side.label} sole",
        "soles",
        slice(0, 6),
        reference=lambda tasks, com: tasks.soles[:, side],
        frame=lambda robot: robot.sole_frames[side],
    )


def _hand(side: Side) -> Part:
    return Part(
        f"{side.label} hand",
        "hands",
        slice(0, 3),
        reference=lambda tasks, com: tasks.hands[:, side] + com,
        frame=lambda robot: robot.hand_frames[side],
    )


def _com(name: str, axes: slice) -> Part:
    return Part(name, "com", axes, reference=lambda tasks, com: com, tolerance=COM_TOLERANCE)


LEFT_SOLE, RIGHT_SOLE = SOLES = (_sole(Side.LEFT), _sole(Side.RIGHT))
LEFT_HAND, RIGHT_HAND = HANDS = (_hand(Side.LEFT), _hand(Side.RIGHT))
COM, COM_XY, COM_Z = (
    _com("com", slice(0, 3)),
    _com("com xy", slice(0, 2)),
    _com("com z", slice(2, 3)),
)
TORSO = Part(
    "torso",
    "torso",
    slice(3, 6),
    reference=lambda tasks, com: np.pad(tasks.torso, ((0, 0), (3, 0))),
    frame=lambda robot: robot.torso_frame,
)
PARTS: dict[PartName, tuple[Part, ...]] = {
    "soles": SOLES,
    "torso": (TORSO,),
    "com": (COM,),
    "com_xy": (COM_XY,),
    "com_z": (COM_Z,),
    "hands": HANDS,
}


def parts_of(names: Iterable[PartName], tasks: TaskTrajectory) -> tuple[Part, ...]:
    """Parts of the tasks that a gait file names, in its order, without hands that are free."""
    free = {HANDS[side] for side in Side if not tasks.hands_asked[side]}
    return tuple(part for name in names for part in PARTS[name] if part not in free)
