"""The blocks `walk` and `com` of a gait file."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from mgs.config import Model

Duration = Annotated[float, Field(gt=0.0, le=60.0)]
Length = Annotated[float, Field(ge=-1.0, le=1.0)]


class WalkParameters(Model):
    """Steps of one walk and their timing; SI units; x forward, y left, z up."""

    n_steps: int = Field(ge=1, le=20_000, description="Steps taken, the closing one included.")
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
    zmp_offset: Annotated[list[Length], Field(min_length=2, max_length=2)] = Field(
        [0.0, 0.0],
        description="Place of the ZMP in a support sole: forward and inward of its centre [m].",
    )

    @model_validator(mode="after")
    def _moves_only_as_a_foot_can(self) -> WalkParameters:
        if self.n_steps == 1 and (self.step_length or self.lateral or self.step_yaw):
            raise ValueError(
                "n_steps = 1 is the closing step alone and goes nowhere; use n_steps >= 2"
            )
        return self


class ComParameters(Model):
    """The CoM motion that the ZMP asks for (stage 3), and its correction for the whole robot."""

    generator: Literal["preview", "qp"] = Field(
        "preview",
        description="preview: control that follows the ZMP reference; qp: the least jerk whose ZMP "
        "keeps com.margin from the edge of the support polygon.",
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
