"""Corrections of one physical robot, which differs a little from the robot it was built as.

A joint that is told to go to c, and that its load pushes back with torque tau, goes to

    q = sign scale c + zero_offset - tau / stiffness - (backlash / 2) side(tau)

tau [N m] is what the motor exerts on the joint, positive about its axis. side(tau) is 1 or -1: the
teeth lie on the side towards which the motor pushes. The command that makes the joint go to q is
this law solved for c. At small torques side(tau) = tau / (`SLACK` of the stall torque), which
bounds the rate of the command where the load changes sides.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field

from mgs.core.arrays import Array
from mgs.core.atomic_files import refuse_taken, replace_file
from mgs.core.config import FormatVersion, Model, build
from mgs.core.errors import ConfigError
from mgs.core.input_files import read_text
from mgs.core.short_repr import short_repr
from mgs.core.yaml_text import dump_yaml, parse_yaml
from mgs.robot.robot import Robot
from mgs.robot.servos import Servos

SLACK = 0.01  # part of the stall torque at which the teeth lie firmly on one side


class JointCorrection(Model):
    """Figures of one joint of one physical robot."""

    zero_offset: float = Field(
        0.0,
        ge=-1.0,
        le=1.0,
        description="Angle of the joint without load while the command is 0 [rad].",
    )
    sign: Literal[1, -1] = Field(
        1, description="Direction [1 or -1]: -1 if the joint turns against its command."
    )
    scale: float = Field(
        1.0, ge=0.5, le=2.0, description="Turn of the joint per turn of the command [rad/rad]."
    )
    backlash: float = Field(
        0.0, ge=0.0, le=0.5, description="Play of the gear between its two ends [rad]."
    )
    stiffness: float | None = Field(
        None,
        gt=0.0,
        le=1e6,
        description="Torque per angle by which the joint gives way under load [N m/rad]; null: "
        "not known, and not compensated.",
    )


class UnitSpec(Model):
    """Corrections of one physical robot: the content of its file."""

    mgs: FormatVersion = Field(description="Version of the file format.")
    unit: str = Field(min_length=1, max_length=100, description="Name of the physical robot.")
    robot: str = Field(
        min_length=1, max_length=100, description="Name of the robot in its robot.yaml."
    )
    source: str = Field(
        "", max_length=1000, description="What the figures were measured from, in words."
    )
    joints: dict[str, JointCorrection] = Field(
        description="Figures of the joints, by the name of the joint; joints that are not named "
        "need no correction."
    )


@dataclass(frozen=True, eq=False)
class Unit:
    """Corrections (n,) of all joints of a robot, in their order."""

    name: str
    zero_offset: Array  # [rad]
    sign: Array  # 1 or -1
    scale: Array
    backlash: Array  # [rad]
    compliance: Array  # [rad/(N m)], 0 where the stiffness is not known
    torque_limit: Array  # stall torques of the robot [N m]

    __repr__ = short_repr

    def unloaded(self, command: Array) -> Array:
        """Angles (..., n) [rad] of the joints without load, told to go to (..., n) [rad]."""
        return np.asarray(self.sign * self.scale * command + self.zero_offset)

    def command_for(self, position: Array, torque: Array | None = None) -> Array:
        """Commands (..., n) [rad] that bring the joints to a position.

        Args:
            position: angles (..., n) wanted [rad].
            torque: what the motors exert there (..., n) [N m]; None: neither the load nor the play
                is compensated.
        """
        wanted = position if torque is None else position + self.yielding(torque)
        return np.asarray((wanted - self.zero_offset) / (self.sign * self.scale))

    def yielding(self, torque: Array) -> Array:
        """Angles (..., n) [rad] by which joints stay behind under load (..., n) [N m]."""
        return np.asarray(self.compliance * torque + self.play(torque))

    def play(self, torque: Array) -> Array:
        """The part of `yielding` that is the play of the gears."""
        side = np.clip(torque / (SLACK * self.torque_limit), -1.0, 1.0)
        return np.asarray(0.5 * self.backlash * side)


def load_unit(path: Path, robot: Robot) -> Unit:
    """Corrections in a file, for a robot.

    Raises:
        ConfigError: the file is missing or malformed, or is for another robot.
    """
    return unit_of(build(UnitSpec, parse_yaml(read_text(path), path), path), robot, path)


def unit_of(spec: UnitSpec, robot: Robot, source: str | Path = "unit") -> Unit:
    """Corrections of all joints of a robot; `source` is for messages.

    Raises:
        ConfigError: the corrections are for another robot, or for a joint that it does not have.
    """
    problems = [
        f"joints.{name}: {robot.spec.name} has no such joint"
        for name in spec.joints
        if name not in robot.joint_names
    ]
    if spec.robot != robot.spec.name:
        problems.insert(
            0, f"robot: corrections of {spec.robot!r}, but the motion is of {robot.spec.name!r}"
        )
    if problems:
        raise ConfigError(source, problems)
    rows = [spec.joints.get(name, JointCorrection()) for name in robot.joint_names]
    return Unit(
        name=spec.unit,
        zero_offset=np.array([row.zero_offset for row in rows]),
        sign=np.array([float(row.sign) for row in rows]),
        scale=np.array([row.scale for row in rows]),
        backlash=np.array([row.backlash for row in rows]),
        compliance=np.array([1.0 / row.stiffness if row.stiffness else 0.0 for row in rows]),
        torque_limit=robot.torque_limit,
    )


def servos_of_unit(servos: Servos, unit: Unit) -> Servos:
    """Servos with the stiffness of a physical robot where it is known."""
    known = unit.compliance > 0.0
    stiffness = np.where(known, 1.0 / np.where(known, unit.compliance, 1.0), servos.stiffness)
    return dataclasses.replace(servos, stiffness=stiffness)


def write_unit(spec: UnitSpec, path: Path, *, force: bool = False) -> None:
    """Write the file of a physical robot; `load_unit` reads the same figures.

    Raises:
        OutputExistsError: there is a file and `force` is not set.
        MgsError: it cannot be written.
    """
    refuse_taken(path, force)
    tree = spec.model_dump(exclude_defaults=True)
    replace_file(path, dump_yaml(tree).encode())
