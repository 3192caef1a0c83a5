"""The few unknowns of a step in which the dynamics and the places of the soles always hold.

Soles in place leave a change of configuration dq_k (6 + n) as many unknowns y_k as the null space
of their Jacobians has dimensions. The dynamics of the base give the wrenches, of which only double
support leaves a part s_k (6) free, by which the soles press against each other. The dynamics of
the joints give the torques:

    dq_k = Z_k y_k
    w_k  = w0_k + sum_d W_kd y_k+d + N_k s_k
    tau_k = t0_k + sum_d T_kd y_k+d + S_k s_k      d = -1, 0, 1

Wrenches are in units of m g and m g L here, torques in m g L.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import GRAVITY
from mgs.search.whole_body.dynamics import BASE, JOINTS, Point, Slopes
from mgs.search.whole_body.problem import Problem

N_SOLES = 12  # coordinates of both soles, and entries of their wrenches
N_PRESS = 6  # of the wrenches by which the soles press against each other


@dataclass(frozen=True, eq=False)
class Affine:
    """Rows of each sample that are affine in the unknowns."""

    constant: Array  # (T, r)
    by_moves: Array  # (3, T, r, ny) by y_k-1, y_k and y_k+1
    by_press: Array  # (T, r, 6) by s_k, 0 in single support

    def times(self, rows: Array) -> Affine:
        """The rows (T, q, r) or (q, r) times these."""
        constant = (rows @ self.constant[..., None])[..., 0]
        return Affine(constant, rows @ self.by_moves, rows @ self.by_press)

    def of(self, samples: NDArray[np.intp], rows: slice) -> Affine:
        """Some rows of some samples."""
        return Affine(
            self.constant[samples, rows], self.by_moves[:, samples, rows],
            self.by_press[samples, rows],
        )  # fmt: skip

    def at(self, y: Array, s: Array) -> Array:
        """Values (T, r) for moves y (T, ny) and forces s (T, 6)."""
        y = np.pad(y, ((1, 1), (0, 0)))[..., None]
        found = self.constant[..., None] + self.by_press @ s[..., None]
        for d in range(3):
            found += self.by_moves[d] @ y[d : d + len(found)]
        return np.asarray(found[..., 0])


@dataclass(frozen=True, eq=False)
class Moves:
    """The changes of configuration that leave the soles in place: dq_k = Z_k y_k."""

    moving: NDArray[np.intp]  # coordinates of the base and of joints that move the soles
    free: NDArray[np.intp]  # joints that do not, each of which is an unknown itself
    turn: Array  # (T, len(moving), n_turn), orthonormal: part of Z for the others

    @property
    def n_turn(self) -> int:
        """Number of unknowns for `moving`; those for `free` follow."""
        return self.turn.shape[2]

    @property
    def count(self) -> int:
        """Number ny of unknowns of a sample."""
        return self.n_turn + len(self.free)

    def rows(self, by_change: Array, samples: slice | NDArray[np.intp] = slice(None)) -> Array:
        """Rows (m, r, ny) by y, from rows (m, r, 6 + n) by dq, of some of the samples."""
        turned = by_change[..., self.moving] @ self.turn[samples]
        return np.concatenate([turned, by_change[..., self.free]], axis=-1)

    def changes(self, y: Array) -> Array:
        """The changes dq (T, 6 + n) of the unknowns y (T, ny)."""
        dq = np.empty((len(y), len(self.moving) + len(self.free)))
        dq[:, self.moving] = (self.turn @ y[:, : self.n_turn, None])[..., 0]
        dq[:, self.free] = y[:, self.n_turn :]
        return dq


@dataclass(frozen=True, eq=False)
class Unknowns:
    """How changes, wrenches and torques follow from the unknowns of a step."""

    moves: Moves
    wrench: Affine  # r = 12
    torque: Affine  # r = n
    wrench_units: Array  # (12,) [N] and [N m]


def unknowns_of(problem: Problem, point: Point, slopes: Slopes) -> Unknowns:
    """The unknowns of a step from a point."""
    n_samples, unit = problem.n_samples, problem.robot.mass * GRAVITY * problem.leg
    J = slopes.soles.reshape(n_samples, N_SOLES, problem.nv)
    is_moved = np.any(J, axis=(0, 1))
    part = Moves(np.flatnonzero(is_moved), np.flatnonzero(~is_moved), _null_space(J[..., is_moved]))
    asked = np.zeros((3, n_samples, problem.nv, part.count))  # of forces on base and joints
    asked[0, 1:] = part.rows(slopes.force[0, 1:], slice(0, -1))
    asked[1] = part.rows(slopes.force[1])
    asked[2, :-1] = part.rows(slopes.force[2, :-1], slice(1, None))
    bearing = np.repeat(problem.bears, 6, axis=1)[..., None] * J  # (T, 12, 6 + n)
    given = point.force + (point.w.reshape(n_samples, 1, N_SOLES) @ bearing)[:, 0]
    units = np.tile(np.repeat([1.0, problem.leg], 3), 2) * problem.robot.mass * GRAVITY
    bearing = bearing.transpose(0, 2, 1) * units  # (T, 6 + n, 12)
    on_base, on_joints = bearing[:, BASE], bearing[:, JOINTS]
    gram = on_base @ on_base.transpose(0, 2, 1)
    inverse = np.linalg.solve(gram, on_base).transpose(0, 2, 1)  # (T, 12, 6), the least wrenches
    press = np.zeros((n_samples, N_SOLES, N_PRESS))
    both = problem.bears.all(axis=1)
    press[both] = _null_space(on_base[both])
    wrench = Affine(
        (inverse @ given[:, BASE, None])[..., 0], inverse @ asked[:, :, BASE], press
    )  # fmt: skip
    borne = wrench.times(on_joints)
    torque = Affine(
        (given[:, JOINTS] - borne.constant) / unit,
        (asked[:, :, JOINTS] - borne.by_moves) / unit,
        -borne.by_press / unit,
    )
    return Unknowns(part, wrench, torque, units)


def _null_space(rows: Array) -> Array:
    """Orthonormal bases (T, c, c - r) of the null spaces of rows (T, r, c) of full rank."""
    return np.linalg.qr(rows.transpose(0, 2, 1), mode="complete")[0][..., rows.shape[1] :]
