"""A biped with the dimensions of NAO, whose two hips are turned by one motor.

Lengths and joint ranges are those that its maker publishes (Aldebaran, NAO H25 V4.0, "Links" and
"Joints"), masses are rounded from "Masses". Bodies are boxes of these masses. The axes of both hip
yaw-pitch joints are oblique, 45 deg between the vertical and the lateral axis, and one motor turns
both by the same angle. Torques and speeds are round figures of that size.
"""

from __future__ import annotations

import math
from typing import NamedTuple

Vector = tuple[float, ...]
X, Y, Z, ORIGIN = (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)

OBLIQUE = math.sqrt(0.5)
HIP = (0.05, -0.085)  # y and z of the hip from the origin of the torso [m]
THIGH, TIBIA, FOOT = 0.1, 0.1029, 0.04519  # lengths of the leg [m]
SHOULDER = (0.098, 0.1)  # y and z of the shoulder [m]
UPPER_ARM, ELBOW, LOWER_ARM = 0.105, 0.015, 0.1137  # to the middle of the hand [m]
NECK = 0.1265
EFFORT = {"leg": 12.0, "arm": 3.0}  # [N m]
SPEED = {"leg": 5.0, "arm": 7.0}  # [rad/s]


class Part(NamedTuple):
    """A joint of a left limb, and the body that it turns."""

    joint: str
    axis: Vector
    origin: Vector  # in the body before [m]
    limits: tuple[float, float]  # [rad]
    mass: float  # [kg]
    size: Vector  # [m]
    centre: Vector = (0.0, 0.0, 0.0)  # of the body, from the joint [m]


LEG = (
    Part(
        "HipYawPitch", (0, OBLIQUE, -OBLIQUE), (0, *HIP), (-1.145, 0.740), 0.07, (0.04, 0.04, 0.04)
    ),
    Part("HipRoll", X, ORIGIN, (-0.379, 0.790), 0.14, (0.04, 0.04, 0.04)),
    Part("HipPitch", Y, ORIGIN, (-1.535, 0.484), 0.39, (0.06, 0.06, 0.08), (0, 0, -0.05)),
    Part("KneePitch", Y, (0, 0, -THIGH), (-0.092, 2.112), 0.3, (0.05, 0.05, 0.08), (0, 0, -0.05)),
    Part("AnklePitch", Y, (0, 0, -TIBIA), (-1.189, 0.922), 0.13, (0.03, 0.03, 0.03)),
    Part(
        "AnkleRoll", X, ORIGIN, (-0.397, 0.769), 0.17, (0.16, 0.088, 0.03),
        (0.02, 0.005, 0.015 - FOOT),
    ),
)  # fmt: skip
ARM = (
    Part("ShoulderPitch", Y, (0, *SHOULDER), (-2.085, 2.085), 0.09, (0.04, 0.03, 0.04)),
    Part("ShoulderRoll", Z, ORIGIN, (-0.314, 1.326), 0.16, (0.08, 0.04, 0.04), (0.05, 0.01, 0)),
    Part("ElbowYaw", X, (UPPER_ARM, ELBOW, 0), (-2.085, 2.085), 0.06, (0.03, 0.03, 0.03)),
    Part("ElbowRoll", Z, ORIGIN, (-1.544, -0.035), 0.26, (0.12, 0.04, 0.04), (0.06, 0, 0)),
)


def nao_like(coupled: bool = True) -> str:
    """Text of the URDF; without coupling every joint has a motor of its own."""
    parts = [_link("torso", 1.04, (0.08, 0.12, 0.14), (0, 0, 0.04))]
    for side in ("L", "R"):
        parts += _limb(side, LEG, "leg", coupled)
        parts += _limb(side, ARM, "arm", coupled)
    parts += _joint("HeadYaw", "torso", "neck", (0, 0, 1), (0, 0, NECK), (-2.085, 2.085), "arm")
    parts.append(_link("neck", 0.08, (0.03, 0.03, 0.03), (0, 0, 0)))
    parts += _joint("HeadPitch", "neck", "head", (0, 1, 0), (0, 0, 0), (-0.672, 0.514), "arm")
    parts.append(_link("head", 0.6, (0.1, 0.13, 0.1), (0, 0, 0.06)))
    return "\n".join(['<robot name="nao_like">', *parts, "</robot>"])


def _limb(side: str, joints: tuple[Part, ...], kind: str, coupled: bool) -> list[str]:
    parts, above = [], "torso"
    for name, axis, origin, limits, mass, size, centre in joints:
        mimic = ""
        if side == "R":  # mirrored at the middle plane
            origin, centre = ((x, -y, z) for x, y, z in (origin, centre))
            if name == "HipYawPitch":  # the same angle turns both hips outward
                axis = (axis[0], axis[1], -axis[2])
                mimic = '<mimic joint="LHipYawPitch"/>' if coupled else ""
            elif not axis[1]:
                limits = (-limits[1], -limits[0])
        link = f"{side}{name}_link"
        parts += _joint(f"{side}{name}", above, link, axis, origin, limits, kind, mimic)
        parts.append(_link(link, mass, size, centre))
        above = link
    return parts


def _joint(
    name: str,
    parent: str,
    child: str,
    axis: tuple[float, ...],
    origin: tuple[float, ...],
    limits: tuple[float, float],
    kind: str,
    mimic: str = "",
) -> list[str]:
    return [
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{_text(origin)}"/><axis xyz="{_text(axis)}"/>{mimic}'
        f'<limit lower="{limits[0]}" upper="{limits[1]}" effort="{EFFORT[kind]}" '
        f'velocity="{SPEED[kind]}"/></joint>'
    ]


def _link(name: str, mass: float, size: tuple[float, ...], centre: tuple[float, ...]) -> str:
    x, y, z = (mass / 12.0 * (sum(s * s for s in size) - s * s) for s in size)
    origin = f'<origin xyz="{_text(centre)}"/>'
    return (
        f'<link name="{name}"><inertial>{origin}<mass value="{mass}"/>'
        f'<inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="0" ixz="0" iyz="0"/></inertial>'
        f'<collision>{origin}<geometry><box size="{_text(size)}"/></geometry></collision></link>'
    )


def _text(values: tuple[float, ...]) -> str:
    return " ".join(repr(float(value)) for value in values)
