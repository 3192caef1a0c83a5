"""The fifteen task coordinates of a robot that stands on one sole, and their Jacobian.

    t = [ swing sole position, right hand, left hand, CoM, swing sole orientation ]

as in eq. (27) of "Inverse kinematics of a humanoid robot modelled as a tree-shaped manipulator",
but written in the world frame: the support tree is placed at its sole, which turns all rows alike
and changes no joint velocity. Orientation errors are rotation vectors (log map), not differences of
Euler angles.
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

N_TASKS, N_POSITIONS = 15, 12
SWING, RIGHT_HAND, LEFT_HAND, COM = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)
TURN = slice(12, 15)
# Rows and axes of the base that are held in them, by the turn of the sole that the legs lack.
HELD: dict[Turn | None, tuple[tuple[int, int], ...]] = {
    None: (),
    "yaw": ((14, 1),),
    "roll": ((12, 0), (15, 2)),
}
WORLD_ALIGNED = pin.LOCAL_WORLD_ALIGNED


class TreeTasks:
    """Task values and Jacobian of one support tree, in buffers that every update refills.

    Rows of a hand that is free are zero, in the Jacobian and in the error. Where legs lack a turn
    of the sole (`mgs.robot.legs`), its row holds the pelvis instead: upright without hip yaw; level
    without ankle roll, and straight ahead in a sixteenth row.

    Coordinates are the angles of the joints that move by themselves, n in number. Where joints are
    coupled, all angles are S q + s0 (`mgs.robot.coupling`), and Jacobians are J S.

    Attributes:
        n_rows: number m of rows, 15 or 16.
        asked_rows: rows that are not those of a free hand.
        rows: (m + 1, n) the Jacobian, and below it a row that is left to the solver.
        J: (m, n) task Jacobian in the tree's joint order; rows in the world frame.
        f: (12,) positions of swing sole, right hand, left hand and CoM [m].
        R: (3, 3) rotation of the swing sole, a view that follows every update.
        order: (n,) joints of the robot that are coordinates, in the order of the tree, from the
            root outward.
    """

    def __init__(
        self, robot: Robot, side: Side, hands_asked: tuple[bool, bool] = (True, True)
    ) -> None:
        tree: SupportTree = build_support_tree(robot, side)
        self.tree = tree
        self.model, self.data = tree.model, tree.model.createData()
        self._set_coordinates(robot)
        rows = zip((LEFT_HAND, RIGHT_HAND), hands_asked, strict=True)
        self.free_rows = [row for row, is_asked in rows if not is_asked]
        held = HELD[missing_turn(robot)]
        self.held_rows, self._held_axes = [row for row, _ in held], [axis for _, axis in held]
        self._has_exceptions = bool(self.free_rows or self.held_rows)
        self.n_rows = max([N_TASKS, *(row + 1 for row in self.held_rows)])
        free = [np.arange(N_TASKS)[rows] for rows in self.free_rows]
        self.asked_rows = np.setdiff1d(np.arange(self.n_rows), np.concatenate([[-1], *free]))
        self.rows = np.zeros((self.n_rows + 1, len(self.order)))
        self.J, self.f = self.rows[:-1], np.zeros(N_POSITIONS)
        self._J_tasks = self.J[:N_TASKS]
        self._com, self._com_offset = np.zeros(3), tree.com_offset  # in the world frame [m]
        # views that follow every update
        self._frames = (tree.swing_sole, tree.hands[Side.RIGHT], tree.hands[Side.LEFT])
        points = (self.data.oMf[frame].translation for frame in self._frames)
        self._points, self._com_tree = (*points, self._com), self.data.com[0]
        self.R = self.data.oMf[tree.swing_sole].rotation
        self._R_T = self.R.T
        joints = self.model.supports[self.model.frames[tree.swing_sole].parentJoint]
        self.chain = np.array([joint - 1 for joint in joints if joint > 0])  # between the soles
        self._on_chain = np.zeros((6, robot.n), order="F")  # 1 in the columns of those joints
        self._on_chain[:, self.chain] = 1.0
        self._J_world = self.data.J  # a view that follows every update
        T_world_base = pin.XYZQUATToSE3(robot.standing_q[:FLOATING_BASE_NQ])
        self._base_rest = T_world_base.rotation  # of the base that faces ahead, upright
        self._heading = np.eye(3)  # rotation of the support sole
        self._base_turn = np.zeros(3)  # from the base to its rest, axes of the support sole

    def _set_coordinates(self, robot: Robot) -> None:
        """Choose the coordinates: joints in the tree's order, of coupled ones the leaders alone."""
        order, coupling = self.tree.order, robot.coupling
        is_free = robot.motors[order]
        self.order = order[is_free]
        self._S: Array | None = None
        self._s0 = np.zeros(len(order))
        if coupling is not None:
            self._S = np.ascontiguousarray(coupling.S[np.ix_(order, self.order)])
            self._s0 = coupling.s0[order]

    def place(self, T_world_sole: pin.SE3) -> None:
        """Place the support sole in the world."""
        self.tree.place(T_world_sole)
        self._heading = T_world_sole.rotation
        self._com_offset = self._heading @ self.tree.com_offset

    def update(self, q: Array) -> None:
        """Refill J, f and R at joint angles q (n,) in the tree's order."""
        model, data, S = self.model, self.data, self._S
        q = self._all(q)
        swing_sole, right_hand, left_hand = self._frames
        J_com = pin.jacobianCenterOfMass(model, data, q, False)  # also places joints, fills data.J
        J_swing = pin.getFrameJacobian(model, data, swing_sole, WORLD_ALIGNED)
        J_right = pin.getFrameJacobian(model, data, right_hand, WORLD_ALIGNED)
        J_left = pin.getFrameJacobian(model, data, left_hand, WORLD_ALIGNED)
        rows = (J_swing[:3], J_right[:3], J_left[:3], J_com, J_swing[3:])
        if S is None:
            np.concatenate(rows, 0, self._J_tasks)
        else:
            np.dot(np.concatenate(rows, 0), S, self._J_tasks)
        self._set_values(self.f)
        if self._has_exceptions:
            self._set_exceptions()

    def _set_values(self, f: Array) -> None:
        """Fill f (12,) and R after the joints have been placed."""
        pin.updateFramePlacements(self.model, self.data)
        np.add(self._com_tree, self._com_offset, self._com)
        np.concatenate(self._points, 0, f)

    def _set_exceptions(self) -> None:
        """Clear the rows of free hands, and fill those that hold the pelvis."""
        for free in self.free_rows:
            self.J[free] = 0.0
        if self.held_rows:
            base = self.data.oMf[self.tree.base].rotation
            J_base = pin.getFrameJacobian(self.model, self.data, self.tree.base, WORLD_ALIGNED)
            self.J[self.held_rows] = self._heading.T[self._held_axes] @ self._free(J_base[3:])
            turn = pin.log3(self._heading @ self._base_rest @ base.T)
            self._base_turn = self._heading.T @ turn

    def values(self, q: Array, f: Array, R: Array) -> None:
        """Write positions (12,) and swing sole rotation (3, 3) at q (n,); J and f stay."""
        pin.centerOfMass(self.model, self.data, self._all(q), False)  # also places joints
        self._set_values(f)
        R[:] = self.R

    def error(self, positions: Array, R_ref: Array, out: Array) -> None:
        """Fill out (m,) with target minus actual, after `update`.

        Args:
            positions: (12,) targets in the order of f [m].
            R_ref: (3, 3) target of R.
            out: (m,) the error.
        """
        np.subtract(positions, self.f, out[:N_POSITIONS])
        out[TURN] = pin.log3(R_ref.dot(self._R_T))
        if self._has_exceptions:
            for free in self.free_rows:
                out[free] = 0.0
            out[self.held_rows] = self._base_turn[self._held_axes]

    def torso_error(self, R_ref: Array) -> tuple[Array, Array]:
        """Jacobian (3, n) and error (3,) of the torso's rotation, after `update`, world axes."""
        frame = self.tree.torso
        J = self._free(pin.getFrameJacobian(self.model, self.data, frame, WORLD_ALIGNED)[3:])
        return J, pin.log3(R_ref.dot(self.data.oMf[frame].rotation.T))

    def yaw_momentum(self, q: Array) -> Array:
        """Row (n,) that turns joint speeds into the angular momentum of the robot at q (n,).

        About the vertical through the CoM [kg m^2]. The mass of the support sole is at rest.
        """
        momentum = pin.computeCentroidalMap(self.model, self.data, self._all(q))
        x, y, _ = self._com_offset
        return self._free(momentum[5] - x * momentum[1] + y * momentum[0])

    def swing_jacobian(self) -> Array:
        """Spatial Jacobian of the swing sole by all joints, in the world, at the last angles."""
        return self._J_world * self._on_chain

    def gravity(self, q: Array) -> tuple[Array, Array]:
        """Gravity torques of all joints [N m] and their derivative, in the model's order.

        tau = -J_com^T M g and d tau / dq of the standing robot, eq. (24) of the same paper.
        """
        derivative = pin.computeGeneralizedGravityDerivatives(self.model, self.data, self._all(q))
        return self.data.g, derivative

    def at_motors(self, tau: Array, derivative: Array) -> tuple[Array, Array]:
        """Torques (n,) of the motors and their derivative (n, n), from those of all joints."""
        S = self._S
        return (tau, derivative) if S is None else (tau.dot(S), S.T.dot(derivative).dot(S))

    def _all(self, q: Array) -> Array:
        """Angles of all joints, in the model's order, from the coordinates q (n,)."""
        return q if self._S is None else self._S.dot(q) + self._s0

    def _free(self, J: Array) -> Array:
        """Jacobian (..., n) by the coordinates, from one by all joints."""
        return J if self._S is None else J @ self._S
