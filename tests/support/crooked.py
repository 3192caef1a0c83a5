"""A robot without a right angle: what a slip in a frame or an axis cannot hide behind.

All of Melson's joint frames are parallel, so that a missing rotation goes unseen there.
"""

from __future__ import annotations

import json

import numpy as np

from mgs.robot import Robot, build_robot

LEG = ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch", "ankle_roll")
ARM = ("shoulder_pitch", "shoulder_roll", "elbow")


def crooked_robot(seed: int) -> Robot:
    """Melson's topology with random joint frames, axes and inertias, and feet on fixed joints."""
    rng = np.random.default_rng(seed)
    chains = [("pelvis", ["waist"])]
    for side in ("left", "right"):
        chains.append(("pelvis", [f"{side}_{name}" for name in LEG]))
        chains.append(("waist_link", [f"{side}_{name}" for name in ARM]))
    parts, joints = [_link("pelvis", rng)], []
    for parent, names in chains:
        for name in names:
            parts += [_joint(name, parent, f"{name}_link", rng), _link(f"{name}_link", rng)]
            joints.append(name)
            parent = f"{name}_link"
    for side in ("left", "right"):
        parts += [
            _joint(f"{side}_weld", f"{side}_ankle_roll_link", f"{side}_foot", rng, kind="fixed"),
            _link(f"{side}_foot", rng),
        ]
    urdf = f'<robot name="crooked">{"".join(parts)}</robot>'
    return build_robot(json.dumps(_spec(joints, rng)), urdf, "crooked")


def _spec(joints: list[str], rng: np.random.Generator) -> dict[str, object]:
    """Content of its robot.yaml; every JSON text is a YAML text."""

    def frame(link: str, **size: float) -> dict[str, object]:
        return {"link": link, "position": rng.uniform(-0.1, 0.1, 3).tolist(), **size}

    sides = ("left", "right")
    return {
        "mgs": 1,
        "name": "crooked",
        "base_link": "pelvis",
        "torso": frame("waist_link"),
        "soles": {side: frame(f"{side}_foot", length=0.2, width=0.1) for side in sides},
        "hands": {side: frame(f"{side}_elbow_link") for side in sides},
        "posture": {name: float(rng.uniform(-1.0, 1.0)) for name in joints},
        "servos": {"servo": {"stall_torque": 10.0, "no_load_speed": 10.0}},
        "joints": {name: "servo" for name in joints},
    }


def _link(name: str, rng: np.random.Generator) -> str:
    """A link that weighs what a random box turned at random would."""
    mass, size = rng.uniform(0.1, 1.0), rng.uniform(0.02, 0.2, 3)
    ixx, iyy, izz = mass / 12.0 * (size @ size - size**2)
    return (
        f'<link name="{name}"><inertial>{_origin(rng)}<mass value="{mass}"/><inertia '
        f'ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def _joint(
    name: str, parent: str, child: str, rng: np.random.Generator, kind: str = "revolute"
) -> str:
    axis = rng.normal(size=3)
    x, y, z = axis / np.linalg.norm(axis)
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'{_origin(rng)}<axis xyz="{x} {y} {z}"/>'
        '<limit lower="-2" upper="2" effort="10" velocity="10"/></joint>'
    )


def _origin(rng: np.random.Generator) -> str:
    x, y, z = rng.uniform(-0.2, 0.2, 3)
    roll, pitch, yaw = rng.uniform(-1.0, 1.0, 3)
    return f'<origin xyz="{x} {y} {z}" rpy="{roll} {pitch} {yaw}"/>'
