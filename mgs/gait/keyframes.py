"""The block `keyframes` of a gait file: named instants that the body passes at rest."""

from __future__ import annotations

import itertools
from typing import Annotated

from pydantic import Field, model_validator

from mgs.config import Model
from mgs.gait.balance import COM_TOLERANCE, MAX_SECONDS, Displacement

Vector = Annotated[list[Displacement], Field(min_length=3, max_length=3)]
Turn = Annotated[float, Field(ge=-1.6, le=1.6)]
Turns = Annotated[list[Turn], Field(min_length=3, max_length=3)]
JointAngle = Annotated[float, Field(ge=-7.0, le=7.0)]


class Keyframe(Model):
    """Where the body shall be at one time; what it does not name stays as in the key before."""

    time: float = Field(gt=0.0, le=MAX_SECONDS, description="When it is reached [s].")
    hold: float = Field(0.0, ge=0.0, le=MAX_SECONDS, description="How long it is kept [s].")
    rest: bool = Field(
        False, description="First put everything back to where it is at rest, then what is named."
    )
    com: Vector | None = Field(None, description="CoM, displacement x, y, z from rest [m].")
    crouch: float | None = Field(
        None,
        ge=-50.0,
        le=100.0,
        description="CoM below where it is at rest, in per cent of the leg length; adds to com.",
    )
    torso: Turns | None = Field(
        None, description="Roll, pitch, yaw of the torso from where it is at rest [rad]."
    )
    left_hand: Vector | None = Field(
        None, description="Displacement x, y, z from rest, world axes [m]."
    )
    right_hand: Vector | None = Field(
        None, description="Displacement x, y, z from rest, world axes [m]."
    )
    posture: dict[str, JointAngle] = Field(
        {}, description="Joint angles of arms, head and waist [rad]."
    )


class KeyframesParameters(Model):
    """Both feet stay where they are; the body goes from key to key, minimum jerk in between.

    It begins in the half-sitting posture. The torso is as at rest unless a key turns it. A hand
    that some key names is led through the whole motion, its arm's joints follow; all other joints
    of arms, head and waist go by `posture`.
    """

    rest: float = Field(0.5, ge=0.0, le=60.0, description="At rest, at either end [s].")
    com_tolerance: float = Field(
        COM_TOLERANCE,
        gt=0.0,
        le=1.0,
        description="How far the CoM may stay behind its reference [m]; more than the default "
        "where more height is asked than the legs have.",
    )
    keys: list[Keyframe] = Field(min_length=1, max_length=200, description="In order of time.")

    @property
    def duration(self) -> float:
        """Of the whole motion [s]."""
        last = self.keys[-1]
        return last.time + last.hold + self.rest

    @model_validator(mode="after")
    def _comes_in_order(self) -> KeyframesParameters:
        if not self.keys[0].time > self.rest:
            raise ValueError(
                f"keys.0.time = {self.keys[0].time:g} s is within the rest of {self.rest:g} s that "
                "the motion begins with; use a later time or a shorter rest"
            )
        for i, (before, after) in enumerate(itertools.pairwise(self.keys), start=1):
            leaves = before.time + before.hold
            if not after.time > leaves:
                raise ValueError(
                    f"keys.{i}.time = {after.time:g} s is not after {leaves:g} s, when the key "
                    "before it ends; use a later time"
                )
        return self
