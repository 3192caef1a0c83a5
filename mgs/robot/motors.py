"""Motors on the bus of a robot: which id turns which joint, which way, and from which tick.

    tick = centre + (ticks_per_turn / 2 pi) (sign gear q + zero_offset)

q is the angle of the joint in the URDF [rad]. What belongs to one physical robot alone, such as the
zero of a horn that sits one tooth off, is not here but in the file of that robot (mgs.robot.unit).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from mgs.core.arrays import Array
from mgs.core.config import FormatVersion, Model, Whole, build
from mgs.core.errors import ConfigError, MgsError
from mgs.core.input_files import read_text
from mgs.core.short_repr import short_repr
from mgs.core.yaml_text import parse_yaml
from mgs.robot.motor_models import MODELS, MotorName, Register

MAX_TICK = 1 << 30  # of a turn; registers have 32 bits

Ticks = NDArray[np.int64]
Tick = Annotated[Whole, Field(ge=-MAX_TICK, le=MAX_TICK)]


class GoalRegister(Model):
    """Register of the goal position of a motor that is none of the known models."""

    maker: Literal["dynamixel", "feetech"] = Field(description="Maker, and so the bus.")
    protocol: Literal[1, 2] = Field(description="Version of the protocol [1 or 2]; 1 for Feetech.")
    address: Whole = Field(ge=0, le=65535, description="Address of the goal position [bytes].")
    width: Literal[2, 4] = Field(description="Width of the goal position [bytes].")


class MotorSpec(Model):
    """Motor of one joint: its id on the bus, direction, zero and scale."""

    id: Whole = Field(ge=0, le=253, description="Number of the motor on the bus [0 to 253].")
    model: MotorName | None = Field(
        None,
        description="Model of the motor, which gives its ticks and its register; null: "
        "ticks_per_turn does.",
    )
    sign: Literal[1, -1] = Field(
        1,
        description="Direction [1 or -1]: 1 if more ticks turn the joint in the positive direction "
        "of its axis in the URDF, -1 if in the negative one.",
    )
    zero_offset: float = Field(
        0.0,
        ge=-math.pi,
        le=math.pi,
        description="Angle of the motor, from its middle tick, while the joint is at 0 [rad].",
    )
    gear: float = Field(
        1.0, ge=0.01, le=1000.0, description="Turns of the motor per turn of the joint [-]."
    )
    ticks_per_turn: float | None = Field(
        None,
        ge=1.0,
        le=MAX_TICK,
        description="Ticks of a whole turn of the motor [ticks], such as 4096 (12 bit) or 16384 "
        "(14 bit); null: given by model.",
    )
    centre: Tick | None = Field(
        None,
        description="Tick in the middle [ticks]; null: given by model, or half of ticks_per_turn.",
    )
    ticks: Annotated[list[Tick], Field(min_length=2, max_length=2)] | None = Field(
        None,
        description="Lowest and highest tick [ticks]; null: given by model, or 0 to ticks_per_turn "
        "- 1.",
    )
    goal: GoalRegister | None = Field(
        None,
        description="Register of the goal position; null: given by model, or unknown, so that no "
        "packets can be written.",
    )

    @model_validator(mode="before")
    @classmethod
    def _has_one_scale(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        if values.get("model") is None and values.get("ticks_per_turn") is None:
            raise ValueError("give model or ticks_per_turn")
        if values.get("model") is not None:
            given = [key for key in ("ticks_per_turn", "goal") if values.get(key) is not None]
            if given:
                raise ValueError(f"model gives {given[0]}: leave {given[0]} out, or model")
        return values

    @model_validator(mode="after")
    def _has_a_range(self) -> MotorSpec:
        low, high = self.range
        if not low <= self.middle <= high:
            raise ValueError(f"centre {self.middle} is outside the ticks {low} to {high}")
        return self

    @property
    def scale(self) -> float:
        """Ticks of the motor in a whole turn."""
        if self.model is not None:
            return MODELS[self.model].ticks_per_turn
        assert self.ticks_per_turn is not None
        return self.ticks_per_turn

    @property
    def middle(self) -> int:
        """Tick at which the angle of the motor is 0."""
        if self.centre is not None:
            return self.centre
        return MODELS[self.model].centre if self.model else int(self.scale // 2)

    @property
    def range(self) -> tuple[int, int]:
        """Lowest and highest tick that the motor takes."""
        if self.ticks is not None:
            return self.ticks[0], self.ticks[1]
        if self.model is not None:
            return MODELS[self.model].lowest, MODELS[self.model].highest
        return 0, int(self.scale) - 1

    @property
    def register(self) -> Register | None:
        """Where goal positions go; None: unknown."""
        if self.model is not None:
            return MODELS[self.model].register
        if self.goal is None:
            return None
        return Register(self.goal.maker, self.goal.protocol, self.goal.address, self.goal.width)


class MotorFile(Model):
    """Motors of a robot in a file of their own, for a robot.yaml that does not name them."""

    mgs: FormatVersion = Field(description="Version of the file format.")
    motors: dict[str, MotorSpec] = Field(description="Motor of each joint, by its name.")


@dataclass(frozen=True, eq=False)
class Motors:
    """Motors of all joints of a robot, in the order of its joints; arrays are (n,)."""

    joint_names: tuple[str, ...]
    ids: tuple[int, ...]
    ticks_per_rad: Array  # ticks per angle of the joint, negative where more ticks turn it back
    at_zero: Array  # tick, not rounded, while the joint is at 0
    lowest: Ticks
    highest: Ticks
    registers: tuple[Register | None, ...]

    __repr__ = short_repr

    @property
    def resolution(self) -> Array:
        """Angle (n,) of the joint that one tick is [rad]."""
        return np.asarray(1.0 / np.abs(self.ticks_per_rad))

    def to_ticks(self, position: Array) -> Ticks:
        """Nearest ticks (..., n) to joint angles (..., n) [rad].

        Raises:
            MgsError: a motor would have to leave its range.
        """
        ticks = np.rint(self.at_zero + self.ticks_per_rad * position).astype(np.int64)
        beyond = np.maximum(self.lowest - ticks, ticks - self.highest)
        if beyond.size and beyond.max() > 0:
            *_, j = place = np.unravel_index(int(np.argmax(beyond)), beyond.shape)
            raise MgsError(
                f"motor {self.ids[j]} of joint {self.joint_names[j]} would have to go to tick "
                f"{ticks[place]} for {position[place]:.4f} rad, but has ticks {self.lowest[j]} to "
                f"{self.highest[j]}; check sign, zero_offset and centre under motors"
            )
        return ticks

    def to_angles(self, ticks: Ticks) -> Array:
        """Joint angles (..., n) [rad] at ticks (..., n)."""
        return np.asarray((ticks - self.at_zero) / self.ticks_per_rad)


def read_motors(path: Path) -> dict[str, MotorSpec]:
    """Motors in a file with the keys `mgs` and `motors`.

    Raises:
        ConfigError: the file is missing or malformed, or two motors have the same id.
    """
    specs = build(MotorFile, parse_yaml(read_text(path), path), path).motors
    if problems := repeated_ids(specs):
        raise ConfigError(path, problems)
    return specs


def motors_of(
    specs: Mapping[str, MotorSpec], joint_names: Iterable[str], source: str | Path
) -> Motors:
    """Motors of all joints, in their order.

    Args:
        specs: motor of each joint by its name, of robot.yaml or of a file of their own.
        joint_names: joints of the robot.
        source: where the motors are from, for messages.

    Raises:
        ConfigError: a joint has no motor, or a motor a joint that the robot does not have.
    """
    names = tuple(joint_names)
    problems = [f"motors: there is no joint {name!r}" for name in specs if name not in names]
    if missing := [name for name in names if name not in specs]:
        told = ", ".join(missing[:3]) + (f" and {len(missing) - 3} more" if missing[3:] else "")
        problems.append(
            f"motors: no motor given for {told}; add its id and model, such as "
            f"{{{missing[0]}: {{id: 1, model: XM430}}}}, there or in a file for --motors"
        )
    if problems:
        raise ConfigError(source, problems)
    chosen = [specs[name] for name in names]
    per_rad = np.array([spec.scale / (2.0 * math.pi) for spec in chosen])
    offset = np.array([spec.zero_offset for spec in chosen])
    return Motors(
        joint_names=names,
        ids=tuple(spec.id for spec in chosen),
        ticks_per_rad=per_rad * [spec.sign * spec.gear for spec in chosen],
        at_zero=np.array([spec.middle for spec in chosen]) + per_rad * offset,
        lowest=np.array([spec.range[0] for spec in chosen], dtype=np.int64),
        highest=np.array([spec.range[1] for spec in chosen], dtype=np.int64),
        registers=tuple(spec.register for spec in chosen),
    )


def repeated_ids(specs: Mapping[str, MotorSpec]) -> list[str]:
    """Problems of motors with the same id, which one bus cannot tell apart."""
    owners: dict[int, str] = {}
    problems = []
    for name, spec in specs.items():
        if spec.id in owners:
            problems.append(f"motors.{name}: id {spec.id} is that of {owners[spec.id]} too")
        owners.setdefault(spec.id, name)
    return problems
