"""Tree tasks and static torques of a whole motion at once, in the order of the robot's joints.

Pinocchio is called once per sample and quantity; its results are collected in arrays (N, ...) and
processed there. While both soles stand on the ground, the tasks of either tree describe the same
postures, so that nothing outside this module depends on the root.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.spans import spans
from mgs.ik_solver.rotations import rotation_vectors
from mgs.ik_solver.tree.static_loads import StaticLoads, contact_derivative, loaded_gravity
from mgs.ik_solver.tree.targets import tree_targets
from mgs.ik_solver.tree.tasks import N_POSITIONS, N_TASKS, TURN, TreeTasks
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory


class TreeBatch:
    """Tasks and torques of N samples.

    Attributes:
        rows: (15,) mask of the m rows of tasks that have a reference.
    """

    def __init__(
        self,
        robot: Robot,
        tasks: TaskTrajectory,
        com: ComTrajectory,
        loads: StaticLoads | None,
    ) -> None:
        self.tasks, self.loads = tasks, loads
        self.n, self.n_samples = robot.n, tasks.n_samples
        asked = tasks.hands_asked
        self.trees = tuple(TreeTasks(robot, side, asked) for side in Side)
        self.spans = spans(tasks.root)
        targets = [tree_targets(tasks, com.position, *span) for span in self.spans]
        self.positions = np.nan_to_num(np.concatenate([x for x, _ in targets]))
        self.rotations = np.concatenate([R for _, R in targets])
        self.rows = np.ones(N_TASKS, dtype=bool)
        for free in self.trees[0].free_rows:
            self.rows[free] = False

    def _stand(self, start: int) -> TreeTasks:
        root = self.tasks.root[start]
        tree = self.trees[root]
        tree.place(pin.XYZQUATToSE3(self.tasks.soles[start, root]))
        return tree

    def errors_at(self, q: Array) -> Array:
        """Target minus actual (N, m) at joint angles q (N, n)."""
        f, R = np.empty((self.n_samples, N_POSITIONS)), np.empty((self.n_samples, 3, 3))
        for start, end in self.spans:
            tree = self._stand(start)
            q_tree = q[start:end, tree.order]
            for i in range(end - start):
                tree.values(q_tree[i], f[start + i], R[start + i])
        return self._errors(f, R)

    def tasks_at(self, q: Array) -> tuple[Array, Array]:
        """Target minus actual (N, m) and task Jacobians (N, m, n) at joint angles q (N, n)."""
        f, R = np.empty((self.n_samples, N_POSITIONS)), np.empty((self.n_samples, 3, 3))
        J = np.zeros((self.n_samples, N_TASKS, self.n))  # and 0 in the columns of followers
        for start, end in self.spans:
            tree = self._stand(start)
            q_tree = q[start:end, tree.order]
            J_tree = np.empty((end - start, N_TASKS, len(tree.order)))
            for i in range(end - start):
                tree.update(q_tree[i])
                J_tree[i], f[start + i], R[start + i] = tree.J, tree.f, tree.R
            J[start:end, :, tree.order] = J_tree
        return self._errors(f, R), J[:, self.rows]

    def _errors(self, f: Array, R: Array) -> Array:
        error = np.empty((self.n_samples, N_TASKS))
        np.subtract(self.positions, f, out=error[:, :N_POSITIONS])
        error[:, TURN] = rotation_vectors(self.rotations @ R.transpose(0, 2, 1))
        return error[:, self.rows]

    def torques_at(self, q: Array) -> tuple[Array, Array]:
        """Static torques tau (N, n) [N m] and dtau/dq (N, n, n) at joint angles q (N, n)."""
        tau, dtau = np.empty((self.n_samples, self.n)), np.empty((self.n_samples, self.n, self.n))
        for start, end in self.spans:
            tree = self._stand(start)
            here = self._torques_of_span(tree, q[start:end, tree.order], start)
            tau[start:end, tree.order] = here[0]
            dtau[start:end, tree.order[:, None], tree.order] = here[1]
        return tau, dtau

    def _torques_of_span(self, tree: TreeTasks, q: Array, start: int) -> tuple[Array, Array]:
        loads, m, n = self.loads, len(q), self.n
        tau, dtau = np.empty((m, n)), np.empty((m, n, n))
        if loads is None or loads.optimal:
            for i in range(m):
                tau[i], dtau[i] = loaded_gravity(tree, loads, start + i, q[i])
            return tau, dtau
        J = np.empty((m, 6, n))
        for i in range(m):
            tau[i], dtau[i] = tree.gravity(q[i])
            J[i] = tree.data.J
        loaded, chain = np.flatnonzero(loads.loaded[start : start + m]), tree.chain
        J = J[loaded[:, None, None], np.arange(6)[:, None], chain]
        at = loaded[:, None]
        tau[at, chain] -= (loads.wrench[start + loaded, None] @ J)[:, 0]
        product = J.transpose(0, 2, 1) @ (loads.cross[start + loaded] @ J)
        dtau[at[..., None], chain[:, None], chain] -= contact_derivative(product)
        return tau, dtau
