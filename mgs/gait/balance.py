"""The block `balance` of a gait file: displacements of CoM, torso and hands on fixed feet."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from mgs.core.config import Model
from mgs.core.constants import COM_TOLERANCE

MAX_SECONDS = 36_000.0

Displacement = Annotated[float, Field(ge=-2.0, le=2.0)]
Frequency = Annotated[float, Field(gt=0.0, le=20.0)]
ChannelName = Literal[
    "com_x", "com_y", "com_z", "torso_roll", "torso_pitch", "torso_yaw",
    "left_hand_x", "left_hand_y", "left_hand_z", "right_hand_x", "right_hand_y", "right_hand_z",
]  # fmt: skip


class Channel(Model):
    """Displacement of one coordinate of CoM, torso or a hand from its value at rest.

    Axes of the world frame: x forward, y to the left, z up.
    """

    task: ChannelName = Field(
        description="Coordinate that moves: a position of the centre of mass (com) or of a hand "
        "[m], or a rotation of the torso [rad]."
    )


class ConstantChannel(Channel):
    """A constant displacement of one coordinate."""

    wave: Literal["constant"] = Field(description="Shape of the displacement over time.")
    value: Displacement = Field(
        description="Displacement from the value at rest: [m] for centre of mass and hands, [rad] "
        "for the torso."
    )


class SineChannel(Channel):
    """A sinusoidal displacement of one coordinate: amplitude sin(2 pi frequency t + phase).

    Time t is measured from the start of the motion.
    """

    wave: Literal["sine"] = Field(description="Shape of the displacement over time.")
    amplitude: Displacement = Field(
        description="Largest displacement from the value at rest: [m] for centre of mass and "
        "hands, [rad] for the torso."
    )
    frequency: Frequency = Field(description="Number of periods per second [Hz].")
    phase: float = Field(
        0.0, ge=-10.0, le=10.0, description="Phase of the sine at the start of the motion [rad]."
    )


class RampChannel(Channel):
    """A displacement of one coordinate from 0 to `value` between two times, with minimum jerk.

    Afterwards the displacement stays at `value`.
    """

    wave: Literal["ramp"] = Field(description="Shape of the displacement over time.")
    value: Displacement = Field(
        description="Final displacement from the value at rest: [m] for centre of mass and hands, "
        "[rad] for the torso."
    )
    start: float = Field(
        ge=0.0,
        le=MAX_SECONDS,
        description="Time at which the ramp starts, measured from the start of the motion [s].",
    )
    end: float = Field(
        ge=0.0,
        le=MAX_SECONDS,
        description="Time at which the ramp ends, measured from the start of the motion [s].",
    )

    @model_validator(mode="after")
    def _ends_after_its_start(self) -> RampChannel:
        if not self.end > self.start:
            raise ValueError(f"end = {self.end:g} s is not after start = {self.start:g} s")
        return self


class FigureEightChannel(Model):
    """A figure eight of centre of mass (com) or hand in a plane, around its position at rest.

    Axes of the world frame: x forward, y to the left, z up.
    """

    wave: Literal["figure_eight"] = Field(description="Shape of the displacement over time.")
    task: Literal["com", "left_hand", "right_hand"] = Field(
        description="Point that moves on the figure eight."
    )
    plane: Literal["xy", "xz", "yx", "yz", "zx", "zy"] = Field(
        "yz",
        description="Plane of the figure eight, two axes: along the first one the two loops lie "
        "side by side.",
    )
    width: Displacement = Field(
        description="Extent of the figure eight along the first axis of the plane [m]; a negative "
        "value reverses the direction of the motion along this axis."
    )
    height: Displacement = Field(
        description="Extent of the figure eight along the second axis of the plane [m]; a "
        "negative value reverses the direction of the motion along this axis."
    )
    frequency: Frequency = Field(description="Number of complete figures per second [Hz].")


AnyChannel = Annotated[
    ConstantChannel | SineChannel | RampChannel | FigureEightChannel, Field(discriminator="wave")
]


class BalanceParameters(Model):
    """Parameters of a motion on fixed feet that moves centre of mass (CoM), torso and hands.

    Each coordinate follows the sum of its channels. The motion begins and ends in the half-sitting
    posture (standing with bent knees). A hand without a channel has no task: its position is free.
    """

    sizes: Literal["given", "relative"] = Field(
        "given",
        description="Unit of the sizes. given: displacements and com_height in m. relative, for "
        "any robot: those of the centre of mass in multiples of the leg length, those "
        "of hands in multiples of the arm length, com_height in multiples of its "
        "value at rest.",
    )
    duration: float = Field(gt=0.0, le=MAX_SECONDS, description="Duration of the whole motion [s].")
    rest: float = Field(
        0.5, ge=0.0, le=60.0, description="Duration of rest at the start and at the end [s]."
    )
    ease: float = Field(
        1.0,
        gt=0.0,
        le=60.0,
        description="Duration over which the displacements grow from 0 after the first rest and "
        "decrease to 0 before the last rest [s].",
    )
    com_height: float | None = Field(
        None,
        ge=1e-3,
        le=3.0,
        description="Height of the centre of mass above the ground [m], to which the "
        "displacements are added; null: height in the half-sitting posture of the robot.",
    )
    com_tolerance: float = Field(
        COM_TOLERANCE,
        gt=0.0,
        le=1.0,
        description="Largest allowed distance of the centre of mass from its reference [m]. "
        "Increase this value if the channels are beyond the reach of the robot; the solvers ik1 "
        "to ik5 then come as close as possible.",
    )
    channels: list[AnyChannel] = Field(
        min_length=1,
        max_length=100,
        description="Displacements of centre of mass, torso and hands over time; "
        "channels of the same task are added.",
    )

    @model_validator(mode="after")
    def _has_room_for_its_ends(self) -> BalanceParameters:
        ends = 2.0 * (self.rest + self.ease)
        if not self.duration > ends:
            raise ValueError(
                f"duration = {self.duration:g} s leaves no time for the motion: its ends take "
                f"2 (rest + ease) = {ends:g} s; use a longer duration"
            )
        return self
