"""The block `kick` of a gait file."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from mgs.core.config import Model
from mgs.gait.walk import Duration, Length

Way = Annotated[float, Field(gt=0.0, le=1.0)]


class BallParameters(Model):
    """A ball on the ground; x ahead, y left of the middle between the soles at the start."""

    x: Annotated[float, Field(ge=-2.0, le=2.0)] | None = Field(
        None, description="Centre [m]; null: where the foot strikes at its best."
    )
    y: Annotated[float, Field(ge=-2.0, le=2.0)] | None = Field(
        None, description="Centre [m]; null: ahead of the kicking foot."
    )
    radius: float = Field(0.0325, gt=0.0, le=0.5, description="[m]")
    mass: float = Field(0.05, gt=0.0, le=10.0, description="[kg]")


class KickParameters(Model):
    """One kick: stand on the other foot, swing back, strike through the ball, come back, stand."""

    foot: Literal["left", "right"] = Field("right", description="Foot that kicks.")
    ball: BallParameters = Field(default_factory=BallParameters, description="Ball that is struck.")
    direction: float = Field(
        0.0, ge=-1.0, le=1.0, description="Where the ball shall go; positive: to the left [rad]."
    )
    speed: Annotated[float, Field(gt=0.0, le=10.0)] | None = Field(
        None, description="Of the sole at contact [m/s]; null: from the length of the legs."
    )
    height: Way | None = Field(
        None,
        description="Of the sole above the ground [m]; null: the ball's middle.",
    )
    back_swing: Way | None = Field(
        None, description="Way back from where the foot stands [m]; null: from the legs' length."
    )
    follow_through: Way | None = Field(
        None, description="Way on beyond the contact [m]; null: from the legs' length."
    )
    step_width: float | None = Field(
        None, gt=0.0, le=2.0, description="Distance of the soles [m]; null: as in the posture."
    )
    com_height: float | None = Field(
        None, ge=1e-3, le=3.0, description="Height of the CoM above the ground [m]; null: posture."
    )
    zmp_offset: Annotated[list[Length], Field(min_length=2, max_length=2)] = Field(
        [0.0, 0.0],
        description="Place of the ZMP in the support sole: forward and inward of its centre [m].",
    )
    lead_in: Duration = Field(
        1.8, description="Rest before the weight shift [s]; at least the preview window."
    )
    shift: Duration = Field(0.8, description="Weight shift onto the support foot, and back [s].")
    lift: Duration = Field(0.3, description="Raising the foot, and lowering it [s].")
    draw: Duration = Field(0.4, description="Swinging it back [s].")
    recover: Duration = Field(0.5, description="From the end of the swing back to its place [s].")
    lead_out: Duration = Field(1.8, description="Rest after the last weight shift [s].")
