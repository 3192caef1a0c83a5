"""The block `keyframes` of a gait file: postures that the body reaches one after another."""

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
    """Text for an unquoted on or off, which YAML 1.1 reads as true and false."""
    return {True: "on", False: "off"}[value] if isinstance(value, bool) else value


Switch = Annotated[Literal["on", "off"], BeforeValidator(_switch_of_yaml)]
JointAngle = Annotated[float, Field(ge=-7.0, le=7.0)]


class Keyframe(Model):
    """State of the body at one time; a quantity without a value keeps its value from before.

    Axes of the world frame: x forward, y to the left, z up.
    """

    time: float = Field(
        gt=0.0,
        le=MAX_SECONDS,
        description="Time at which the body reaches this state, measured from the start of the "
        "motion [s].",
    )
    hold: float = Field(
        0.0, ge=0.0, le=MAX_SECONDS, description="Duration for which this state is held [s]."
    )
    rest: bool = Field(
        False,
        description="Whether all quantities return to their values at rest; true: they do, except "
        "those that this keyframe gives.",
    )
    com: Vector | None = Field(
        None,
        description="Displacement x, y, z of the centre of mass from its position at rest [m]; "
        "null: as in the keyframe before.",
    )
    crouch: float | None = Field(
        None,
        ge=-50.0,
        le=100.0,
        description="Distance by which the centre of mass is lowered from its height at rest [% "
        "of the leg length]; negative: raised; added to the z displacement of com; null: as in "
        "the keyframe before.",
    )
    torso: Turns | None = Field(
        None,
        description="Roll, pitch and yaw of the torso relative to its orientation at rest [rad]; "
        "null: as in the keyframe before.",
    )
    left_hand: Vector | None = Field(
        None,
        description="Displacement x, y, z of the left hand from its position at rest [m]; null: "
        "as in the keyframe before.",
    )
    right_hand: Vector | None = Field(
        None,
        description="Displacement x, y, z of the right hand from its position at rest [m]; null: "
        "as in the keyframe before.",
    )
    posture: dict[str, JointAngle] = Field(
        {},
        description="Angles by name of the joint [rad], for joints of arms, head and waist, and "
        "with `balance: off` also of the legs; joints that are not named keep their angles.",
    )


class KeyframesParameters(Model):
    """Parameters of a motion from keyframe to keyframe, with minimum jerk in between.

    The robot stands on fixed feet and begins in the half-sitting posture (with bent knees). If any
    keyframe displaces a hand, this hand is a task during the whole motion, and the joints of its
    arm follow from this task; all other joints of arms, head and waist follow `posture`. With
    `balance: off`, all joints follow `posture`.
    """

    sizes: Literal["given", "relative"] = Field(
        "given",
        description="Unit of the sizes. given: lengths in m, positions of hands from their "
        "positions at rest, joints by their names in the robot. relative, for any "
        "robot with `balance: on`: com in multiples of the leg length; left_hand and "
        "right_hand from the shoulder, in multiples of the arm length; joints in "
        "posture by role (`mgs robot show`), their angles from the half-sitting "
        "posture; those of arm joints that the robot does not have are left out.",
    )
    balance: Switch = Field(
        "on",
        description="Whether balance is planned. on: the robot stands on both feet during the "
        "motion; off: each keyframe is a joint posture only, and the motion passes if the robot "
        "stands at its end.",
    )
    lying: Literal["front", "back"] | None = Field(
        None,
        description="Side on which the robot lies at the start, only with `balance: off`; null: "
        "the robot stands.",
    )
    begin: dict[str, JointAngle] = Field(
        {},
        description="Initial angles by name of the joint [rad], only with `balance: off`; joints "
        "that are not named start in the half-sitting posture.",
    )
    rest: float = Field(
        0.5, ge=0.0, le=60.0, description="Duration of rest at the start and at the end [s]."
    )
    com_tolerance: float = Field(
        COM_TOLERANCE,
        gt=0.0,
        le=1.0,
        description="Largest allowed distance of the centre of mass from its reference [m]. "
        "Increase this value if keyframes ask for more height than the legs can reach.",
    )
    keys: list[Keyframe] = Field(
        min_length=1,
        max_length=200,
        description="List of keyframes (states of the body), in order of time.",
    )

    @property
    def duration(self) -> float:
        """Duration of the whole motion [s]."""
        last = self.keys[-1]
        return last.time + last.hold + self.rest

    @model_validator(mode="after")
    def _has_the_keys_of_its_kind_of_balance(self) -> KeyframesParameters:
        if self.balance == "on":
            for name in ("lying", "begin"):
                if getattr(self, name):
                    raise ValueError(f"{name} is for motions without balance; set balance: off")
            return self
        for i, key in enumerate(self.keys):
            for name in ("com", "crouch", "torso", "left_hand", "right_hand"):
                if getattr(key, name) is not None:
                    raise ValueError(
                        f"keys.{i}.{name}: not possible without balance, because the pose of the "
                        "base is not planned; name joints in posture, or leave out balance: off"
                    )
        return self

    @model_validator(mode="after")
    def _comes_in_order(self) -> KeyframesParameters:
        if not self.keys[0].time > self.rest:
            raise ValueError(
                f"keys.0.time = {self.keys[0].time:g} s is within the rest of {self.rest:g} s at "
                "the start of the motion; use a later time or a shorter rest"
            )
        for i, (before, after) in enumerate(itertools.pairwise(self.keys), start=1):
            leaves = before.time + before.hold
            if not after.time > leaves:
                raise ValueError(
                    f"keys.{i}.time = {after.time:g} s is not after the end of the key before, "
                    f"{leaves:g} s; use a later time"
                )
        return self
