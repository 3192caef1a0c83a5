"""Schema of robot.yaml: frames, soles, hands, posture, servos and joints of a robot."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, Field, field_validator

from mgs.core.config import FormatVersion, Model, build
from mgs.core.yaml_text import parse_yaml
from mgs.robot.motors import MotorSpec
from mgs.robot.role_names import checked_role
from mgs.robot.servo_spec import ServoSpec

MAX_LENGTH, MAX_MASS, MAX_ANGLE = 10.0, 1e4, 100.0  # [m], [kg], [rad]; larger: probably wrong unit


Coordinate = Annotated[float, Field(ge=-MAX_LENGTH, le=MAX_LENGTH)]


Vector3 = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]


Angle = Annotated[float, Field(ge=-MAX_ANGLE, le=MAX_ANGLE)]


Rotation = Annotated[list[Angle], Field(min_length=3, max_length=3)]


Range = Annotated[list[Angle], Field(min_length=2, max_length=2)]


RoleName = Annotated[str, AfterValidator(checked_role)]


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
    motors: dict[str, MotorSpec] = Field(
        {},
        description="Motor of each joint on the bus of the robot, by name of the joint: for files "
        "and programs that command motors. A robot without motors has none of these.",
    )
    groups: dict[str, list[str]] = Field(
        {},
        description="Lists of joints by name of the group, such as left_leg, for plots and for "
        "the check of symmetry.",
    )
    roles: dict[RoleName, str] = Field(
        {},
        description="Names of joints by role, such as left_knee, where the roles that mgs finds "
        "(`mgs robot show`) are not the right ones. Gaits for any robot name joints by role.",
    )
    ignore_collisions: list[Annotated[list[str], Field(min_length=2, max_length=2)]] = Field(
        [],
        description="Pairs of links that are excluded from collision checks; adjacent links are "
        "always excluded.",
    )
    guesses: list[str] = Field(
        [],
        description="Keys of this file whose values mgs robot init has guessed, such as soles or "
        "servos.NAME.stall_torque. Verdicts name them; remove a key once its value is confirmed.",
    )

    @field_validator("guesses")
    @classmethod
    def _are_keys(cls, keys: list[str]) -> list[str]:
        for key in keys:
            if key.partition(".")[0] not in cls.model_fields:
                raise ValueError(f"{key!r} is not a key of this file")
        return keys


def parse_spec(yaml_text: str, source: str | Path) -> RobotSpec:
    """Content of the text of a robot.yaml; raises ConfigError with `source` where malformed."""
    return build(RobotSpec, parse_yaml(yaml_text, source), source)
