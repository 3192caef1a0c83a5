"""A model of MuJoCo straight from a robot's URDF, as an oracle of kinematics.

It shares nothing with the model that `mgs.sim` builds: MuJoCo's own importer reads the URDF, with a
free joint at the root.
"""

from __future__ import annotations

from xml.etree import ElementTree

import mujoco
import numpy as np

from mgs.robot import Robot


def mujoco_model(robot: Robot, fuse: bool = True) -> mujoco.MjModel:
    """Model of the links; `fuse` merges those that are fixed into their parents."""
    urdf = ElementTree.fromstring(robot.urdf)
    for link in urdf.findall("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    options = ElementTree.SubElement(ElementTree.SubElement(urdf, "mujoco"), "compiler")
    options.set("fusestatic", "false")
    options.set("balanceinertia", "true")
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(urdf, encoding="unicode"))
    root = spec.worldbody.first_body()
    root.add_freejoint(name="root")
    spec.compiler.fusestatic = fuse
    return spec.compile()


def joint_order(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the joints but the free one."""
    return tuple(model.joint(i).name for i in range(1, model.njnt))


def place(
    model: mujoco.MjModel, data: mujoco.MjData, robot: Robot, q: np.ndarray, v: np.ndarray
) -> None:
    """Compute positions and velocities at q (7 + n,) and v (6 + n,) in the order of mgs."""
    index = [robot.joint_names.index(name) for name in joint_order(model)]
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, q[[6, 3, 4, 5]])
    data.qpos[:] = [*q[:3], *q[[6, 3, 4, 5]], *q[7:][index]]
    data.qvel[:] = [*(rotation.reshape(3, 3) @ v[:3]), *v[3:6], *v[6:][index]]
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_comVel(model, data)
