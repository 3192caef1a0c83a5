"""The constraints of a repair near one motion, linear in the step, and the step that they allow.

Which inequalities count is found with the step itself: those that it would violate. Counting only
those that are violated before it would let a step run into others, such as a floor that a swing
sole skims, and no part of it would then be any better.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.judge.audit.body import Body
from mgs.search.repair.band import solve_blocks
from mgs.search.repair.constraints import Constraints
from mgs.search.repair.stances import Bools

PASSES = 4  # in which it is found which inequalities count
INEQUALITIES = ("floor", "range", "speed", "zmp")

Shifts = dict[str, Array]


class Linear:
    """Residuals with their shifts at a motion, and their Jacobians."""

    def __init__(self, constraints: Constraints, q: Array, body: Body, shifted: Shifts) -> None:
        self.shifted = shifted  # by name, residuals plus shifts
        stands = constraints.stances.stands
        jacobians = constraints.jacobians(q)
        n_samples = len(q)
        pose = np.where(stands[..., None, None], jacobians.soles, 0.0)
        self.pose = pose.reshape(n_samples, 12, -1)
        self.floor = -constraints.corner_jacobians(jacobians, body).reshape(n_samples, 8, -1)
        self.inner = np.arange(1, n_samples - 1)
        self.zmp = constraints.zmp_jacobians(jacobians, body, self.inner)
        self.normals = constraints.normals

    def pose_part(self, weight: float) -> tuple[Array, Array]:
        """Curvature (T, p, p) and gradient (T, p) of the soles that stand."""
        J = self.pose
        r = self.shifted["pose"].reshape(len(J), 1, 12)
        return weight * (J.transpose(0, 2, 1) @ J), weight * (r @ J)[:, 0]

    def step(self, blocks: Array, g: Array, weights: dict[str, float]) -> Array:
        """Step (T, p) that the inequalities allow, of the blocks (3, T, p, p) and gradient (T, p)
        of all the rest.
        """  # noqa: D205
        counts = {name: self.shifted[name] > 0.0 for name in INEQUALITIES}
        step = np.zeros_like(g)
        for _ in range(PASSES):
            A, b = blocks.copy(), g.copy()
            active = {name: np.where(counts[name], self.shifted[name], 0.0) for name in counts}
            self._add_floor(A, b, weights["floor"], counts["floor"], active["floor"])
            self._add_joints(A, b, weights, counts, active)
            self._add_zmp(A, b, weights["zmp"], counts["zmp"], active["zmp"])
            step = solve_blocks(A, -b)
            values = self.values(step)
            if all(np.array_equal(values[name] > 0.0, counts[name]) for name in counts):
                break
            counts = {name: values[name] > 0.0 for name in counts}
        return step

    def values(self, step: Array) -> Shifts:
        """Inequalities after a step (T, p)."""
        joints = step[:, FLOATING_BASE_NV:]
        stride = np.diff(joints, axis=0)
        moved = sum(
            Z @ step[self.inner + i, :, None] for i, Z in zip((-1, 0, 1), self.zmp, strict=True)
        )
        zmp = self.shifted["zmp"].copy()
        zmp[self.inner] += (self.normals[self.inner] @ moved)[..., 0]
        floor = (self.floor @ step[:, :, None]).reshape(-1, 2, 4)
        return {
            "floor": self.shifted["floor"] + floor,
            "range": self.shifted["range"] + np.stack([joints, -joints], axis=1),
            "speed": self.shifted["speed"] + np.stack([stride, -stride], axis=1),
            "zmp": zmp,
        }

    def _add_floor(self, A: Array, b: Array, weight: float, counts: Bools, active: Array) -> None:
        low = np.flatnonzero(counts.any(axis=(1, 2)))
        if len(low):
            C = np.where(counts[low].reshape(-1, 8, 1), self.floor[low], 0.0)
            A[0][low] += weight * (C.transpose(0, 2, 1) @ C)
            b[low] += weight * (active[low].reshape(-1, 1, 8) @ C)[:, 0]

    def _add_joints(
        self,
        A: Array,
        b: Array,
        weights: dict[str, float],
        counts: dict[str, Bools],
        active: Shifts,
    ) -> None:
        joints = np.arange(FLOATING_BASE_NV, b.shape[1])
        weight = weights["range"]
        b[:, joints] += weight * (active["range"][:, 0] - active["range"][:, 1])
        A[0][:, joints, joints] += weight * counts["range"].any(axis=1)
        weight = weights["speed"]
        push = weight * (active["speed"][:, 0] - active["speed"][:, 1])
        b[1:, joints] += push
        b[:-1, joints] -= push
        on = weight * counts["speed"].any(axis=1)
        A[0][1:, joints, joints] += on
        A[0][:-1, joints, joints] += on
        A[1][:-1, joints, joints] -= on

    def _add_zmp(self, A: Array, b: Array, weight: float, counts: Bools, active: Array) -> None:
        rows = np.flatnonzero(counts[self.inner].any(axis=1))
        if not len(rows):
            return
        k = self.inner[rows]
        n = np.where(counts[k, :, None], self.normals[k], 0.0)
        G = weight * (n.transpose(0, 2, 1) @ n)  # (m, 2, 2)
        pull = weight * (active[k, None] @ n)  # (m, 1, 2)
        Z = [part[rows] for part in self.zmp]
        for i in (-1, 0, 1):
            b[k + i] += (pull @ Z[i + 1])[:, 0]
            left = Z[i + 1].transpose(0, 2, 1) @ G
            for j in range(-1, i + 1):
                A[i - j][k + j] += left @ Z[j + 1]
