"""Postures in which a robot stands before a motion is played back."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import ConfigError
from mgs.core.input_files import read_text
from mgs.core.yaml_text import parse_yaml
from mgs.robot.robot import Robot

HALF_SITTING, ZERO = "half-sitting", "zero"


def start_posture(robot: Robot, wanted: str) -> Array:
    """Joint angles (n,) [rad] of a posture.

    Args:
        robot: the robot.
        wanted: "half-sitting", the posture of robot.yaml; "zero", every joint at 0, or at its limit
            nearest to 0; or the path of a YAML file with angles by name of the joint [rad], in
            which joints that are not named are half-sitting.

    Raises:
        ConfigError: the file is missing or malformed, or names an unknown joint or a wrong angle.
    """
    if wanted == HALF_SITTING:
        return robot.posture.copy()
    if wanted == ZERO:
        return np.clip(np.zeros(robot.n), robot.lower, robot.upper)
    path = Path(wanted)
    found: Any = parse_yaml(read_text(path, kind="a posture"), path)
    if not isinstance(found, dict):
        raise ConfigError(path, "is not a list of angles by name of the joint, such as `knee: 0.5`")
    angles, problems = robot.posture.copy(), []
    for name, angle in found.items():
        if (problem := _problem(robot, name, angle)) is not None:
            problems.append(f"{name}: {problem}")
        else:
            angles[robot.joint_names.index(name)] = angle
    if problems:
        raise ConfigError(path, problems)
    return angles


def _problem(robot: Robot, name: object, angle: object) -> str | None:
    """Why a joint cannot have an angle; None where it can."""
    if name not in robot.joint_names:
        close = difflib.get_close_matches(str(name), robot.joint_names, n=1)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        return f"{robot.spec.name} has no such joint{hint}"
    if isinstance(angle, bool) or not isinstance(angle, int | float):
        return f"{angle!r} is not a number [rad]"
    j = robot.joint_names.index(str(name))
    if not robot.lower[j] <= angle <= robot.upper[j]:
        return (
            f"{angle:g} rad is outside the joint's range "
            f"[{robot.lower[j]:.4f}, {robot.upper[j]:.4f}] rad"
        )
    return None
