"""Sizes of motions on fixed feet, kicks and grasps that are given relative to the robot.

Lengths are multiples of the leg length, those of hands of the arm length; joints are named by their
roles. What comes out is a gait of the one robot, in metres and with its names of joints.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.config import build
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.gait import BalanceGait, KeyframesGait, KickGait, PickUpGait
from mgs.motion_planner.standing import standing_figures
from mgs.robot import Robot, leg_length
from mgs.robot.limbs import arm_joints, stretched_length
from mgs.robot.role_names import ARM_ROLES
from mgs.robot.roles import find_roles

BALL_RADIUS, BALL_MASS = 0.115, 0.63  # in leg lengths, and in kg per square metre of leg length
SMALL_LEG = 0.282  # [m] leg for which the durations of a kick are the defaults; sqrt of L otherwise
KICK_TIMES = ("shift",)
OF_ARMS = {f"{side.label}_{role}" for side in Side for role in ARM_ROLES}
RANGE_MARGIN = 0.05  # [rad] distance that angles of roles keep from the limits of their joints


def scaled_keyframes(gait: KeyframesGait, robot: Robot) -> KeyframesGait:
    """The keyframes in metres and angles of joints.

    Raises:
        ConfigError: the robot lacks a joint or a hand that a key names.
    """
    frames = gait.keyframes
    if frames.balance == "off":
        raise ConfigError("keyframes.sizes", "relative is for motions with balance: on")
    length, hands, roles = leg_length(robot), _Hands(robot), _Roles(robot)
    keys = []
    for i, key in enumerate(frames.keys):
        where, values = f"keyframes.keys.{i}", key.model_dump(exclude_unset=True)
        if key.com is not None:
            values["com"] = [length * x for x in key.com]
        for side in Side:
            name = f"{side.label}_hand"
            if (point := getattr(key, name)) is not None:
                values[name] = hands.from_rest(side, point, f"{where}.{name}")
        values["posture"] = roles.angles(key.posture, f"{where}.posture")
        keys.append(values)
    block = frames.model_dump(exclude_unset=True) | {"keys": keys, "sizes": "given"}
    return _with(gait, {"keyframes": block})


def scaled_balance(gait: BalanceGait, robot: Robot) -> BalanceGait:
    """The displacements in metres."""
    balance = gait.balance
    units = {"com": leg_length(robot), "torso": 1.0, "hand": _Hands(robot).length}
    channels = []
    for channel in balance.channels:
        unit = next(size for part, size in units.items() if part in channel.task)
        values = channel.model_dump(exclude_unset=True)
        sizes = {"value", "amplitude", "width", "height"} & values.keys()
        channels.append(values | {name: unit * values[name] for name in sizes})
    block = balance.model_dump(exclude_unset=True) | {"channels": channels, "sizes": "given"}
    if balance.com_height is not None:
        block["com_height"] = balance.com_height * float(standing_figures(robot).com[2])
    return _with(gait, {"balance": block})


def scaled_kick(gait: KickGait, robot: Robot) -> KickGait:
    """The kick in metres; ball and durations go with the leg length where the file has none."""
    kick, length = gait.kick, leg_length(robot)
    block = kick.model_dump(exclude_unset=True) | {"sizes": "given"}
    lengths = {"height", "back_swing", "follow_through", "step_width"} & block.keys()
    block |= {name: _times(block[name], length) for name in lengths}
    if kick.com_height is not None:
        block["com_height"] = kick.com_height * float(standing_figures(robot).com[2])
    defaults, slower = type(kick).model_fields, math.sqrt(length / SMALL_LEG)
    for name in KICK_TIMES:
        block.setdefault(name, round(float(defaults[name].default) * slower, 2))
    stated = kick.ball.model_dump(exclude_unset=True)
    ball = {name: _times(value, length) for name, value in stated.items() if name != "mass"}
    ball.setdefault("radius", BALL_RADIUS * length)
    ball["mass"] = stated.get("mass", BALL_MASS * length**2)
    return _with(gait, {"kick": block | {"ball": ball}})


def scaled_pick_up(gait: PickUpGait, robot: Robot) -> PickUpGait:
    """The grasp in metres and kilograms."""
    pick_up, length = gait.pick_up, leg_length(robot)
    block = pick_up.model_dump(exclude_unset=True) | {"sizes": "given"}
    block["object"] = [length * x for x in pick_up.object]
    for name in {"width", "clearance"} & block.keys():
        block[name] = _times(block[name], length)
    block["payload"] = pick_up.payload * robot.mass
    return _with(gait, {"pick_up": block})


def _times(value: float | None, unit: float) -> float | None:
    return None if value is None else value * unit


def _with(gait: Any, blocks: dict[str, Any]) -> Any:
    """The gait with other blocks; raises ConfigError if a value in metres is out of range."""
    values = gait.model_dump(exclude_unset=True)
    return build(type(gait), values | blocks, f"{gait.motion} gait, sized by the robot")


class _Hands:
    """Shoulders and hands of the half-sitting posture, in the world frame."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.rest = standing_figures(robot).hands
        model, data = robot.model, robot.model.createData()
        pin.forwardKinematics(model, data, robot.standing_q)
        self.shoulders = np.full((2, 3), np.nan)
        self.length = 0.0  # [m] of the stretched arm
        for side in Side:
            if not np.isnan(self.rest[side]).any():
                joints = arm_joints(robot, side)
                tip = model.frames[robot.hand_frames[side]].placement.translation
                # the axes of a shoulder cross near its second joint
                self.shoulders[side] = data.oMi[joints[1]].translation
                self.length = stretched_length(model, joints[1:], tip)

    def from_rest(self, side: Side, point: list[float], where: str) -> list[float]:
        """Displacement (3,) from rest [m] of a hand at a point from its shoulder [arm lengths]."""
        if np.isnan(self.rest[side]).any():
            raise ConfigError(
                where, f"{self.robot.spec.name} cannot move this hand relative to its torso"
            )
        goal: Array = self.shoulders[side] + self.length * np.array(point)
        return [float(x) for x in goal - self.rest[side]]


class _Roles:
    """Joints of a robot by role."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.roles = robot, find_roles(robot)

    def angles(self, posture: dict[str, float], where: str) -> dict[str, float]:
        """Joint angles by name of the joint [rad], inside the ranges of the joints.

        A joint of an arm that the robot does not have needs no angle.
        """
        robot, found = self.robot, {}
        for role, angle in posture.items():
            if role not in self.roles and role in OF_ARMS:
                continue
            if role not in self.roles:
                raise ConfigError(
                    f"{where}.{role}",
                    f"{robot.spec.name} has no joint of this role; it has {', '.join(self.roles)}",
                )
            j, sign = self.roles[role]
            low, high = robot.lower[j] + RANGE_MARGIN, robot.upper[j] - RANGE_MARGIN
            wanted = float(robot.posture[j]) + sign * angle
            found[robot.joint_names[j]] = min(max(wanted, low), high)
        return found
