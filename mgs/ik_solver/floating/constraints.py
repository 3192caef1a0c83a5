"""Soles as constraints of a floating base: what they determine and when they change.

Conditions (2), (3) and eq. (10) of M. Mistry, J. Nakanishi, G. Cheng and S. Schaal, "Inverse
kinematics with floating base and constraints for full body humanoid robot control", Humanoids 2008.
J_C (k, 6 + n) is the Jacobian of the constraints, J_C^b (k, 6) its base part, J_C^r the rest.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError
from mgs.core.geometry import quintic
from mgs.core.spans import spans
from mgs.ik_solver.floating.parts import SOLES, Part
from mgs.ik_solver.floating.priority_levels import PriorityLevels
from mgs.ik_solver.floating.tasks import BodyTasks

LAG = 0.01  # [m] and [rad], task error at which a level counts as in full conflict
RANK_TOLERANCE = 1e-6  # smallest singular value that counts, relative to the largest


def feasibility(J_C: Array) -> tuple[int, int]:
    """Ranks of constraints J_C (k, 6 + n) and of their base part.

    Tasks can be controlled where the first rank is k and the second rank is 6. A smaller first rank
    means an over-constrained robot, a smaller second rank an under-constrained one.
    """
    return rank_of(J_C), rank_of(J_C[:, :FLOATING_BASE_NV])


def rank_of(J: Array) -> int:
    """Rank of a Jacobian (k, nv)."""
    values = np.linalg.svd(J, compute_uv=False)
    return int(np.sum(values > RANK_TOLERANCE * values[0])) if len(values) else 0


def base_velocity(J_C: Array, qdot_r: Array) -> Array:
    """Base twist (6,) in the base frame for joint velocities qdot_r (n,) under J_C qdot = 0.

    Eq. (10): -(J_C^b)^+ J_C^r qdot_r.

    Raises:
        numpy.linalg.LinAlgError: the constraints leave the base free.
    """
    J_b, J_r = J_C[:, :FLOATING_BASE_NV], J_C[:, FLOATING_BASE_NV:]
    if rank_of(J_b) < FLOATING_BASE_NV:
        raise np.linalg.LinAlgError("under-constrained: the base can move while the joints rest")
    return -np.asarray(np.linalg.lstsq(J_b, J_r @ qdot_r, rcond=None)[0])


def refuse_infeasible(t: float, J_C: Array, J_A: Array) -> tuple[int, int, int]:
    """Ranks of J_C, of its base part and of J_A.

    Args:
        t: time at which the constraints begin [s].
        J_C: rows of the constraints (k, 6 + n).
        J_A: rows of all critical tasks (m, 6 + n).

    Raises:
        ConfigError: the ranks do not suffice to control the tasks.
    """
    rank, base_rank = feasibility(J_C)
    critical_rank = rank_of(J_A)
    if base_rank < FLOATING_BASE_NV:
        problem = (
            f"under-constrained: {len(J_C)} constraint rows hold {base_rank} of the base's "
            f"{FLOATING_BASE_NV} degrees of freedom; more contacts are needed"
        )
    elif rank < len(J_C):
        problem = (
            f"over-constrained: {len(J_C)} constraint rows have rank {rank}; the legs lack joints, "
            "or stand at a singularity"
        )
    elif critical_rank < len(J_A):
        problem = (
            f"over-constrained: {len(J_A)} critical rows have rank {critical_rank}; move tasks to "
            "functional or extraneous"
        )
    else:
        return rank, base_rank, critical_rank
    raise ConfigError("ik.prioritized.critical", f"the phase from t = {t:.3f} s is {problem}")


def handover_profile(support: NDArray[np.int8], dt: float, handover: float) -> Array:
    """Factor (N,): 0 where both soles are constraints, 1 where only the support sole is one.

    It rises after lift-off and falls before landing, over `handover` [s] or half the phase.
    """
    factor = np.zeros(len(support))
    for start, end in spans(support):
        if support[start] != Support.DOUBLE:
            k = np.arange(start, end)
            samples = min(handover / dt, 0.5 * (end - start))
            inside = np.minimum(k - start, end - k)
            factor[start:end] = quintic(inside / samples) if samples >= 1.0 else 1.0
    return factor


class ConstraintSet:
    """The levels of tasks while the soles of one kind of support are constraints.

    Attributes:
        critical: (m,) rows of the tasks in level A.
        index: (m,) rows of all tasks, in the order of the levels.
        rows: rows of the levels A, B and E in that order.
    """

    def __init__(
        self,
        tasks: BodyTasks,
        levels: Sequence[Sequence[Part]],
        projected: bool,
        size: float,
        swing: Side | None = None,
    ) -> None:
        critical, functional, extraneous = (list(level) for level in levels)
        if swing is not None:
            critical.remove(SOLES[swing])
            functional.insert(0, SOLES[swing])
        every = np.arange(tasks.m)
        chosen = [
            np.concatenate([every[:0], *(every[tasks.rows[part]] for part in level)])
            for level in (critical, functional, extraneous)
        ]
        self.index = np.concatenate(chosen)
        self.critical = chosen[0]
        nv = tasks.J.shape[1]
        ends = np.cumsum([0, *map(len, chosen)]).tolist()
        self.rows = [slice(start, stop) for start, stop in itertools.pairwise(ends)]
        self.levels = PriorityLevels([len(rows) for rows in chosen], nv, size, projected)
        self.J = np.empty((tasks.m, nv))
        self.rates, self.error = np.empty(tasks.m), np.empty(tasks.m)

    def solve(
        self, J: Array, rates: Array, error: Array, free: Array, bound: float, least: float
    ) -> Array:
        """Solution (6 + n,) for rows in the order of `BodyTasks`; see `PriorityLevels.solve`.

        The lag of a level grows with the square of its error and is never below `least`.
        """
        np.take(J, self.index, axis=0, out=self.J, mode="clip")
        np.take(rates, self.index, out=self.rates, mode="clip")
        np.take(error, self.index, out=self.error, mode="clip")
        np.abs(self.error, out=self.error)
        lags = [float(self.error[rows].max(initial=0.0)) / LAG for rows in self.levels.rows]
        behind = [min(1.0, max(lag * lag, least)) for lag in lags]
        return self.levels.solve(self.J, self.rates, free, bound, behind)
