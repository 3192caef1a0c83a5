"""The block `keyframes` of a gait file: named instants that the body passes at rest."""

from __future__ import annotations

import itertools
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from mgs.core.config import Model
from mgs.core.constants import COM_TOLERANCE
from mgs.gait.balance import MAX_SECONDS, Displacement

Vector = Annotated[list[Displacement], Field(min_length=3, max_length=3)]
Turn = Annotated[float, Field(ge=-1.6, le=1.6)]
Turns = Annotated[list[Turn], Field(min_length=3, max_length=3)]


def _switch_of_yaml(value: object) -> object:
    """YAML 1.1 reads unquoted on and off as true and false."""
    return {True: "on", False: "off"}[value] if isinstance(value, bool) else value


Switch = Annotated[Literal["on", "off"], BeforeValidator(_switch_of_yaml)]
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
        {},
        description="Joint angles of arms, head and waist, without balance of legs too [rad].",
    )


class KeyframesParameters(Model):
    """Both feet stay where they are; the body goes from key to key, minimum jerk in between.

    It begins in the half-sitting posture. The torso is as at rest unless a key turns it. A hand
    that some key names is led through the whole motion, its arm's joints follow; all other joints
    of arms, head and waist go by `posture`.
    """

    balance: Switch = Field(
        "on",
        description="off: keys are joint postures alone, nothing is said about balance on the way, "
        "and the motion passes if the robot stands at its end.",
    )
    lying: Literal["front", "back"] | None = Field(
        None, description="What it lies on at the start, without balance; null: it stands."
    )
    begin: dict[str, JointAngle] = Field(
        {}, description="Joint angles at the start, without balance; the others half-sitting [rad]."
    )
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
    def _asks_of_the_body_what_it_can_keep(self) -> KeyframesParameters:
        if self.balance == "on":
            for name in ("lying", "begin"):
                if getattr(self, name):
                    raise ValueError(f"{name} is for motions without balance; set balance: off")
            return self
        for i, key in enumerate(self.keys):
            for name in ("com", "crouch", "torso", "left_hand", "right_hand"):
                if getattr(key, name) is not None:
                    raise ValueError(
                        f"keys.{i}.{name}: without balance nobody knows where the base is; name "
                        "joints in posture, or leave out balance: off"
                    )
        return self

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
