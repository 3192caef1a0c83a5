"""The CoM motion of least jerk whose ZMP keeps a margin to the edge of the support polygon.

After Wieber, "Trajectory free linear model predictive control for stable walking in the presence
of strong perturbations", Humanoids 2006, here over the whole motion at once and from rest to rest.
Cart-table model of both horizontal axes, jerk u held over dt, in the unit 1 / omega of time, with
omega^2 = g / com_height and theta = omega dt:

    min  sum_k |p[k] - p_ref[k]|^2 + R / Q_e |u[k]|^2
    s.t. v[k+1] = v[k] + theta (a[k] + a[k+1]) / 2               a[k+1] - a[k] = theta u[k]
         c[k+1] = c[k] + theta v[k] + theta^2 (2 a[k] + a[k+1]) / 6       p[k] = c[k] - a[k]
         n_i . p[k] <= n_i . corner_i - margin                   at each edge i of the polygon

In single support the polygon is the sole, in double support the hull of both, whose slanting edges
couple the axes. Unknowns are (c, v, a) of every sample, so that all matrices are block banded.

Solved by PIQP, a sparse interior-point method (Schwan, Jiang, Kuhn, Jones, CDC 2023), chosen by
measurement on these problems (docs/benchmarks.md).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import piqp
import scipy.sparse as sp

from mgs.com_generator.com_trajectory import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.constants import GRAVITY
from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError, ZmpMarginError
from mgs.gait import ComParameters
from mgs.robot import Robot
from mgs.robot.support_polygon import support_polygon, support_spans
from mgs.trajectory_planner import TaskTrajectory

MARGIN = 0.25  # in widths of a sole: half of the way from the edge to the middle
PRECISION = 1e-10  # of the solver, absolute and relative
TOLERANCE = 1e-7  # [m] that a solution may miss bounds and equalities by
LEAST_ADVISED = 2e-4  # [m]; with a narrower margin something else is wrong with the gait
PLACE, SPEED, ACCELERATION = range(3)


@dataclass(frozen=True, eq=False)
class Qp:
    """Minimise 1/2 x^T P x + q^T x subject to A x = b and G x <= h."""

    P: sp.csc_matrix
    q: Array
    A: sp.csc_matrix
    b: Array
    G: sp.csc_matrix
    h: Array


@dataclass(frozen=True)
class BoundedZmp:
    """The generator `qp`."""

    parameters: ComParameters

    @classmethod
    def from_parameters(cls, parameters: ComParameters) -> BoundedZmp:
        """Generator with the tuning of a gait file."""
        return cls(parameters)

    def generate(self, robot: Robot, tasks: TaskTrajectory) -> ComTrajectory:
        """CoM motion that keeps the ZMP inside; see `bound_zmp` for the errors."""
        return bound_zmp(robot, tasks, self.parameters)


def bound_zmp(robot: Robot, tasks: TaskTrajectory, parameters: ComParameters) -> ComTrajectory:
    """CoM motion from rest to rest that keeps the ZMP inside, near tasks.zmp_ref.

    Raises:
        ConfigError: the weights are too far from each other.
        ZmpMarginError: no motion keeps the margin; names the time and the widest possible one.
    """
    height, start = tasks.com_height, tasks.zmp_ref[0]
    omega = float(np.sqrt(GRAVITY / height[0]))
    ratio = parameters.weight_jerk / parameters.weight_error
    margin = default_margin(robot) if parameters.margin is None else parameters.margin
    problem = _problem(robot, tasks, omega, ratio, margin)
    x = _solve(problem)
    if x is None:
        raise _refusal(problem, tasks, parameters, margin)
    c, v, a = x.reshape(len(height), 3, 2).transpose(1, 0, 2)
    speed = np.gradient(height, tasks.dt)
    return ComTrajectory(
        position=np.column_stack([start + c, height]),
        velocity=np.column_stack([omega * v, speed]),
        acceleration=np.column_stack([omega**2 * a, np.gradient(speed, tasks.dt)]),
        zmp=start + c - a,
    )


def default_margin(robot: Robot) -> float:
    """Distance of the ZMP from the edge of the support polygon where the gait gives none [m]."""
    soles = [robot.sole_spec(side) for side in Side]
    return MARGIN * min(min(sole.length, sole.width) for sole in soles)


def support_half_planes(robot: Robot, tasks: TaskTrajectory) -> list[tuple[slice, Array, Array]]:
    """Samples, outward normals (m, 2) and offsets (m,): inside is normals @ zmp <= offsets."""
    half_planes = []
    for span in support_spans(robot, tasks.soles, tasks.support):
        polygon = support_polygon(robot, tasks.soles[span.start], span.support, span.bears)
        along = np.roll(polygon, -1, axis=0) - polygon
        normals = np.column_stack([along[:, 1], -along[:, 0]])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        samples = slice(span.start, span.end)
        half_planes.append((samples, normals, np.sum(normals * polygon, axis=1)))
    return half_planes


def _problem(robot: Robot, tasks: TaskTrajectory, omega: float, ratio: float, margin: float) -> Qp:
    """The QP in places seen from the first ZMP."""
    n, theta = tasks.n_samples, omega * tasks.dt
    now, following = sp.eye(n - 1, n), sp.eye(n - 1, n, k=1)
    ends = sp.csr_matrix(([1.0, 1.0], ([0, 1], [0, n - 1])), shape=(2, n))
    zmp_ref = tasks.zmp_ref - tasks.zmp_ref[0]
    c, v, a = PLACE, SPEED, ACCELERATION
    change = _rows(following - now, a)
    A = sp.vstack(
        [
            _rows(following - now, v) - 0.5 * theta * _rows(now + following, a),
            _rows(following - now, c)
            - theta * _rows(now, v)
            - theta**2 / 6.0 * _rows(2.0 * now + following, a),
            *(_rows(ends, quantity) for quantity in (c, v, a)),
        ],
        format="csc",
    )
    rest = np.concatenate([zmp_ref[[0, -1]].ravel(), np.zeros(8)])
    zmp = _rows(sp.eye(n), c) - _rows(sp.eye(n), a)
    half_planes = support_half_planes(robot, tasks)
    normals = sp.block_diag(
        [sp.kron(sp.eye(span.stop - span.start), edges) for span, edges, _ in half_planes]
    )
    inside = [
        np.tile(offsets - edges @ tasks.zmp_ref[0] - margin, span.stop - span.start)
        for span, edges, offsets in half_planes
    ]
    return Qp(
        P=sp.csc_matrix(zmp.T @ zmp + ratio * (omega**3 / theta) ** 2 * (change.T @ change)),
        q=-(zmp.T @ zmp_ref.ravel()),
        A=A,
        b=np.concatenate([np.zeros(4 * (n - 1)), rest]),
        G=sp.csc_matrix(normals @ zmp),
        h=np.concatenate(inside),
    )


def _rows(over_time: sp.spmatrix, quantity: int) -> sp.csc_matrix:
    """A map (m, N) over time, applied to one quantity of both axes: (2 m, 6 N)."""
    pick = sp.csr_matrix(([1.0], ([0], [quantity])), shape=(1, 3))
    return sp.kron(sp.kron(over_time, pick), sp.eye(2), format="csc")


def _solve(problem: Qp) -> Array | None:
    """Minimiser that holds bounds and equalities to TOLERANCE; None where none is found."""
    solver = piqp.SparseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = PRECISION
    solver.setup(problem.P, problem.q, problem.A, problem.b, problem.G, None, problem.h)
    status = solver.solve()
    x = np.array(solver.result.x)
    if status != piqp.PIQP_SOLVED or not np.all(np.isfinite(x)):
        return None
    missed = max(np.abs(problem.A @ x - problem.b).max(), (problem.G @ x - problem.h).max())
    return x if missed <= TOLERANCE else None


def _refusal(
    problem: Qp, tasks: TaskTrajectory, parameters: ComParameters, margin: float
) -> ConfigError | ZmpMarginError:
    """Why there is no solution, from the motion whose ZMP leaves the bounds least."""
    n = problem.P.shape[0]
    faint = 1e-6  # of the old objective, so that the new one has a single minimiser
    shortfall = np.append(np.zeros(n), 1.0)
    relaxed = Qp(
        P=sp.block_diag([faint * problem.P, sp.csc_matrix((1, 1))], format="csc"),
        q=faint * np.append(problem.q, 0.0) + shortfall,
        A=sp.hstack([problem.A, sp.csc_matrix((len(problem.b), 1))], format="csc"),
        b=problem.b,
        G=sp.hstack([problem.G, np.full((len(problem.h), 1), -1.0)], format="csc"),
        h=problem.h,
    )
    x = _solve(relaxed)
    if x is None or x[-1] <= TOLERANCE:
        return ConfigError(
            "com",
            f"no solution with weight_error = {parameters.weight_error:g} and weight_jerk = "
            f"{parameters.weight_jerk:g}; usual values are 1 and 1e-8 to 1e-4",
        )
    excess = problem.G @ x[:-1] - problem.h
    row = int(np.argmax(excess > x[-1] - 10.0 * TOLERANCE))
    k = int(problem.G.tocsr()[row].indices.min()) // 6  # six unknowns a sample
    widest = margin - float(x[-1])
    support = Support(tasks.support[k]).label
    error = ZmpMarginError(k * tasks.dt, support, margin, widest)
    if widest > LEAST_ADVISED:
        error.remedy = f"use a com.margin of at most {np.floor(1e4 * widest - 1.0) / 1e4:.4f} m"
    return error
