"""Speed of QP solvers, called from Python, on the quadratic programs of ik4.

python benchmarks/qp_solvers.py         output as a Markdown table
python benchmarks/qp_solvers.py --json  output as one JSON object

Every quadratic program of one run of ik4 with three iterations is recorded, on a squat of the legs
of COMAN whose CoM reference is out of reach. Each program is then solved without warm start by
DAQP, as in mgs, and by quadprog, ProxQP and OSQP if they are installed (the wheel of eiquadprog
has no Python module). A time includes the conversion to the form of the solver; it is the minimum
of several measurements.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.metadata
import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any
from unittest import mock

import numpy as np
from spread import spread
from tables import table

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.experiments.faraji.runs import PAPER, STRETCHED
from mgs.gait import load_gait
from mgs.ik_solver import hard_soft
from mgs.ik_solver.qp import BoundedQp
from mgs.pipeline import run_stages
from mgs.robot import load_robot

ROBOT, GAIT = "coman_legs", "coman_legs/squat_stretched"
ASSIGNMENTS = (
    *PAPER[STRETCHED],
    "ik.iterations=3",
    "ik.solver=ik4",
    "ik.on_limit=record",
    "balance.duration=5.0",
)
MEET = 1e-6  # largest violation of a solution that is compared by cost
OSQP_TOLERANCE, OSQP_ITERATIONS = 1e-7, 4000
PROXQP_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Problem:
    """min 1/2 x^T H x + g^T x  s.t.  A x = b, low <= x_joints <= high."""

    H: Array
    g: Array
    A: Array
    b: Array
    low: Array
    high: Array

    def violation(self, x: Array) -> float:
        """Largest violation of equalities and bounds [m] or [rad]."""
        joints = x[FLOATING_BASE_NV:]
        rows = (np.abs(self.A @ x - self.b), self.low - joints, joints - self.high)
        return float(max(row.max(initial=0.0) for row in rows))

    def cost(self, x: Array) -> float:
        """Objective function."""
        return float(0.5 * x @ self.H @ x + self.g @ x)


Solve = Callable[[Problem], Array]


class RecordingQp(BoundedQp):
    """BoundedQp that records copies of its problems."""

    problems: list[Problem]

    def solve(self, H: Array, g: Array, A: Array, b: Array) -> Array:
        """Solve as `BoundedQp.solve`, and record the problem if it has a solution."""
        problem = Problem(H.copy(), g.copy(), A.copy(), b.copy(), self.low.copy(), self.high.copy())
        x = super().solve(H, g, A, b)
        if not self.elastic:
            self.problems.append(problem)
        return x


def record() -> list[Problem]:
    """All problems of one run, including those of its start."""
    problems: list[Problem] = []
    kind = type("Recording", (RecordingQp,), {"problems": problems})
    with mock.patch.object(hard_soft, "BoundedQp", kind):
        run_stages(load_robot(ROBOT), load_gait(GAIT, ASSIGNMENTS))
    return problems


# --- solvers ----------------------------------------------------------------------------------


def _daqp(_: ModuleType, first: Problem) -> Solve:
    qp = BoundedQp(len(first.g), len(first.b))

    def solve(p: Problem) -> Array:
        qp.low[:], qp.high[:] = p.low, p.high
        x = qp.solve(p.H, p.g, p.A, p.b)
        if qp.elastic:
            raise ArithmeticError("not solved")
        return x

    return solve


def _quadprog(module: ModuleType, first: Problem) -> Solve:
    n, m = len(first.g), len(first.b)
    joints = np.eye(n)[:, FLOATING_BASE_NV:]
    C = np.empty((n, m + 2 * joints.shape[1]))
    C[:, m:] = np.hstack([joints, -joints])

    def solve(p: Problem) -> Array:
        C[:, :m] = p.A.T
        right = np.concatenate([p.b, p.low, -p.high])
        return np.asarray(module.solve_qp(p.H, -p.g, C, right, m)[0])

    return solve


def _proxqp(module: ModuleType, first: Problem) -> Solve:
    n, m = len(first.g), len(first.b)
    low, high = np.full(n, -1e20), np.full(n, 1e20)
    qp = module.proxqp.dense.QP(n, m, 0, True)
    qp.settings.eps_abs = PROXQP_TOLERANCE
    qp.settings.initial_guess = module.proxqp.NO_INITIAL_GUESS

    def solve(p: Problem) -> Array:
        low[FLOATING_BASE_NV:], high[FLOATING_BASE_NV:] = p.low, p.high
        qp.init(p.H, p.g, p.A, p.b, None, None, None, low, high)
        qp.solve()
        return np.array(qp.results.x)

    return solve


def _osqp(module: ModuleType, first: Problem) -> Solve:
    sparse = importlib.import_module("scipy.sparse")
    joints = np.eye(len(first.g))[FLOATING_BASE_NV:]

    def solve(p: Problem) -> Array:
        qp = module.OSQP()
        qp.setup(
            P=sparse.csc_matrix(np.triu(p.H)),
            q=p.g,
            A=sparse.csc_matrix(np.vstack([p.A, joints])),
            l=np.concatenate([p.b, p.low]),
            u=np.concatenate([p.b, p.high]),
            verbose=False,
            polishing=True,
            eps_abs=OSQP_TOLERANCE,
            eps_rel=OSQP_TOLERANCE,
            max_iter=OSQP_ITERATIONS,
        )
        return np.asarray(qp.solve(raise_error=False).x)

    return solve


SOLVERS: dict[str, Callable[[ModuleType, Problem], Solve]] = {
    "daqp": _daqp,
    "quadprog": _quadprog,
    "proxsuite": _proxqp,
    "osqp": _osqp,
}


# --- measurement ------------------------------------------------------------------------------


def measure(name: str, problems: list[Problem], repeats: int) -> dict[str, Any] | None:
    """Times [s] and solutions of one solver; None if the solver is not installed."""
    try:
        module = importlib.import_module(name)
        version = importlib.metadata.version(name)
    except ImportError:
        return None
    solve = SOLVERS[name](module, problems[0])
    times = np.empty((repeats, len(problems)))
    solutions: list[Array] = []
    for i in range(repeats):
        solutions = []
        for k, problem in enumerate(problems):
            start = time.perf_counter()
            try:
                x = solve(problem)
            except (ArithmeticError, ValueError):  # exceptions of solvers that find no solution
                x = np.full(len(problem.g), np.nan)
            times[i, k] = time.perf_counter() - start
            solutions.append(x)
    return {"version": version, "times": times.min(axis=0), "solutions": solutions}


def compare(problems: list[Problem], repeats: int) -> dict[str, dict[str, Any] | None]:
    """Results of every solver, from the minimum time of each problem."""
    found = {name: measure(name, problems, repeats) for name in SOLVERS}
    costs, violations = {}, {}
    for name, result in found.items():
        if result is not None:
            pairs = list(zip(problems, result["solutions"], strict=True))
            violations[name] = np.array([p.violation(x) for p, x in pairs])
            costs[name] = np.array([p.cost(x) for p, x in pairs])
    meeting = [np.where(violations[name] < MEET, costs[name], np.inf) for name in costs]
    best = np.min(meeting, axis=0)
    out: dict[str, dict[str, Any] | None] = {}
    for name, result in found.items():
        if result is None:
            out[name] = None
            continue
        solved = np.isfinite(costs[name])
        out[name] = {
            "version": result["version"],
            "seconds": spread(result["times"]).to_dict(),
            "violation": float(violations[name][solved].max(initial=0.0)),
            "gap": float((costs[name] - best)[solved].max(initial=0.0)),
            "unsolved": int((~solved).sum()),
        }
    return out


def report(figures: dict[str, Any]) -> str:
    """Summary of the problems, and a Markdown table."""
    size = figures["size"]
    head = (
        f"{figures['problems']} problems with {size['unknowns']} unknowns, {size['equalities']} "
        f"equalities and bounds on {size['bounded']}; a bound is reached in "
        f"{figures['at_bounds']} of them."
    )
    header = ["solver", "median [us]", "minimum [us]", "p99 [us]", "violation", "cost gap"]
    rows = []
    for name, found in figures["solvers"].items():
        if found is None:
            rows.append([name, "not installed", "", "", "", "", ""])
            continue
        times = found["seconds"]
        rows.append(
            [
                f"{name} {found['version']}",
                *(f"{1e6 * times[key]:.1f}" for key in ("median", "least", "p99")),
                f"{found['violation']:.0e}",
                f"{found['gap']:.0e}",
                str(found["unsolved"]),
            ]
        )
    return f"{head}\n\n{table([*header, 'unsolved'], rows)}"


def main() -> None:
    """Record the problems, measure the solvers and print the results."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--repeats", type=int, default=5, metavar="N", help="default 5")
    arguments = parser.parse_args()
    problems = record()
    qp, at_bounds = _daqp(importlib.import_module("daqp"), problems[0]), 0
    for problem in problems:
        joints = qp(problem)[FLOATING_BASE_NV:]
        room = np.minimum(joints - problem.low, problem.high - joints)
        at_bounds += int(room.min() < 1e-9)
    figures = {
        "robot": ROBOT,
        "gait": GAIT,
        "problems": len(problems),
        "at_bounds": at_bounds,
        "size": {
            "unknowns": len(problems[0].g),
            "equalities": len(problems[0].b),
            "bounded": len(problems[0].low),
        },
        "solvers": compare(problems, arguments.repeats),
    }
    print(json.dumps(figures, indent=2) if arguments.json else report(figures))


if __name__ == "__main__":
    main()
