"""A robot that is all base but for one joint, whose motion under a servo has a closed form."""

from __future__ import annotations

from typing import Any

import numpy as np

from mgs.robot import Robot, build_robot

MASS, LEVER, INERTIA = 0.4, 0.1, 1e-5  # of the arm [kg], [m], [kg m^2] about its own CoM
BASE_MASS = 2000.0  # [kg]: it stands still
AXES = {"upright": "0 0 1", "level": "0 -1 0"}  # of the joint; about the second, weight pulls down


def pendulum(axis: str = "upright", mass: float = MASS, **servo: Any) -> Robot:
    """A block on two soles with an arm that points forward at angle 0, upward at positive ones."""
    figures = {"stall_torque": 100.0, "no_load_speed": 100.0, **servo}
    side = {"link": "base", "position": [0.0, 0.0, 0.0]}
    sole = {"length": 0.5, "width": 0.2}
    spec = {
        "mgs": 1,
        "name": "pendulum",
        "base_link": "base",
        "torso": side,
        "soles": {
            "left": side | sole | {"position": [0.0, 0.2, -0.5]},
            "right": side | sole | {"position": [0.0, -0.2, -0.5]},
        },
        "hands": {"left": side, "right": side},
        "posture": {},
        "servos": {"servo": figures},
        "joints": {"joint": "servo"},
    }
    inertia = " ".join(f'i{ij}="{v}"' for ij, v in (("xx", 1), ("yy", 1), ("zz", 1)))
    small = " ".join(f'i{ij}="{INERTIA}"' for ij in ("xx", "yy", "zz"))
    urdf = f"""<robot name="pendulum">
      <link name="base"><inertial><mass value="{BASE_MASS}"/>
        <inertia {inertia.replace('"1"', '"500"')} ixy="0" ixz="0" iyz="0"/></inertial></link>
      <link name="arm"><inertial><origin xyz="{LEVER} 0 0"/><mass value="{mass}"/>
        <inertia {small} ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="joint" type="revolute"><parent link="base"/><child link="arm"/>
        <origin xyz="0 0 0.5"/><axis xyz="{AXES[axis]}"/>
        <limit lower="-90" upper="90" effort="100" velocity="100"/></joint></robot>"""
    import json

    return build_robot(json.dumps(spec), urdf, "pendulum")


def inertia_of(mass: float = MASS) -> float:
    """Of the arm about the joint [kg m^2]."""
    return mass * LEVER**2 + INERTIA


def step_response(t: Any, inertia: float, damping: float, stiffness: float) -> Any:
    """Angle at times t of inertia q'' + damping q' + stiffness (q - 1) = 0, at rest at 0 before."""
    a, b = np.roots([inertia, damping, stiffness]).astype(complex)
    return np.real(1.0 - (b * np.exp(a * t) - a * np.exp(b * t)) / (b - a))
