"""The block `com` of a gait file: generator of the CoM motion and dynamic filter."""

from __future__ import annotations

from typing import Any

from pydantic import Field, ValidationInfo, field_validator

from mgs.core.config import Model, Whole
from mgs.core.plugins import COM_GENERATORS
from mgs.gait.names import GeneratorName, own_parameters


class ComParameters(Model):
    """Parameters of the motion of the centre of mass (CoM) and of the dynamic filter.

    A generator computes the CoM motion from the reference of the zero-moment point (ZMP), with the
    robot as a point mass. The dynamic filter then corrects the CoM motion until the ZMP of the
    whole robot is as planned.
    """

    generator: GeneratorName = Field(
        "qp",
        description="Name of the generator of the centre-of-mass (CoM) motion. qp: quadratic "
        "program, which minimizes CoM jerk and ZMP error and keeps the ZMP inside the support "
        "polygon, at least `margin` from its edge; preview: preview control, which follows the "
        "reference of the zero-moment point (ZMP); any other name: a generator of another "
        "package.",
    )
    preview: float = Field(
        1.6,
        ge=0.1,
        le=10.0,
        description="Length of the preview window: duration of the future reference that preview "
        "control takes into account [s].",
    )
    weight_error: float = Field(
        1.0,
        gt=0.0,
        le=1e12,
        description="Weight Q_e of the squared error of the zero-moment point (ZMP) [1/m^2]; only "
        "the ratio of weight_jerk to weight_error matters.",
    )
    weight_jerk: float = Field(
        1e-4,
        gt=0.0,
        le=1e6,
        description="Weight R of the squared jerk of the centre of mass [s^6/m^2]; its effect "
        "depends on the sampling period dt. For the generator preview 1e-8 (stiff) to 1e-6.",
    )
    margin: float | None = Field(
        None,
        ge=0.0,
        le=1.0,
        description="Smallest distance of the zero-moment point (ZMP) from the edge of the "
        "support polygon [m]; for the generator qp only. null: a quarter of the width or length "
        "of a sole, whichever is less.",
    )
    passes: Whole = Field(
        3,
        ge=0,
        le=50,
        description="Largest number of corrections by the dynamic filter; 0: no correction.",
    )
    zmp_tolerance: float = Field(
        2e-4,
        gt=0.0,
        le=1.0,
        description="Mean distance between the zero-moment point (ZMP) of the whole robot and its "
        "plan below which the dynamic filter stops [m].",
    )
    parameters: dict[str, Any] = Field(
        {},
        description="Parameters of a generator of another package; the documentation of that "
        "package lists them.",
    )

    @field_validator("parameters")
    @classmethod
    def _are_those_of_the_generator(
        cls, given: dict[str, Any], info: ValidationInfo
    ) -> dict[str, Any]:
        return own_parameters(COM_GENERATORS, "generator", given, info)
