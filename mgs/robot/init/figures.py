"""Torque and speed limits of joints, from the URDF or guessed if the URDF has no usable value."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from mgs.core.constants import GRAVITY
from mgs.robot.init.anatomy import Anatomy
from mgs.robot.init.mjcf import Drive
from mgs.robot.init.skeleton import Skeleton
from mgs.robot.init.source import Source

MOST_EFFORT, MOST_SPEED = 5e3, 60.0  # [N m], [rad/s]; larger values are placeholders
LEG_TORQUE, OTHER_TORQUE = 0.5, 0.1  # guessed torque as part of weight times leg length
JOINT_SPEED = 3.0  # guessed speed in units of sqrt(g / leg length)
NO_DRIVE = Drive(0.0, 0.0, 0.0)


@dataclass(frozen=True)
class ServoFigures:
    """Torque limit [N m] and speed limit [rad/s] of a joint, and the names of guessed values.

    Rotor inertia [kg m^2], viscous friction [N m s/rad] and Coulomb friction [N m] are 0 where the
    source does not tell them; a URDF never does.
    """

    effort: float
    velocity: float
    guessed: tuple[str, ...]
    armature: float = 0.0
    viscous_friction: float = 0.0
    friction: float = 0.0


def servo_figures(
    skeleton: Skeleton, anatomy: Anatomy, source: Source, mass: float, leg: float
) -> dict[int, ServoFigures]:
    """Limits of every joint of a robot with a given mass [kg] and leg length [m]."""
    joints = source.root.findall("joint")
    limits = {joint.get("name", ""): joint.find("limit") for joint in joints}
    strong = {*anatomy.legs[0], *anatomy.legs[1], *anatomy.waist}
    figures = {}
    for joint in range(2, skeleton.model.njoints):
        limit = limits[skeleton.name(joint)]
        assert limit is not None
        effort, velocity = (abs(float(limit.get(key, "0"))) for key in ("effort", "velocity"))
        guessed = []
        if not 0.0 < effort <= MOST_EFFORT:
            part = LEG_TORQUE if joint in strong else OTHER_TORQUE
            effort = _round(part * mass * GRAVITY * leg)
            guessed.append("stall_torque")
        if not 0.0 < velocity <= MOST_SPEED:
            velocity = _round(JOINT_SPEED * math.sqrt(GRAVITY / leg))
            guessed.append("no_load_speed")
        drive = source.drives.get(skeleton.name(joint), NO_DRIVE)
        figures[joint] = ServoFigures(
            effort, velocity, tuple(guessed), drive.armature, drive.damping, drive.friction
        )
    for joint, (leader, follower) in skeleton.followers.items():  # turned by the leader's motor
        motor = figures[leader]
        figures[joint] = replace(motor, velocity=motor.velocity * abs(follower.multiplier))
    return figures


def _round(value: float) -> float:
    return float(f"{value:.2g}")
