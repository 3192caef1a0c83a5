"""The block `balance` of a gait file: channels that CoM, torso and hands follow."""

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
    """One component of the body's motion, as a displacement from where it stands at rest."""

    task: ChannelName = Field(description="What moves [m or rad].")


class ConstantChannel(Channel):
    """A constant displacement."""

    wave: Literal["constant"] = Field(description="Kind of channel.")
    value: Displacement = Field(description="[m or rad]")


class SineChannel(Channel):
    """amplitude sin(2 pi frequency t + phase), t from the start of the motion."""

    wave: Literal["sine"] = Field(description="Kind of channel.")
    amplitude: Displacement = Field(description="[m or rad]")
    frequency: Frequency = Field(description="[Hz]")
    phase: float = Field(0.0, ge=-10.0, le=10.0, description="[rad]")


class RampChannel(Channel):
    """From 0 to `value` between two times, minimum jerk; stays there."""

    wave: Literal["ramp"] = Field(description="Kind of channel.")
    value: Displacement = Field(description="[m or rad]")
    start: float = Field(ge=0.0, le=MAX_SECONDS, description="[s]")
    end: float = Field(ge=0.0, le=MAX_SECONDS, description="[s]")

    @model_validator(mode="after")
    def _ends_after_its_start(self) -> RampChannel:
        if not self.end > self.start:
            raise ValueError(f"end = {self.end:g} s is not after start = {self.start:g} s")
        return self


class FigureEightChannel(Model):
    """A figure eight in a plane: width along its first axis, height along its second."""

    wave: Literal["figure_eight"] = Field(description="Kind of channel.")
    task: Literal["com", "left_hand", "right_hand"] = Field(description="Point that draws it.")
    plane: Literal["xy", "xz", "yx", "yz", "zx", "zy"] = Field("yz", description="Long axis first.")
    width: Displacement = Field(description="From end to end along the first axis [m].")
    height: Displacement = Field(description="From end to end along the second axis [m].")
    frequency: Frequency = Field(description="Eights per second [Hz].")


AnyChannel = Annotated[
    ConstantChannel | SineChannel | RampChannel | FigureEightChannel, Field(discriminator="wave")
]


class BalanceParameters(Model):
    """Both feet stay where they are; CoM, torso and hands follow the sum of their channels.

    Everything is eased in from the half-sitting posture and out to it. Hands without a channel are
    not asked for anything.
    """

    duration: float = Field(gt=0.0, le=MAX_SECONDS, description="Of the whole motion [s].")
    rest: float = Field(0.5, ge=0.0, le=60.0, description="At rest, at either end [s].")
    ease: float = Field(1.0, gt=0.0, le=60.0, description="Fading in, and fading out [s].")
    com_height: float | None = Field(
        None, ge=1e-3, le=3.0, description="Height that com_z adds to [m]; null: posture."
    )
    com_tolerance: float = Field(
        COM_TOLERANCE,
        gt=0.0,
        le=1.0,
        description="How far the CoM may stay behind its reference [m]; more than the default "
        "where more is asked than the robot can reach, which ik1 to ik5 are made for.",
    )
    channels: list[AnyChannel] = Field(
        min_length=1, max_length=100, description="What moves; channels of the same task add up."
    )

    @model_validator(mode="after")
    def _has_room_for_its_ends(self) -> BalanceParameters:
        ends = 2.0 * (self.rest + self.ease)
        if not self.duration > ends:
            raise ValueError(
                f"duration = {self.duration:g} s leaves nothing between the ends, which take "
                f"2 (rest + ease) = {ends:g} s; lengthen duration"
            )
        return self
