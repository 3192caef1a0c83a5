"""Gravity torques with both soles on the ground, where the contact wrenches are not unique.

The support tree hangs on one sole, its root, so that gravity alone makes it carry everything. The
other sole takes the wrench w (6,) over (force, then moment about the world origin; world axes):

    tau(q) = tau_g(q) - J(q)^T w          J (6, n): spatial Jacobian of the other sole, in the world
    dtau_j/dq_i = dtau_g,j/dq_i - (J_i x J_j) . w    for i before j on the chain to it, 0 elsewhere

The other sole always takes the part of the weight that `TaskTrajectory.load_left` plans for it.
This part is zero at the instants of landing and lift-off, as in single support: tau is continuous.
The other components of w are chosen in one of two ways.

    shared    no horizontal force; both centres of pressure displaced alike, so that together they
              act below the CoM: the rule of `mgs.motion.dynamics`.
    optimal   min over w of 1/2 tau^T tau, both soles within friction and rectangle. The derivative
              of the minimum is that at the minimiser held fixed, since no limit depends on q.

The wrench is computed from the references of CoM and soles, so that it does not vary with q.
"""

from __future__ import annotations

import functools
from typing import Literal

import daqp
import numpy as np

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.ik_solver.tree.wrench_cones import skew, wrench_cones
from mgs.motion.dynamics import share_wrench
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

Sharing = Literal["off", "shared", "optimal"]
LEAST_LOAD = 1e-4  # share of the weight below which a sole keeps the shared wrench
DAMPING = 1e-6  # of the free wrench components, relative to the mean curvature
SOLVED, TOLERANCE = 1, 1e-9  # exit flag and tolerance of DAQP


class StaticLoads:
    """The static wrench on the sole that is not the root, at every sample.

    Attributes:
        wrench: (N, 6) force [N] and moment about the world origin [N m]; zero in single support.
        cross: (N, 6, 6) its `motion_cross`.
        loaded: (N,) whether the sole carries a part of the weight.
        optimal: whether the wrench of least torque replaces the shared one.
    """

    def __init__(
        self, robot: Robot, tasks: TaskTrajectory, com: ComTrajectory, sharing: Sharing
    ) -> None:
        self.weight = -robot.mass * float(robot.model.gravity.linear[2])
        both = shared_wrenches(self.weight, tasks, com.position)
        samples = np.arange(tasks.n_samples)
        other = 1 - tasks.root
        self.wrench = np.ascontiguousarray(both[samples, other])
        self.cross = motion_cross(self.wrench)
        self.optimal = sharing == "optimal"
        self.loaded = self.wrench[:, 2] > 0.0
        if self.optimal:
            self._set_limits(robot, tasks, both)

    def _set_limits(self, robot: Robot, tasks: TaskTrajectory, both: Array) -> None:
        """Free wrench components y (5,) and the limits rows y <= room of both soles."""
        samples, other = np.arange(tasks.n_samples), 1 - tasks.root
        load = self.wrench[:, 2] / self.weight
        self._free = (load > LEAST_LOAD) & (load < 1.0 - LEAST_LOAD)
        if tasks.pressure is not None:  # a sole that rolls bears on an edge, not on a rectangle
            self._free[:] = False
        self._moves = np.zeros((tasks.n_samples, 6, 5))  # columns: fx, fy, mx, my, mz at the sole
        self._moves[:, [0, 1, 3, 4, 5], range(5)] = 1.0
        p = tasks.soles[samples, other, :3]
        self._moves[:, 3:, 0] = np.cross(p, [1.0, 0.0, 0.0])
        self._moves[:, 3:, 1] = np.cross(p, [0.0, 1.0, 0.0])
        cones = np.stack([wrench_cones(robot, side, tasks, both) for side in Side], axis=1)
        at_other, at_root = cones[samples, other], cones[samples, tasks.root]
        # U w_other <= 0 and U (w_root - moves y) <= 0
        self._rows = np.concatenate([at_other @ self._moves, -at_root @ self._moves], axis=1)
        root_wrench = both[samples, tasks.root]
        self._room = -np.concatenate(
            [
                np.einsum("nij,nj->ni", at_other, self.wrench),
                np.einsum("nij,nj->ni", at_root, root_wrench),
            ],
            axis=1,
        )

    def at(self, k: int, tau: Array, J: Array) -> tuple[Array, Array]:
        """Wrench (6,) at sample k and its `motion_cross`.

        Args:
            k: the sample.
            tau: (n,) gravity torques if the root sole carried everything [N m].
            J: (6, n) spatial Jacobian of the other sole in the world.
        """
        if not (self.optimal and self._free[k]):
            return self.wrench[k], self.cross[k]
        moves, rows, room = self._moves[k], self._rows[k], self._room[k]
        B = J.T @ moves
        H = B.T @ B
        H.ravel()[::6] += DAMPING * np.trace(H) / 5.0
        g = B.T @ (J.T @ self.wrench[k] - tau)
        y = np.linalg.solve(H, -g)
        if np.any(rows @ y > room):
            y = _bounded(H, g, rows, room)
        wrench = self.wrench[k] + moves @ y
        return wrench, motion_cross(wrench)


