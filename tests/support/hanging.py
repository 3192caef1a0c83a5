"""A pendulum on one servo, for the reference responses of identified servos."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from mgs.robot import Robot, build_robot

BASE_MASS = 2000.0  # [kg]: it stands still


def hanging(
    servo: dict[str, Any],
    *,
    mass: float,
    rod: float,
    length: float,
    zero: float = 0.0,
    rotor: float = 0.0,
) -> Robot:
    """A heavy block with a pendulum: a point mass at the end of a uniform rod.

    Args:
        servo: entry of robot.yaml.
        mass: of the point [kg].
        rod: mass of the rod [kg].
        length: of the rod [m].
        zero: angle at which the pendulum stands off the vertical at joint angle 0 [rad].
        rotor: inertia that the pendulum has about its joint besides [kg m^2].
    """
    side = {"link": "base", "position": [0.0, 0.0, 0.0]}
    sole = {"length": 0.5, "width": 0.2}
    spec = {
        "mgs": 1,
        "name": "hanging",
        "base_link": "base",
        "torso": side,
        "soles": {
            name: side | sole | {"position": [0.0, y, -0.5]}
            for name, y in (("left", 0.2), ("right", -0.2))
        },
        "posture": {},
        "servos": {"servo": servo},
        "joints": {"joint": "servo"},
    }
    total = mass + rod
    com = (mass + 0.5 * rod) * length / total
    about_joint = mass * length**2 + rod * length**2 / 3.0
    across = about_joint - total * com**2 + rotor
    x, z = -com * np.sin(zero), -com * np.cos(zero)  # turned about +y: at pi/2 it points to -x
    urdf = f"""<robot name="hanging">
      <link name="base"><inertial><mass value="{BASE_MASS}"/>
        <inertia ixx="500" iyy="500" izz="500" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <link name="arm"><inertial><origin xyz="{x} 0 {z}"/><mass value="{total}"/>
        <inertia ixx="{across}" iyy="{across}" izz="{across}" ixy="0" ixz="0" iyz="0"/></inertial>
      </link>
      <joint name="joint" type="revolute"><parent link="base"/><child link="arm"/>
        <origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>
        <limit lower="-9" upper="9" effort="100" velocity="100"/></joint></robot>"""
    return build_robot(json.dumps(spec), urdf, "hanging")
