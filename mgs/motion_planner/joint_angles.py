"""The refusal of joint angles that keyframes ask for and the robot or its other tasks exclude."""

from __future__ import annotations

import difflib

import numpy as np
from numpy.typing import NDArray

from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.gait import KeyframesGait
from mgs.robot import Robot, arm_mask

Mask = NDArray[np.bool_]


def refuse_joints(robot: Robot, gait: KeyframesGait, allowed: Mask, led: Mask) -> None:
    """Raise ConfigError with all problems of the joint angles in `begin` and the keys' `posture`.

    Args:
        robot: the robot.
        gait: the keyframes.
        allowed: mask (n,) of the joints that `posture` may name.
        led: mask (2,) of the hands that a key leads, so that their arms follow them.
    """
    frames = gait.keyframes
    postures = {"begin": frames.begin}
    postures |= {f"keys.{i}.posture": key.posture for i, key in enumerate(frames.keys)}
    following = np.zeros(robot.n, np.bool_)
    for side in Side:
        if led[side]:
            following |= arm_mask(robot, side)
    problems = [
        f"{where}.{name}: {problem}"
        for where, posture in postures.items()
        for name, angle in posture.items()
        if (problem := _problem(robot, name, angle, allowed, following)) is not None
    ]
    if problems:
        raise ConfigError("keyframes", problems)


def _problem(robot: Robot, name: str, angle: float, allowed: Mask, following: Mask) -> str | None:
    """Why a joint cannot have an angle; None where it can."""
    if name not in robot.joint_names:
        close = difflib.get_close_matches(name, robot.joint_names, n=1)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        return f"{robot.spec.name} has no such joint{hint}"
    j = robot.joint_names.index(name)
    if not allowed[j]:
        return "a joint of the legs, which keep soles and balance; use com, crouch or torso instead"
    if following[j]:
        return "this arm follows its hand, which some key names; leave one of the two out"
    if not robot.lower[j] <= angle <= robot.upper[j]:
        return (
            f"{angle:g} rad is outside the joint's range "
            f"[{robot.lower[j]:.4f}, {robot.upper[j]:.4f}] rad"
        )
    return None
