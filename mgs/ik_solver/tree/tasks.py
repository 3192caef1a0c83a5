"""The fifteen task coordinates of a robot that stands on one sole, and their Jacobian.

    t = [ swing sole position, right hand, left hand, CoM, swing sole orientation ]

as in the Melson paper, eq. (27), but written in the world frame: the support tree is placed at its
sole, which turns all rows alike and changes no joint velocity. Orientation errors are rotation
vectors (log map), not differences of Euler angles.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side
from mgs.ik_solver.tree.support_tree import SupportTree, build_support_tree
from mgs.robot import Robot
from mgs.robot.legs import Turn, missing_turn

N_TASKS = 15
SWING, RIGHT_HAND, LEFT_HAND, COM = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)
TURN = slice(12, 15)
# by the turn that legs lack: rows, and the axes of the base held in them
HELD: dict[Turn | None, tuple[tuple[int, int], ...]] = {
    None: (),
    "yaw": ((14, 1),),
    "roll": ((12, 0), (15, 2)),
}
WORLD_ALIGNED = pin.LOCAL_WORLD_ALIGNED


class TreeTasks:
    """Task values and Jacobian of one support tree, in buffers that every update refills.

    Rows of a hand of which nothing is asked are zero, in the Jacobian and in the error. Where legs
    lack a turn of the sole (`mgs.robot.legs`), its row holds the pelvis instead: upright for
    want of hip yaw; level for want of ankle roll, and straight ahead in a sixteenth row.

    Attributes:
        n_rows: number m of rows, 15 or 16.
        J: (m, n) task Jacobian in the tree's joint order; rows in the world frame.
        f: (12,) positions of swing sole, right hand, left hand and CoM [m].
        R: (3, 3) rotation of the swing sole.
        order: (n,) joints of the robot in the order of the tree, from the root outward.
    """

    def __init__(
        self, robot: Robot, side: Side, hands_asked: tuple[bool, bool] = (True, True)
    ) -> None:
        tree: SupportTree = build_support_tree(robot, side)
        self.tree = tree
        self.model, self.data = tree.model, tree.model.createData()
        self.order = tree.order
        self.mass = robot.mass
        self._com_tree = self.data.com[0]  # a view that every update refills
        self._com_scale = 1.0 - tree.root_mass / robot.mass  # the tree lacks its root link
        self._com_root = np.zeros(3)  # share of the root link in the CoM
        self._com = np.zeros(3)
        rows = zip((LEFT_HAND, RIGHT_HAND), hands_asked, strict=True)
        self.free_rows = [row for row, is_asked in rows if not is_asked]
        held = HELD[missing_turn(robot)]
        self.held_rows, self._held_axes = [row for row, _ in held], [axis for _, axis in held]
        self.n_rows = max([N_TASKS, *(row + 1 for row in self.held_rows)])
        self.J = np.zeros((self.n_rows, robot.n))
        self.f = np.zeros(12)
        self.R = np.eye(3)
        joints = self.model.supports[self.model.frames[tree.swing_sole].parentJoint]
        self.chain = np.array([joint - 1 for joint in joints if joint > 0])  # between the soles
        self.on_chain = np.zeros(robot.n)  # 1 for those joints
        self.on_chain[self.chain] = 1.0
        T_world_base = pin.XYZQUATToSE3(robot.standing_q[:FLOATING_BASE_NQ])
        self._base_rest = T_world_base.rotation  # while the soles look ahead
        self._heading = np.eye(3)  # of the support sole
        self._base_turn = np.zeros(3)  # from where it is to rest, axes of the support sole

    def place(self, T_world_sole: pin.SE3) -> None:
        """Stand on a sole at this pose."""
        self.tree.place(T_world_sole)
        share = self.tree.root_mass / self.mass
        self._com_root[:] = share * T_world_sole.act(self.tree.root_com)
        self._heading = T_world_sole.rotation

    def update(self, q: Array) -> None:
        """Refill J, f and R at joint angles q (n,) in the tree's order."""
        model, data, tree = self.model, self.data, self.tree
        swing_sole, (left_hand, right_hand) = tree.swing_sole, tree.hands
        J_com = pin.jacobianCenterOfMass(model, data, q, False)  # also places joints, fills data.J
        J_com *= self._com_scale
        np.multiply(self._com_tree, self._com_scale, out=self._com)
        self._com += self._com_root
        swing = pin.updateFramePlacement(model, data, swing_sole)
        left = pin.updateFramePlacement(model, data, left_hand)
        right = pin.updateFramePlacement(model, data, right_hand)
        positions = (swing.translation, right.translation, left.translation, self._com)
        np.concatenate(positions, out=self.f)
        self.R = swing.rotation
        J_swing = pin.getFrameJacobian(model, data, swing_sole, WORLD_ALIGNED)
        J_left = pin.getFrameJacobian(model, data, left_hand, WORLD_ALIGNED)
        J_right = pin.getFrameJacobian(model, data, right_hand, WORLD_ALIGNED)
        rows = (J_swing[:3], J_right[:3], J_left[:3], J_com, J_swing[3:])
        np.concatenate(rows, out=self.J[:N_TASKS])
        for free in self.free_rows:
            self.J[free] = 0.0
        if self.held_rows:
            base = pin.updateFramePlacement(model, data, tree.base).rotation
            J_base = pin.getFrameJacobian(model, data, tree.base, WORLD_ALIGNED)
            self.J[self.held_rows] = self._heading.T[self._held_axes] @ J_base[3:]
            turn = pin.log3(self._heading @ self._base_rest @ base.T)
            self._base_turn = self._heading.T @ turn

    def values(self, q: Array, f: Array, R: Array) -> None:
        """Write positions (12,) and swing sole rotation (3, 3) at q (n,); J, f and R stay."""
        model, data, tree = self.model, self.data, self.tree
        com = pin.centerOfMass(model, data, q, False)  # also places joints
        swing = pin.updateFramePlacement(model, data, tree.swing_sole)
        f[SWING] = swing.translation
        f[RIGHT_HAND] = pin.updateFramePlacement(model, data, tree.hands[1]).translation
        f[LEFT_HAND] = pin.updateFramePlacement(model, data, tree.hands[0]).translation
        np.multiply(com, self._com_scale, out=f[COM])
        f[COM] += self._com_root
        R[:] = swing.rotation

    def error(self, positions: Array, R_ref: Array, out: Array) -> None:
        """Target minus actual (m,) for positions (12,) in the order of f and a rotation (3, 3)."""
        np.subtract(positions, self.f, out=out[:12])
        out[TURN] = pin.log3(np.dot(R_ref, self.R.T))
        for free in self.free_rows:
            out[free] = 0.0
        if self.held_rows:
            out[self.held_rows] = self._base_turn[self._held_axes]

    def gravity(self, q: Array) -> tuple[Array, Array]:
        """Gravity torques (n,) [N m] and their derivative (n, n), in the tree's order.

        tau = -J_com^T M g and d tau / dq of the standing robot: Melson paper, eq. (24).
        """
        derivative = pin.computeGeneralizedGravityDerivatives(self.model, self.data, q)
        return self.data.g, derivative
