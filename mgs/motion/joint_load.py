"""How much of their ranges, speeds and torques the joints use along a motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.motion.motion import Motion
from mgs.robot import Robot, leg_mask

LEAST_TORQUE = 1e-9  # part of the stall torque that is left at and beyond the no-load speed


def step_speeds(motion: Motion) -> Array:
    """Speeds (N - 1, n) from sample to sample, which is what a servo is asked for [rad/s]."""
    return np.abs(np.diff(motion.q[:, FLOATING_BASE_NQ:], axis=0)) / motion.dt


def available_torque(robot: Robot, torque: Array, speed: Array) -> Array:
    """Largest torques (N, n) at a speed (N, n): the speed-torque line, or stall torque in braking.

    `torque` (N, n) tells by its sign whether a servo brakes.
    """
    line = 1.0 - np.abs(speed) / robot.no_load_speed
    part = np.where(torque * speed > 0.0, np.maximum(line, LEAST_TORQUE), 1.0)
    return np.asarray(part * robot.torque_limit)


@dataclass(frozen=True)
class Use:
    """The largest part of one kind of limit that any joint uses."""

    part: float  # 1: all of it
    of: str  # speed, torque, lasting torque or range
    joint: str


def uses_of_legs(motion: Motion) -> tuple[Use, ...]:
    """The largest use of each kind of limit by the joints of the legs along a motion.

    Of its range a joint uses what it is away from the middle. What it uses in the half-sitting
    posture does not count, since no motion from there can use less.
    """
    robot, q = motion.robot, motion.q[:, FLOATING_BASE_NQ:]
    torque, speed = motion.torque, motion.v[:, FLOATING_BASE_NV:]
    middle, half = 0.5 * (robot.lower + robot.upper), 0.5 * (robot.upper - robot.lower)
    away = np.abs(q - middle).max(axis=0) / half
    at_rest = np.abs(robot.posture - middle) / half
    uses = {
        "speed": step_speeds(motion).max(axis=0) / robot.speed_limit,
        "torque": (np.abs(torque) / available_torque(robot, torque, speed)).max(axis=0),
        "lasting torque": np.sqrt(np.mean(torque**2, axis=0)) / robot.lasting_torque,
        "range": np.where(away > at_rest + 1e-6, away, 0.0),
    }
    found = []
    for of, part in uses.items():
        joint = int(np.argmax(np.where(leg_mask(robot), part, 0.0)))
        found.append(Use(float(part[joint]), of, robot.joint_names[joint]))
    return tuple(found)
