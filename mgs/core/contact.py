"""Which foot is where and which one carries the robot: the vocabulary of all stages."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


class Side(IntEnum):
    """A leg or an arm; the index into arrays with a side axis."""

    LEFT = 0
    RIGHT = 1

    @property
    def other(self) -> Side:
        """The opposite side."""
        return Side(1 - self)

    @property
    def label(self) -> str:
        """Lower-case name, as used in files."""
        return self.name.lower()

    @property
    def sign(self) -> int:
        """+1 for left and -1 for right, the sign of y on that side."""
        return 1 - 2 * int(self)


class Support(IntEnum):
    """Which soles are in contact."""

    DOUBLE = 0
    LEFT = 1
    RIGHT = 2

    @property
    def label(self) -> str:
        """Lower-case name, as used in files."""
        return self.name.lower()

    @property
    def sides(self) -> tuple[Side, ...]:
        """The sides in contact."""
        return (Side.LEFT, Side.RIGHT) if self is Support.DOUBLE else (Side(self - 1),)

    @staticmethod
    def single(side: Side) -> Support:
        """Single support on one side."""
        return Support(side + 1)


@dataclass(frozen=True)
class Footstep:
    """Pose of a level sole in contact, world frame."""

    side: Side
    x: float  # [m]
    y: float  # [m]
    yaw: float  # [rad], counter-clockwise from above
    z: float = 0.0  # [m]
