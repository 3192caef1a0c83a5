"""Tasks below those of the support tree: the torso, and below it the angular momentum.

Each is met in the null space of what is above it, and only as far as that leaves room.

The moment about the vertical that friction has to give to a walking robot is close to the rate of
its angular momentum about the vertical through the CoM: the ground force of a balanced robot points
from the ZMP almost to the CoM. With a (n,) the row of the centroidal momentum matrix for that axis
(D. Orin, A. Goswami and S.-H. Lee, "Centroidal dynamics of a humanoid robot", Autonomous Robots 35,
2013), scaled to length 1, and N the projector on the null space of all tasks above,

    dq <- dq - gamma (a dq) b / (b b^T + damping^2),   b = a N

takes the part gamma of it away. Where the hands are free, this swings the arms against the legs.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.ik_solver.tree.least_norm import LeastNorm
from mgs.ik_solver.tree.targets import TorsoMode, torso_targets
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

TORSO_DAMPING = 0.02  # of the torso's Jacobian in the null space, whose singular values are about 1
TORSO_SPEED = 1.0  # [rad/s] at which an orientation that was out of reach is recovered
MOMENTUM_DAMPING = 0.1  # of the unit row a in the null space
WEIGHT = 5.0  # of the rows of these tasks against the joints' where joints are held at limits
EYE = np.eye(3)


class LowerTasks:
    """The lower tasks of one motion.

    Attributes:
        targets: rotations (N, 3, 3) of the torso; None: it is free.
    """

    def __init__(
        self, robot: Robot, tasks: TaskTrajectory, torso: TorsoMode, gamma_momentum: float
    ) -> None:
        self.targets = torso_targets(robot, tasks, torso)
        self._gamma = gamma_momentum
        self._stride = TORSO_SPEED * tasks.dt
        self._row: Array | None = None  # a at the last sample

    def __bool__(self) -> bool:
        """Whether there is any lower task."""
        return self.targets is not None or self._gamma > 0.0

    def add(self, tree: TreeTasks, solver: LeastNorm, dq: Array, q: Array, k: int) -> Array:
        """The joint step dq (n,) that `solver` found at q (n,) and sample k, with these tasks."""
        J_torso = None
        if self.targets is not None:
            J_torso, turn = tree.torso_error(self.targets[k])
            if turn.dot(turn) > self._stride**2:  # full steps back from far away would overshoot
                turn *= self._stride / np.sqrt(turn.dot(turn))
            dq = solver.add_below(dq, J_torso, turn, TORSO_DAMPING)
        if self._gamma:
            dq = self._less_momentum(tree, solver, dq, q, J_torso)
        return dq

    def turn_torso(self, tree: TreeTasks, solver: LeastNorm, dq: Array) -> Array:
        """The joint step dq (n,) at the first sample, with the whole turn of the torso."""
        if self.targets is None:
            return dq
        return solver.add_below(dq, *tree.torso_error(self.targets[0]), TORSO_DAMPING)

    def rows(self, tree: TreeTasks) -> Array | None:
        """Weighted Jacobian (l, n) of these tasks; None: there are none."""
        found = [] if self.targets is None else [tree.torso_error(EYE)[0]]
        if self._row is not None:
            found.append(self._row[None])
        return WEIGHT * np.concatenate(found) if found else None

    def _less_momentum(
        self, tree: TreeTasks, solver: LeastNorm, dq: Array, q: Array, J_torso: Array | None
    ) -> Array:
        """The joint step dq (n,) with the part gamma of its angular momentum taken away."""
        row = tree.yaw_momentum(q)
        self._row = row = row / np.linalg.norm(row)
        free = solver.project(row[None])[0]
        if J_torso is not None:
            B = solver.project(J_torso)
            A = B.dot(B.T) + TORSO_DAMPING**2 * EYE
            free = free - np.linalg.solve(A, B.dot(free)).dot(B)
        scale = free.dot(free) + MOMENTUM_DAMPING**2
        return np.asarray(dq - self._gamma * row.dot(dq) / scale * free)
