"""Schema of robot.yaml: frames, soles, hands, posture, servos and joints of a robot."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from mgs.core.config import FormatVersion, Model, build, parse_yaml

MAX_LENGTH, MAX_MASS, MAX_ANGLE = 10.0, 1e4, 100.0  # [m], [kg], [rad]; larger: probably wrong unit


Coordinate = Annotated[float, Field(ge=-MAX_LENGTH, le=MAX_LENGTH)]


Vector3 = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]


Angle = Annotated[float, Field(ge=-MAX_ANGLE, le=MAX_ANGLE)]


Rotation = Annotated[list[Angle], Field(min_length=3, max_length=3)]


Range = Annotated[list[Angle], Field(min_length=2, max_length=2)]


class FrameSpec(Model):
    """Frame that is fixed to a link."""

    link: str = Field(description="Name of the link in the URDF.")
    position: Vector3 = Field(
        [0.0, 0.0, 0.0],
        description="Position of the origin of this frame in the frame of the link: x, y, z [m].",
    )
    rpy: Rotation = Field(
        [0.0, 0.0, 0.0],
        description="Orientation of this frame in the frame of the link: roll, pitch, yaw about "
        "fixed axes [rad].",
    )


class SoleSpec(FrameSpec):
    """Contact rectangle of a foot, with a frame at its centre: x forward, z up."""

    length: float = Field(ge=1e-3, le=1.0, description="Length of the sole along x [m].")
    width: float = Field(ge=1e-3, le=1.0, description="Width of the sole along y [m].")


class ServoSpec(Model):
    """Parameters of one servo model; mgs.robot.servos defines the torque law."""

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
        if self.compliance_slope is None:
            return self.stiffness
        return self.stall_torque / (self.compliance_slope * self.resolution)


class PairOf(Model):
    """Frames of the left and the right hand."""

    left: FrameSpec = Field(description="Frame of the left hand.")
    right: FrameSpec = Field(description="Frame of the right hand.")


class SolePair(Model):
    """Soles of the left and the right foot."""

    left: SoleSpec = Field(description="Sole of the left foot.")
    right: SoleSpec = Field(description="Sole of the right foot.")


class RobotSpec(Model):
    """Description of a robot: the content of robot.yaml."""

    mgs: FormatVersion = Field(description="Version of the file format.")
    name: str = Field(min_length=1, max_length=100, description="Name of the robot.")
    urdf: str = Field("robot.urdf", description="URDF file, relative to the folder of robot.yaml.")
    base_link: str = Field(
        description="Name of the root link, whose pose in the world is free (floating base)."
    )
    torso: FrameSpec = Field(
        description="Frame of the torso, used by torso orientation tasks. Its x axis points ahead "
        "and its z axis up while the torso is upright."
    )
    soles: SolePair = Field(description="Soles of both feet.")
    hands: PairOf | None = Field(
        None,
        description="Frames of both hands, used by hand tasks; null: the robot has no arms, and "
        "hand tasks are not available.",
    )
    posture: dict[str, float] = Field(
        description="Half-sitting posture (standing with bent knees), from which motions start: "
        "angles by name of the joint [rad]; joints that are not named are at 0."
    )
    servos: dict[str, ServoSpec] = Field(
        description="Parameters of the servo models, by name of the model."
    )
    joints: dict[str, str] = Field(
        description="Name of the servo model of each joint, by name of the joint; every joint "
        "that is not locked needs one."
    )
    locked: dict[str, Angle] = Field(
        {},
        description="Fixed angles of locked joints, by name of the joint [rad]; locked joints are "
        "treated as rigid connections.",
    )
    limits: dict[str, Range] = Field(
        {},
        description="Joint limits that are narrower than those of the URDF, by name of the joint: "
        "lower, upper [rad].",
    )
    groups: dict[str, list[str]] = Field(
        {},
        description="Lists of joints by name of the group, such as left_leg, for plots and for "
        "the check of symmetry.",
    )
    ignore_collisions: list[Annotated[list[str], Field(min_length=2, max_length=2)]] = Field(
        [],
        description="Pairs of links that are excluded from collision checks; adjacent links are "
        "always excluded.",
    )


def parse_spec(yaml_text: str, source: str | Path) -> RobotSpec:
    """Content of the text of a robot.yaml; raises ConfigError with `source` where malformed."""
    return build(RobotSpec, parse_yaml(yaml_text, source), source)
