"""Comparison of a drafted robot with MuJoCo's own compile of the MJCF that it was made from."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.robot import Robot


class Twins:
    """A drafted robot and the model of its MJCF, at equal joint angles, bases aligned.

    Locked joints of the robot are at the same angles in MuJoCo's model. Only the names of bodies
    and joints connect the two; every figure comes from the library of its side.
    """

    def __init__(self, robot: Robot, model: Any) -> None:
        self.robot, self.model, self.data = robot, model, mujoco.MjData(model)
        bodies = [b for b in range(1, model.nbody) if model.body_parentid[b] == 0]
        self.base = max(bodies, key=lambda b: model.body_subtreemass[b])
        self.joints = [model.joint(name) for name in robot.joint_names]
        self.dofs = np.array([int(joint.dofadr[0]) for joint in self.joints])
        self.below = [b for b in range(1, model.nbody) if self._is_below(b)]

    def _is_below(self, body: int) -> bool:
        while body and body != self.base:
            body = int(self.model.body_parentid[body])
        return body == self.base

    def pose(self, angles: Array) -> pin.Data:
        """Put both at joint angles (n,), the robot's base where MuJoCo has it."""
        mujoco.mj_resetData(self.model, self.data)
        for name, angle in self.robot.spec.locked.items():
            self.data.qpos[self.model.joint(name).qposadr[0]] = angle
        for joint, angle in zip(self.joints, angles, strict=True):
            self.data.qpos[joint.qposadr[0]] = angle
        mujoco.mj_forward(self.model, self.data)
        q = pin.neutral(self.robot.model)
        q[7:] = angles
        known = next(b for b in self.below if self._knows(b))
        there = self._link_pose(q, self.model.body(known).name)
        q[:7] = pin.SE3ToXYZQUAT(self.mujoco_pose(known) * there.inverse())
        data = self.robot.model.createData()
        pin.crba(self.robot.model, data, q)
        pin.centerOfMass(self.robot.model, data, q)
        self.q = q
        return data

    def _knows(self, body: int) -> bool:
        """Whether the robot has a link of the name of a body."""
        return bool(self.robot.model.existBodyName(self.model.body(body).name))

    def _link_pose(self, q: Array, body: str) -> pin.SE3:
        """Pose of the frame of a body in the robot, from the link that has its name."""
        data = self.robot.model.createData()
        pin.framesForwardKinematics(self.robot.model, data, q)
        return data.oMf[self.robot.model.getBodyId(body)].copy()

    def mujoco_pose(self, body: int) -> pin.SE3:
        """Pose of a body in MuJoCo, its origin at the last of its joints, as in the robot."""
        R = self.data.xmat[body].reshape(3, 3)
        n = int(self.model.body_jntnum[body])
        first = int(self.model.body_jntadr[body])
        is_hinge = n and self.model.jnt_type[first] == mujoco.mjtJoint.mjJNT_HINGE
        anchor = self.model.jnt_pos[first + n - 1] if is_hinge else np.zeros(3)
        return pin.SE3(R, self.data.xpos[body] + R @ anchor)

    def link_errors(self) -> Array:
        """Distances [m] and rotations [rad] of all links that both sides know, (k, 2)."""
        errors = []
        for body in self.below:
            if self._knows(body):
                ours = self._link_pose(self.q, self.model.body(body).name)
                theirs = self.mujoco_pose(body)
                apart = np.linalg.norm(ours.translation - theirs.translation)
                turn = np.linalg.norm(pin.log3(ours.rotation.T @ theirs.rotation))
                errors.append((apart, turn))
        return np.array(errors)

    def mass(self) -> float:
        """Mass of MuJoCo's robot [kg]."""
        return float(self.model.body_subtreemass[self.base])

    def com(self) -> Array:
        """CoM (3,) of MuJoCo's robot [m]."""
        return np.array(self.data.subtree_com[self.base])

    def inertia(self) -> Array:
        """Joint-space inertia (n, n) of MuJoCo's robot, without rotors."""
        full = np.zeros((self.model.nv, self.model.nv))
        for unit, column in zip(np.eye(self.model.nv), full, strict=True):
            mujoco.mj_mulM(self.model, self.data, column, unit)
        joints = full[np.ix_(self.dofs, self.dofs)]
        return joints - np.diag(self.model.dof_armature[self.dofs])


def compiled(path: Path) -> Any:
    """MuJoCo's own compile of a file."""
    return mujoco.MjModel.from_xml_path(str(path))
