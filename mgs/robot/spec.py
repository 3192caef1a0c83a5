"""The file robot.yaml: frames, soles, hands, posture, servos and joints of a robot."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from mgs.core.config import FormatVersion, Model

MAX_LENGTH, MAX_MASS, MAX_ANGLE = 10.0, 1e4, 100.0  # [m], [kg], [rad]; beyond: a slip of the unit


Coordinate = Annotated[float, Field(ge=-MAX_LENGTH, le=MAX_LENGTH)]


Vector3 = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]


Angle = Annotated[float, Field(ge=-MAX_ANGLE, le=MAX_ANGLE)]


Rotation = Annotated[list[Angle], Field(min_length=3, max_length=3)]


Range = Annotated[list[Angle], Field(min_length=2, max_length=2)]


class FrameSpec(Model):
    """A frame in a link."""

    link: str
    position: Vector3 = Field([0.0, 0.0, 0.0], description="Origin in the link frame [m].")
    rpy: Rotation = Field(
        [0.0, 0.0, 0.0],
        description="Roll, pitch and yaw of its axes in the link frame [rad]; 0: parallel.",
    )


class SoleSpec(FrameSpec):
    """Contact rectangle: frame at its centre, x forward, z up."""

    length: float = Field(ge=1e-3, le=1.0, description="Along x [m].")
    width: float = Field(ge=1e-3, le=1.0, description="Along y [m].")


class ServoSpec(Model):
    """Figures of one servo model; mgs.robot.servos has the law that they belong to."""

    stall_torque: float = Field(gt=0.0, le=1e4, description="[N m]")
    no_load_speed: float = Field(gt=0.0, le=100.0, description="[rad/s]")
    resolution: float = Field(0.0, ge=0.0, le=0.1, description="One tick of the encoder [rad].")
    armature: float = Field(
        0.0, ge=0.0, le=10.0, description="Rotor inertia seen at the joint [kg m^2]."
    )
    stiffness: float | None = Field(
        None, gt=0.0, le=1e6, description="Torque per error of the position loop [N m/rad]."
    )
    compliance_slope: Literal[2, 4, 8, 16, 32, 64, 128] | None = Field(
        None,
        description="In place of stiffness: ticks of error over which the torque grows to stall "
        "torque, a register of Dynamixel's AX and RX servos; 32 when shipped.",
    )
    damping: float | None = Field(
        None,
        ge=0.0,
        le=1e5,
        description="Of the motor, by its back-EMF, and of the loop [N m s/rad]; "
        "None: stall torque / no-load speed.",
    )
    latency: float = Field(0.0, ge=0.0, le=0.5, description="From command to torque [s].")
    deadband: float = Field(
        0.0, ge=0.0, le=0.2, description="Error up to which there is no torque [rad]."
    )
    punch: float = Field(
        0.0, ge=0.0, le=1e4, description="Torque with which it sets in beyond the deadband [N m]."
    )
    friction: float = Field(0.0, ge=0.0, le=1e4, description="Of the gear, Coulomb's [N m].")
    viscous_friction: float = Field(
        0.0, ge=0.0, le=1e5, description="Of the gear, per speed [N m s/rad]."
    )

    @model_validator(mode="after")
    def _has_one_stiffness(self) -> ServoSpec:
        if self.compliance_slope is not None:
            if self.stiffness is not None:
                raise ValueError("give stiffness or compliance_slope, not both")
            if not self.resolution:
                raise ValueError("compliance_slope counts ticks: give resolution too")
        return self

    @property
    def spring(self) -> float | None:
        """Stiffness of the position loop [N m/rad]; None where the file has none."""
        if self.compliance_slope is None:
            return self.stiffness
        return self.stall_torque / (self.compliance_slope * self.resolution)


class PairOf(Model):
    """One frame a side."""

    left: FrameSpec
    right: FrameSpec


class SolePair(Model):
    """One sole a side."""

    left: SoleSpec
    right: SoleSpec


class RobotSpec(Model):
    """A robot.yaml."""

    mgs: FormatVersion = Field(description="Version of this format.")
    name: str = Field(min_length=1, max_length=100)
    urdf: str = Field("robot.urdf", description="URDF file, relative to the folder of robot.yaml.")
    base_link: str = Field(description="Link that carries the floating base.")
    torso: FrameSpec
    soles: SolePair
    hands: PairOf | None = Field(
        None, description="Of a robot with arms; without, nothing is ever asked of hands."
    )
    posture: dict[str, float] = Field(
        description="Half-sitting posture [rad]; joints not named stand at 0."
    )
    servos: dict[str, ServoSpec] = Field(description="Servo models by name.")
    joints: dict[str, str] = Field(description="Servo model of every joint.")
    locked: dict[str, Angle] = Field(
        {}, description="Joints of the URDF held at an angle [rad]; they are none of the robot's."
    )
    limits: dict[str, Range] = Field(
        {}, description="Ranges [rad] narrower than the URDF's, by joint."
    )
    groups: dict[str, list[str]] = Field({}, description="Names for sets of joints.")
    ignore_collisions: list[Annotated[list[str], Field(min_length=2, max_length=2)]] = Field(
        [], description="Pairs of links that may touch, besides adjacent ones."
    )
