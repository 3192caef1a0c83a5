"""Gravity torques with both soles on the ground, where the contact wrenches are not unique.

The support tree hangs on one sole, its root, so that gravity alone makes it carry everything. The
other sole takes the wrench w (6,) over (force, then moment about the world origin; world axes):

    tau(q) = tau_g(q) - J(q)^T w          J (6, n): spatial Jacobian of the other sole, in the world
    dtau_j/dq_i = dtau_g,j/dq_i - (J_i x J_j) . w    for i before j on the chain to it, 0 elsewhere

The other sole always takes the part of the weight that `TaskTrajectory.load_left` plans for it.
Its load is zero as it lands or lifts, which single support is the limit of: tau is continuous.
What is left of w is chosen in one of two ways.

    shared    no horizontal force; both centres of pressure displaced alike, so that together they
              act below the CoM: the rule of `mgs.motion.dynamics`.
    optimal   min over w of 1/2 tau^T tau, both soles inside friction and rectangle. The derivative
              of the minimum is that at the minimiser held fixed, since no limit depends on q.

The wrench belongs to the reference (CoM and soles asked for), so that it does not vary with q.
Friction and rectangle of a sole bound its wrench by 16 half-spaces: Caron, Pham, Nakamura,
"Stability of surface contacts for humanoid robots", ICRA 2015.
"""

from __future__ import annotations

import functools
from typing import Literal

import daqp
import numpy as np

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.constants import FRICTION
from mgs.core.contact import Side
from mgs.core.geometry import rotations_from_quat_xyzw
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.motion.dynamics import share_wrench
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

Sharing = Literal["off", "shared", "optimal"]
N_CONE = 16  # half-spaces that bound the wrench of one sole
LEAST_LOAD = 1e-4  # share of the weight below which a sole is left the shared wrench
DAMPING = 1e-6  # of the free wrench components, in parts of the mean curvature
SOLVED, TOLERANCE = 1, 1e-9  # DAQP's exit flag and tolerance


class StaticLoads:
    """The static wrench on the sole that is not the root, at every sample.

    Attributes:
        wrench: (N, 6) force [N] and moment about the world origin [N m]; zero in single support.
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
        if not self.optimal:
            return
        load = self.wrench[:, 2] / self.weight
        self._free = (load > LEAST_LOAD) & (load < 1.0 - LEAST_LOAD)
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

        tau (n,) is due to gravity alone, J (6, n) is the spatial Jacobian of the sole.
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
    return share_wrench(total, com[:, :2], tasks.soles[..., :3], tasks.load_left)


def wrench_cones(robot: Robot, side: Side, tasks: TaskTrajectory, wrenches: Array) -> Array:
    """Rows U (N, 16, 6) with U w <= 0 for a wrench w about the world origin that one sole bears.

    Where the plan's share puts the centre of pressure beside the sole (the motion is too fast for
    statics) the rectangle is widened to hold it.
    """
    spec, poses, w = robot.sole_spec(side), tasks.soles[:, side], wrenches[:, side]
    R, p = rotations_from_quat_xyzw(poses[:, 3:]), poses[:, :3]
    load = np.maximum(w[:, 2], 1e-12)
    pressure = np.stack([-w[:, 4] / load, w[:, 3] / load, 0.0 * load], axis=1) - p
    local = np.abs(np.einsum("nji,nj->ni", R, pressure))  # R^T pressure
    x = np.maximum(0.5 * spec.length, local[:, 0])
    y = np.maximum(0.5 * spec.width, local[:, 1])
    # w_local = [R^T f; R^T (m - p x f)]
    to_local = np.zeros((len(p), 6, 6))
    to_local[:, :3, :3] = to_local[:, 3:, 3:] = R.transpose(0, 2, 1)
    to_local[:, 3:, :3] = -R.transpose(0, 2, 1) @ _skew(p)
    return _cone_of_rectangle(x, y, FRICTION) @ to_local


def _cone_of_rectangle(x: Array, y: Array, mu: float) -> Array:
    """Rows (N, 16, 6) for half lengths x and half widths y (N,), in the sole's frame."""
    U = np.zeros((len(x), N_CONE, 6))
    U[:, :4, 0], U[:, :4, 1] = [1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]
    U[:, :4, 2] = -mu
    U[:, 4:8, 3], U[:, 4:8, 4] = [1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]
    U[:, 4:6, 2], U[:, 6:8, 2] = -y[:, None], -x[:, None]
    row = 8
    for turn in (1.0, -1.0):  # the moment about the vertical, either way
        for a in (1.0, -1.0):
            for b in (1.0, -1.0):
                U[:, row, 0], U[:, row, 1] = a * y, b * x
                U[:, row, 2] = -mu * (x + y)
                U[:, row, 3], U[:, row, 4] = turn * a * mu, turn * b * mu
                U[:, row, 5] = turn
                row += 1
    return U


def _skew(p: Array) -> Array:
    """Matrices (..., 3, 3) of p x, for p (..., 3)."""
    S = np.zeros((*p.shape, 3))
    S[..., 0, 1], S[..., 0, 2], S[..., 1, 2] = -p[..., 2], p[..., 1], -p[..., 0]
    S[..., 1, 0], S[..., 2, 0], S[..., 2, 1] = p[..., 2], -p[..., 1], p[..., 0]
    return S


def motion_cross(wrench: Array) -> Array:
    """Matrices C (..., 6, 6) of w (..., 6) with C J_i = J_i x* w, the force cross product."""
    C = np.zeros((*wrench.shape[:-1], 6, 6))
    C[..., :3, 3:] = C[..., 3:, :3] = -_skew(wrench[..., :3])
    C[..., 3:, 3:] = -_skew(wrench[..., 3:])
    return C


def contact_derivative(J: Array, C: Array) -> Array:
    """Derivative of (J^T w)_j by q_i (..., n, n), first axis j; C = motion_cross(w)."""
    J_t = np.swapaxes(J, -1, -2)
    return np.asarray((J_t @ (C @ J)) * -_below_diagonal(J.shape[-1]))


@functools.cache
def _below_diagonal(n: int) -> Array:
    return np.tril(np.ones((n, n)), -1)


def loaded_gravity(
    tree: TreeTasks, loads: StaticLoads | None, k: int, q: Array
) -> tuple[Array, Array]:
    """Static torques (n,) [N m] at sample k and their derivative (n, n), in the tree's order.

    Without `loads`, as if the root carried everything.
    """
    tau, derivative = tree.gravity(q)
    if loads is None or not loads.loaded[k]:
        return tau, derivative
    J = tree.data.J * tree.on_chain
    wrench, C = loads.at(k, tau, J)
    return tau - np.dot(wrench, J), derivative - contact_derivative(J, C)
