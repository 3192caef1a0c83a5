"""The block `pick_up` of a gait file: one hand or both go down to an object and come back."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from mgs.core.config import Model

Duration = Annotated[float, Field(gt=0.0, le=60.0)]
Coordinate = Annotated[float, Field(ge=-3.0, le=3.0)]
Position = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]


class PickUpParameters(Model):
    """Both feet stay down; the hand stops above the object, goes straight down, waits, comes back.

    World frame, origin on the ground midway between the soles; x forward, y left, z up.
    """

    hand: Literal["left", "right", "both"] = Field("right", description="Which hand, or both.")
    object: Position = Field(description="Where the hand goes, or the middle of both [m].")
    width: float | None = Field(
        None, gt=0.0, le=2.0, description="Between both hands [m]; null: as at rest."
    )
    clearance: float | None = Field(
        None,
        gt=0.0,
        le=1.0,
        description="How high above the object the hand stops first [m]; null: 15 per cent of the "
        "leg length.",
    )
    payload: float = Field(0.0, ge=0.0, le=100.0, description="Mass of the object [kg].")
    approach: Duration = Field(2.0, description="To above the object [s].")
    lower: Duration = Field(1.0, description="Down to it [s].")
    pause: float = Field(
        0.5, ge=0.0, le=60.0, description="To grasp, and to take over the payload's weight [s]."
    )
    lift: Duration = Field(1.0, description="Straight up [s].")
    back: Duration = Field(2.0, description="Back to where hand and body rest [s].")
    rest: float = Field(0.5, ge=0.0, le=60.0, description="At rest, at either end [s].")

    @property
    def times(self) -> tuple[float, ...]:
        """Ends of rest, approach, lower, pause, lift and back [s]."""
        ends, t = [], 0.0
        for span in (self.rest, self.approach, self.lower, self.pause, self.lift, self.back):
            t += span
            ends.append(t)
        return tuple(ends)

    @property
    def duration(self) -> float:
        """Of the whole motion [s]."""
        return self.times[-1] + self.rest

    @model_validator(mode="after")
    def _takes_its_load_in_time(self) -> PickUpParameters:
        if self.payload and not self.pause:
            raise ValueError(
                f"payload = {self.payload:g} kg cannot be taken over in no time; give a pause"
            )
        if self.width is not None and self.hand != "both":
            raise ValueError("width is the distance between both hands; leave it out or hand: both")
        return self
