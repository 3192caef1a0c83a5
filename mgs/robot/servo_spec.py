"""The part of robot.yaml about one servo model."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field, model_validator

from mgs.core.config import Model
from mgs.robot.identified import FRICTION, MOTORS, FrictionParameters


def _either_figures_or_model(schema: dict[str, Any]) -> None:
    """Say in the JSON schema of a servo that a named model gives stall torque and speed."""
    needed = ["stall_torque", "no_load_speed"]
    schema["required"] = [name for name in schema.get("required", []) if name not in needed]
    schema["anyOf"] = [{"required": needed}, {"required": ["model"]}]


# Keys of a servo that a named model gives.
GIVEN_BY_MODEL = (
    "stall_torque",
    "no_load_speed",
    "armature",
    "stiffness",
    "compliance_slope",
    "damping",
    "deadband",
    "punch",
    "friction",
    "viscous_friction",
    "friction_model",
)
IdentifiedName = Literal["bam/mx64", "bam/mx106", "bam/xl320", "bam/xl330"]


class ServoSpec(Model):
    """Parameters of one servo model; mgs.robot.servos defines the torque law."""

    model_config = ConfigDict(json_schema_extra=_either_figures_or_model)

    model: IdentifiedName | None = Field(
        None,
        description="Identified servo of the project BAM, whose motor and friction have been "
        "measured. It gives stall_torque, no_load_speed, armature, stiffness, damping and "
        "friction_model. null: the other keys describe the servo.",
    )
    firmware_gain: float | None = Field(
        None,
        gt=0.0,
        le=1e5,
        description="Proportional gain in the firmware of an identified servo [register value]; "
        "null: the gain at which it was identified (32, of XL330 400).",
    )
    supply: float | None = Field(
        None,
        gt=0.0,
        le=100.0,
        description="Supply voltage of an identified servo [V]; null: the voltage at which it was "
        "identified (15, of XL320 and XL330 7.5).",
    )
    stall_torque: float = Field(
        gt=0.0, le=1e4, description="Stall torque: torque limit at speed 0 [N m]."
    )
    no_load_speed: float = Field(
        gt=0.0, le=100.0, description="No-load speed: speed limit at torque 0 [rad/s]."
    )
    resolution: float = Field(
        0.0,
        ge=0.0,
        le=0.1,
        description="Angle of one tick of the position encoder [rad]; 0: continuous position.",
    )
    armature: float = Field(
        0.0, ge=0.0, le=10.0, description="Inertia of the rotor, reflected to the joint [kg m^2]."
    )
    stiffness: float | None = Field(
        None,
        gt=0.0,
        le=1e6,
        description="Proportional gain of the position loop: torque per position error [N m/rad]; "
        "null: given by compliance_slope, or unknown.",
    )
    compliance_slope: Literal[2, 4, 8, 16, 32, 64, 128] | None = Field(
        None,
        description="Alternative to stiffness: position error at which the torque reaches the "
        "stall torque [encoder ticks]; null: given by stiffness, or unknown. This is a register of "
        "Dynamixel AX and RX servos, with a factory setting of 32.",
    )
    damping: float | None = Field(
        None,
        ge=0.0,
        le=1e5,
        description="Damping by the back-EMF (induced voltage) of the motor and by the position "
        "loop [N m s/rad]; null: stall torque / no-load speed.",
    )
    latency: float = Field(0.0, ge=0.0, le=0.5, description="Delay between command and torque [s].")
    deadband: float = Field(
        0.0, ge=0.0, le=0.2, description="Position error below which the torque is zero [rad]."
    )
    punch: float = Field(
        0.0, ge=0.0, le=1e4, description="Smallest torque outside the deadband [N m]."
    )
    friction: float = Field(
        0.0, ge=0.0, le=1e4, description="Coulomb friction torque of the gear [N m]."
    )
    viscous_friction: float = Field(
        0.0, ge=0.0, le=1e5, description="Viscous friction coefficient of the gear [N m s/rad]."
    )

    friction_model: IdentifiedName | None = Field(
        None,
        description="Identified servo whose friction law this one has, scaled to its stall torque "
        "and its no-load speed; null: friction and viscous_friction.",
    )

    @model_validator(mode="before")
    @classmethod
    def _take_figures_of_model(cls, values: Any) -> Any:
        """Add what a named model gives; a wrong type is refused later, with a better message."""
        if not isinstance(values, dict) or not isinstance(values.get("model"), str):
            return values
        given = [name for name in GIVEN_BY_MODEL if values.get(name) is not None]
        if given:
            raise ValueError(f"model gives {given[0]}: leave {given[0]} out, or model")
        motor, supply = MOTORS.get(values["model"]), values.get("supply")
        if motor is None or not isinstance(supply, int | float | None):
            return values | {"stall_torque": 1.0, "no_load_speed": 1.0}
        volts = motor.supply if supply is None else float(supply)
        return values | {
            "stall_torque": motor.stall_torque(volts),
            "no_load_speed": motor.no_load_speed(volts),
            "armature": motor.armature,
        }

    @model_validator(mode="after")
    def _names_one_law(self) -> ServoSpec:
        if self.model is None and (self.firmware_gain or self.supply):
            raise ValueError("firmware_gain and supply are those of an identified servo: add model")
        if self.friction_model is not None and (self.friction or self.viscous_friction):
            raise ValueError("give friction_model or friction and viscous_friction, not both")
        return self

    @model_validator(mode="after")
    def _has_one_stiffness(self) -> ServoSpec:
        if self.compliance_slope is not None:
            if self.stiffness is not None:
                raise ValueError("give stiffness or compliance_slope, not both")
            if not self.resolution:
                raise ValueError("compliance_slope is in encoder ticks: give resolution too")
        return self

    @property
    def spring(self) -> float | None:
        """Stiffness of the position loop [N m/rad]; None if the file gives no stiffness."""
        if self.model is not None:
            motor = MOTORS[self.model]
            return motor.stiffness(self.firmware_gain or motor.gain, self.supply or motor.supply)
        if self.compliance_slope is None:
            return self.stiffness
        return self.stall_torque / (self.compliance_slope * self.resolution)

    @property
    def source(self) -> str:
        """Where the figures of this servo come from."""
        if self.model is not None:
            return f"identified servo {self.model}"
        if self.friction_model is not None:
            return f"figures of robot.yaml, friction like that of {self.friction_model}"
        return "figures of robot.yaml"

    @property
    def friction_parameters(self) -> FrictionParameters | None:
        """Parameters of a friction law that depends on the load; None: it does not."""
        if self.model is not None:
            return FRICTION[self.model]
        if self.friction_model is None:
            return None
        motor = MOTORS[self.friction_model]
        return FRICTION[self.friction_model].scaled(
            self.stall_torque / motor.stall_torque(motor.supply),
            self.no_load_speed / motor.no_load_speed(motor.supply),
        )
