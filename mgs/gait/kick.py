"""The block `kick` of a gait file: ball, strike and timing of a kick."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from mgs.core.config import Model
from mgs.gait.walk import Duration, Length

Distance = Annotated[float, Field(gt=0.0, le=1.0)]


class BallParameters(Model):
    """A ball on the ground.

    The origin of the world frame lies on the ground midway between the soles at the start; x points
    forward, y to the left.
    """

    x: Annotated[float, Field(ge=-2.0, le=2.0)] | None = Field(
        None,
        description="Position of the centre of the ball along x [m]; null: the distance at which "
        "the foot strikes best, derived from leg length and sole length.",
    )
    y: Annotated[float, Field(ge=-2.0, le=2.0)] | None = Field(
        None,
        description="Position of the centre of the ball along y [m]; null: in front of the "
        "kicking foot, in the direction of the kick.",
    )
    radius: float = Field(0.0325, gt=0.0, le=0.5, description="Radius of the ball [m].")
    mass: float = Field(0.05, gt=0.0, le=10.0, description="Mass of the ball [kg].")


class KickParameters(Model):
    """Parameters of a kick: weight shift, back-swing, strike through the ball, and return."""

    sizes: Literal["given", "relative"] = Field(
        "given",
        description="Unit of the sizes. given: lengths in m. relative, for any robot: lengths in "
        "multiples of the leg length; radius and mass of the ball and durations that "
        "the file leaves out are derived from the leg length; com_height in multiples "
        "of its value at rest.",
    )
    foot: Literal["left", "right"] = Field("right", description="Foot that kicks the ball.")
    ball: BallParameters = Field(default_factory=BallParameters, description="Ball that is kicked.")
    direction: float = Field(
        0.0,
        ge=-1.0,
        le=1.0,
        description="Direction of the kick [rad]; 0: forward; positive: to the left.",
    )
    speed: Annotated[float, Field(gt=0.0, le=10.0)] | None = Field(
        None,
        description="Speed of the sole at contact with the ball [m/s]; null: derived from the leg "
        "length.",
    )
    height: Distance | None = Field(
        None,
        description="Height of the sole above the ground during the strike [m]; null: derived from "
        "the radius of the ball.",
    )
    back_swing: Distance | None = Field(
        None,
        description="Distance by which the foot is drawn back from its position at rest [m]; null: "
        "derived from the leg length.",
    )
    follow_through: Distance | None = Field(
        None,
        description="Distance that the foot travels beyond the contact with the ball [m]; null: "
        "derived from the leg length.",
    )
    step_width: float | None = Field(
        None,
        gt=0.0,
        le=2.0,
        description="Lateral distance between the centres of both soles [m]; null: their distance "
        "in the half-sitting posture of the robot.",
    )
    com_height: float | None = Field(
        None,
        ge=1e-3,
        le=3.0,
        description="Height of the centre of mass above the ground [m]; null: height in the "
        "half-sitting posture of the robot.",
    )
    zmp_offset: Annotated[list[Length], Field(min_length=2, max_length=2)] = Field(
        [0.0, 0.0],
        description="Reference position of the zero-moment point (ZMP) on the support sole: "
        "distance forward and distance towards the other foot, both from the centre of the sole "
        "[m].",
    )
    lead_in: Duration = Field(
        1.8,
        description="Duration of rest before the weight shift [s].",
    )
    shift: Duration = Field(
        0.8,
        description="Duration of each of the two weight shifts: onto the support foot, and back "
        "onto both feet [s].",
    )
    lift: Duration = Field(
        0.3,
        description="Duration of each of two motions: raising the foot, and lowering the foot at "
        "the end [s].",
    )
    draw: Duration = Field(0.4, description="Duration of drawing the foot back [s].")
    recover: Duration = Field(
        0.5,
        description="Duration of the return from the end of the swing to the position at rest [s].",
    )
    lead_out: Duration = Field(
        1.8,
        description="Duration of rest after the last weight shift [s]; at least com.preview with "
        "com.generator: preview.",
    )
