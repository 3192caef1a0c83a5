"""The block `pick_up` of a gait file: one or both hands fetch an object from below."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from mgs.core.config import Model

Duration = Annotated[float, Field(gt=0.0, le=60.0)]
Coordinate = Annotated[float, Field(ge=-3.0, le=3.0)]
Position = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]


class PickUpParameters(Model):
    """Parameters of picking up an object on fixed feet.

    The hand moves to a point above the object, then straight down, grasps, moves straight up and
    returns to its position at rest. The origin of the world frame lies on the ground midway between
    the soles; x points forward, y to the left, z up.
    """

    sizes: Literal["given", "relative"] = Field(
        "given",
        description="Unit of the sizes. given: lengths in m. relative, for any robot: object, "
        "width and clearance in multiples of the leg length, payload in multiples of "
        "the mass of the robot.",
    )
    hand: Literal["left", "right", "both"] = Field(
        "right", description="Hand that picks up the object, or both hands."
    )
    object: Position = Field(
        description="Target position x, y, z of the hand in the world frame [m]; with `hand: "
        "both`, target position of the midpoint between the hands."
    )
    width: float | None = Field(
        None,
        gt=0.0,
        le=2.0,
        description="Distance between both hands at the object [m], only with `hand: both`; null: "
        "their distance at rest.",
    )
    clearance: float | None = Field(
        None,
        gt=0.0,
        le=1.0,
        description="Height above the object at which the hand stops before it moves straight "
        "down [m]; null: 15 % of the leg length.",
    )
    payload: float = Field(
        0.0,
        ge=0.0,
        le=100.0,
        description="Mass of the object [kg], modelled as a point mass in the hand; with `hand: "
        "both`, each hand carries half of this mass.",
    )
    approach: Duration = Field(
        2.0, description="Duration of the motion to the point above the object [s]."
    )
    lower: Duration = Field(
        1.0, description="Duration of the motion straight down to the object [s]."
    )
    pause: float = Field(
        0.5,
        ge=0.0,
        le=60.0,
        description="Duration of the grasp, in which the weight of the payload passes to the hand "
        "[s].",
    )
    lift: Duration = Field(
        1.0, description="Duration of the motion straight up with the object [s]."
    )
    back: Duration = Field(2.0, description="Duration of the return to the position at rest [s].")
    rest: float = Field(
        0.5, ge=0.0, le=60.0, description="Duration of rest at the start and at the end [s]."
    )

    @property
    def times(self) -> tuple[float, ...]:
        """End times of rest, approach, lower, pause, lift and back [s]."""
        ends, t = [], 0.0
        for span in (self.rest, self.approach, self.lower, self.pause, self.lift, self.back):
            t += span
            ends.append(t)
        return tuple(ends)

    @property
    def duration(self) -> float:
        """Duration of the whole motion [s]."""
        return self.times[-1] + self.rest

    @model_validator(mode="after")
    def _takes_its_load_in_time(self) -> PickUpParameters:
        if self.payload and not self.pause:
            raise ValueError(
                f"payload = {self.payload:g} kg needs a pause above 0 s, in which the hand takes it"
            )
        if self.width is not None and self.hand != "both":
            raise ValueError(
                "width is the distance between both hands; leave it out or use hand: both"
            )
        return self
