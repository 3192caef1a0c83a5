"""The blocks `walk` and `com` of a gait file."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, field_validator, model_validator

from mgs.core.config import Model
from mgs.core.constants import COM_TOLERANCE
from mgs.core.plugins import COM_GENERATORS
from mgs.gait.names import GeneratorName, own_parameters

MAX_STEPS = 20_000
Duration = Annotated[float, Field(gt=0.0, le=60.0)]
Length = Annotated[float, Field(ge=-1.0, le=1.0)]
Turn = Annotated[float, Field(ge=-1.0, le=1.0)]
Coordinate = Annotated[float, Field(ge=-1e3, le=1e3)]
Heading = Annotated[float, Field(ge=-100.0, le=100.0)]


class StepParameters(Model):
    """One step of `walk.steps`; what is left out is as in the block `walk`."""

    step_length: Length | None = Field(None, description="Advance past the support sole [m].")
    lateral: Length | None = Field(None, description="Advance to the left [m].")
    step_yaw: Turn | None = Field(None, description="Turn to the left [rad].")


class FootstepParameters(Model):
    """One footstep of `walk.footsteps`: where a sole's centre shall be; world frame.

    The origin lies on the ground midway between the soles at the start, x ahead. Its height is that
    of the box below it.
    """

    side: Literal["left", "right"] = Field(description="Foot that steps there.")
    x: Coordinate = Field(description="[m]")
    y: Coordinate = Field(description="[m]")
    yaw: Heading = Field(0.0, description="[rad]")


class GoalParameters(Model):
    """Where the robot shall stand in the end: the middle between its soles; world frame."""

    x: Coordinate = Field(0.0, description="[m]")
    y: Coordinate = Field(0.0, description="[m]")
    yaw: float = Field(0.0, ge=-3.1416, le=3.1416, description="[rad]")


class BoxParameters(Model):
    """A box on the ground: a stair to step on, or an obstacle to step over."""

    x: Coordinate = Field(description="Centre [m].")
    y: Coordinate = Field(0.0, description="Centre [m].")
    yaw: Heading = Field(0.0, description="[rad]")
    length: float = Field(gt=0.0, le=100.0, description="Along its x [m].")
    width: float = Field(gt=0.0, le=100.0, description="Along its y [m].")
    height: float = Field(gt=0.0, le=1.0, description="Of its top above the ground [m].")


class WalkParameters(Model):
    """Steps of one walk and their timing; SI units; x forward, y left, z up.

    One of n_steps, steps, footsteps and goal says where the feet go.
    """

    n_steps: int | None = Field(
        None, ge=1, le=MAX_STEPS, description="Equal steps taken, the closing one included."
    )
    steps: Annotated[list[StepParameters], Field(min_length=1, max_length=MAX_STEPS)] | None = (
        Field(None, description="Steps one by one; a closing step follows them.")
    )
    footsteps: (
        Annotated[list[FootstepParameters], Field(min_length=1, max_length=MAX_STEPS)] | None
    ) = Field(None, description="Footsteps one by one, as places in the world.")
    goal: GoalParameters | None = Field(
        None,
        description="Where to go; step_length, lateral and step_yaw are then the largest steps, "
        "0: from the length of the legs.",
    )
    sizes: Literal["given", "robot"] = Field(
        "given",
        description="robot: lengths and times left out here, and those of com, are derived from "
        "the robot's leg length and soles.",
    )
    step_length: Length = Field(
        0.0, description="Advance of the swing sole past the support sole [m]; negative: backward."
    )
    lateral: Length = Field(
        0.0, description="Sideways advance of each step of the leading foot [m]; positive: left."
    )
    step_yaw: float = Field(
        0.0, ge=-1.0, le=1.0, description="Turn of each step [rad]; positive: to the left."
    )
    step_width: float | None = Field(
        None, gt=0.0, le=2.0, description="Distance of the soles [m]; null: as in the posture."
    )
    first_support: Literal["left", "right"] | None = Field(
        None, description="Foot that stands first; null: the one that lets the leading foot begin."
    )
    last_support: Literal["left", "right"] | None = Field(
        None, description="Foot that stands in the last step; null: either. One step more if need."
    )
    lead_in: Duration = Field(
        1.8, description="Rest before the first weight shift [s]; at least the preview window."
    )
    double_support: Duration = Field(
        0.2, description="Each phase with both soles down, first and last weight shift too [s]."
    )
    single_support: Duration = Field(0.5, description="Each phase on one sole [s].")
    lead_out: Duration = Field(1.8, description="Rest after the last weight shift [s].")
    step_height: float = Field(
        0.02, gt=0.0, le=0.5, description="Highest point of the swing sole above the ground [m]."
    )
    landing: float = Field(
        0.0,
        ge=0.0,
        le=0.5,
        description="Last part of each single support in which the swing sole is over its footstep "
        "and comes straight down, slowly: for a ground that is not where it should be.",
    )
    com_height: float | None = Field(
        None, ge=1e-3, le=3.0, description="Height of the CoM above the ground [m]; null: posture."
    )
    com_tolerance: float = Field(
        COM_TOLERANCE,
        gt=0.0,
        le=1.0,
        description="How far the CoM may stay behind its reference [m]; more than the default "
        "where com_height asks for more than the legs can reach, which ik1 to ik5 are made for.",
    )
    zmp_offset: Annotated[list[Length], Field(min_length=2, max_length=2)] = Field(
        [0.0, 0.0],
        description="Place of the ZMP in a support sole: forward and inward of its centre [m].",
    )
    zmp_travel: float = Field(
        0.0,
        ge=0.0,
        le=1.0,
        description="Way of the ZMP from heel to toe in each single support [m].",
    )
    arm_swing: float = Field(
        0.0,
        ge=0.0,
        le=2.0,
        description="Way of each hand as a part of that of the opposite foot, both seen from the "
        "middle of the soles.",
    )
    boxes: Annotated[list[BoxParameters], Field(max_length=1000)] = Field(
        [], description="Stairs and obstacles; footsteps stand on top of them."
    )
    clearance: float = Field(
        0.005, ge=0.0, le=0.2, description="Least height of the swing sole above an edge [m]."
    )

    @property
    def most_steps(self) -> int:
        """Number of steps, or about as many where a goal leaves it to the planner."""
        return self.n_steps or 1 + max(len(self.steps or ()), len(self.footsteps or ()))

    @model_validator(mode="after")
    def _says_once_where_to_go(self) -> WalkParameters:
        keys = ("n_steps", "steps", "footsteps", "goal")
        given = [key for key in keys if getattr(self, key) is not None]
        if len(given) != 1:
            found = " and ".join(given) or "none of them"
            raise ValueError(f"give one of {', '.join(keys)}; found {found}")
        return self

    @model_validator(mode="after")
    def _moves_only_as_a_foot_can(self) -> WalkParameters:
        if self.n_steps == 1 and (self.step_length or self.lateral or self.step_yaw):
            raise ValueError(
                "n_steps = 1 is the closing step alone and goes nowhere; use n_steps >= 2"
            )
        return self


class ComParameters(Model):
    """The CoM motion that the ZMP asks for (stage 3), and its correction for the whole robot."""

    generator: GeneratorName = Field(
        "preview",
        description="CoM generator. preview: control that follows the ZMP reference; qp: the least "
        "jerk whose ZMP keeps com.margin from the edge of the support polygon; or the name of a "
        "generator from another package.",
    )
    preview: float = Field(1.6, ge=0.1, le=10.0, description="Preview window [s].")
    weight_error: float = Field(
        1.0, gt=0.0, le=1e12, description="Q_e, weight of the ZMP error [1/m^2]."
    )
    weight_jerk: float = Field(
        1e-6, gt=0.0, le=1e6, description="R, weight of the jerk; not invariant to dt [s^6/m^2]."
    )
    margin: float = Field(
        0.0,
        ge=0.0,
        le=1.0,
        description="qp: distance of the ZMP from the edge of the support polygon, at least [m].",
    )
    passes: int = Field(
        3,
        ge=0,
        le=50,
        description="Most corrections of the CoM by the whole robot's ZMP error; 0: none.",
    )
    zmp_tolerance: float = Field(
        2e-4, gt=0.0, le=1.0, description="Mean ZMP error that needs no further correction [m]."
    )
    parameters: dict[str, Any] = Field(
        {}, description="Parameters of a generator from another package, whose guide lists them."
    )

    @field_validator("parameters")
    @classmethod
    def _are_those_of_the_generator(
        cls, given: dict[str, Any], info: ValidationInfo
    ) -> dict[str, Any]:
        return own_parameters(COM_GENERATORS, "generator", given, info)