def _bounded(H: Array, g: Array, rows: Array, room: Array) -> Array:
    """Minimiser of 1/2 y^T H y + g^T y with rows y <= room; y = 0 is feasible."""
    lower = np.full(len(room), -1e30)
    y, _, flag, _ = daqp.solve(
        H, g, rows, room, lower, np.zeros(len(room), np.int32), primal_tol=TOLERANCE
    )
    if flag != SOLVED:
        raise ArithmeticError(f"DAQP ended with exit flag {flag}")
    return np.asarray(y)


def shared_wrenches(weight: float, tasks: TaskTrajectory, com: Array) -> Array:
    """Wrenches (N, 2, 6) about the world origin that hold a weight at rest, CoM at com (N, 3)."""
    total = np.zeros((len(com), 6))
    total[:, 2] = weight
    total[:, 3], total[:, 4] = weight * com[:, 1], -weight * com[:, 0]
    places = tasks.soles[..., :3] if tasks.pressure is None else tasks.pressure
    return share_wrench(total, com[:, :2], places, tasks.load_left)


def motion_cross(wrench: Array) -> Array:
    """Matrices C (..., 6, 6) for wrenches w (..., 6): C J_i = J_i x* w, the force cross product."""
    C = np.zeros((*wrench.shape[:-1], 6, 6))
    C[..., :3, 3:] = C[..., 3:, :3] = -skew(wrench[..., :3])
    C[..., 3:, 3:] = -skew(wrench[..., 3:])
    return C


def contact_derivative(product: Array) -> Array:
    """Derivative (..., n, n) of (J^T w)_j by q_i, first axis j, where C is `motion_cross(w)`.

    Args:
        product: (..., n, n) J^T C J.
    """
    return np.asarray(product * _minus_below_diagonal(product.shape[-1]))


@functools.cache
def _minus_below_diagonal(n: int) -> Array:
    return -np.tril(np.ones((n, n)), -1)


def loaded_gravity(
    tree: TreeTasks, loads: StaticLoads | None, k: int, q: Array
) -> tuple[Array, Array]:
    """Static torques (n,) of the motors at sample k [N m] and their derivative (n, n).

    Both are in the order of the tree's coordinates q (n,).

    Without `loads` the root sole carries everything.
    """
    tau, derivative = tree.gravity(q)
    if loads is None or not loads.loaded[k]:
        return tree.at_motors(tau, derivative)
    J = tree.swing_jacobian()
    wrench, C = loads.at(k, tau, J)
    tau, derivative = tau - wrench.dot(J), derivative - contact_derivative(J.T.dot(C.dot(J)))
    return tree.at_motors(tau, derivative)
