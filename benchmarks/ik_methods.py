"""Times of all IK solvers on a squat and a walk, compared with other solution methods.

python benchmarks/ik_methods.py                  all measurements, about a minute
python benchmarks/ik_methods.py --rounds 2       fewer rounds of measurements
python benchmarks/ik_methods.py --blas-threads 2 SLSQP with several BLAS threads
python benchmarks/ik_methods.py --json           output as one JSON object

Solvers: times of ik1 to ik5 are those of single solves (`FarajiRun.step`) over whole runs; times of
the others are the time of a whole solve divided by its samples. The squat represents task B of
Faraji and Ijspeert (18 degrees of freedom, stretched knees in every cycle). The walk has steps of
5 cm.

The ik4 problem: one sample of ik4 as a nonlinear program is solved by SLSQP and Ipopt with exact
derivatives, from the same q_prev and initial guess (`nonlinear_side`); one row shows SLSQP with
finite differences. Slack is |delta|_Q, the square root of the objective of ik4: smaller is better,
if the hard rows are met as well. The samples are spread over the run and over the samples close to
a stretched knee. The tolerance ftol of SLSQP applies to the objective [m^2] and to the sum of the
violations.

pink: differential IK with DAQP, one step per sample, with the same targets on the same robot. This
is another problem: weighted tasks, one linearization, no hard rows, no safety region. The ratio
compares the waiting times of a user, not two implementations of one method.

All measurements alternate in one process; ratios are medians over samples and rounds. Noise of a
shared machine only adds time, so that minimum times are most reliable. BLAS has one thread: with 2
threads on a busy machine, SLSQP took up to eight times as long.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any
from unittest import mock

import numpy as np
import pinocchio as pin
from ik_tables import report
from nonlinear_side import Ik4Problem, Quality, Sample, Slsqp
from run import machine
from spread import spread

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.errors import MgsError
from mgs.core.plugins import IK_SOLVERS
from mgs.experiments.faraji.runs import FEW, ITERATED, MANY, STRETCHED, Key, gait_of
from mgs.gait import BalanceGait, WalkGait, load_gait
from mgs.ik_solver.hard_soft import NEAR_STRETCHED, FarajiIk, FarajiRun
from mgs.ik_solver.prioritized import PrioritizedReport
from mgs.motion_planner.balance import plan_balance
from mgs.motion_planner.walk import plan_walk
from mgs.pipeline import first_com
from mgs.robot import Robot, load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories

SQUAT, WALK = f"coman_legs/{STRETCHED}", "melson/walk_5cm"
THREADS = "OPENBLAS_NUM_THREADS"
OURS = f"mgs ik4, n = {FEW}"
SPREAD_SAMPLES, STRETCHED_SAMPLES = 30, 10
MISSED = 0.1  # [m] or [rad] task error above which a note is printed
MAX_ITERATIONS = 300  # largest number of iterations of SLSQP until convergence


@dataclass(frozen=True, eq=False)
class Case:
    """Robot with references and solver settings."""

    name: str
    robot: Robot
    tasks: TaskTrajectory
    com: ComTrajectory
    gait_with: Callable[
        [str, int], BalanceGait | WalkGait
    ]  # gait for a solver and a number of iterations

    def run(self, method: str, n: int) -> FarajiRun:
        """Run of a solver, at its first sample."""
        solver = FarajiIk.from_parameters(self.gait_with(method, n).ik)
        run = FarajiRun(solver, self.robot, self.tasks, self.com)
        run.start()
        return run


def main() -> None:
    """Measure all methods and print the results."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument(
        "--rounds", type=int, default=4, metavar="N", help="number of rounds; default 4"
    )
    parser.add_argument(
        "--blas-threads", type=int, default=1, metavar="N", help="number of BLAS threads; default 1"
    )
    arguments = parser.parse_args()
    threads = str(arguments.blas_threads)
    if (
        os.environ.get(THREADS) != threads
    ):  # BLAS is loaded already and reads the variable only once: restart
        os.execve(sys.executable, sys.orig_argv, os.environ | {THREADS: threads})
    figures = measure(arguments.rounds)
    figures["machine"] = {**machine(), "blas_threads": arguments.blas_threads}
    print(json.dumps(figures, indent=2) if arguments.json else report(figures))


def measure(rounds: int) -> dict[str, Any]:
    """Measure all results."""
    cases = [_squat(), _walk()]
    solvers = [_SolverTimes(case) for case in cases]
    same = _SameProblem(cases[0])
    pink, missing = _imported("pink_side")
    beside = [_Pink(case, pink) for case in cases] if pink else []
    for _ in range(rounds):
        for times in solvers:
            times.add()
        same.add()
        for runs in beside:
            runs.add()
    for times, runs in zip(solvers, beside, strict=False):
        runs.compare(times)
    return {
        "rounds": rounds,
        "solvers": {times.case.name: times.figures() for times in solvers},
        "same_problem": same.figures(),
        "pink": {runs.case.name: runs.figures for runs in beside} or missing,
    }


def _squat() -> Case:
    def gait_with(method: str, n: int) -> BalanceGait:
        return gait_of(Key(STRETCHED, method, n))

    robot, gait = load_robot("coman_legs"), gait_with("ik4", FEW)
    tasks = plan_trajectories(plan_balance(robot, gait))
    return Case(SQUAT, robot, tasks, first_com(robot, gait, tasks), gait_with)


def _walk() -> Case:
    def gait_with(method: str, n: int) -> WalkGait:
        settings = [f"ik.solver={method}", "ik.on_limit=record"]
        if method in ITERATED:  # for clik this setting has another meaning
            settings.append(f"ik.iterations={n}")
        gait = load_gait(WALK, tuple(settings))
        assert isinstance(gait, WalkGait)
        return gait

    robot, gait = load_robot("melson"), gait_with("ik4", FEW)
    tasks = plan_trajectories(plan_walk(robot, gait))
    return Case(WALK, robot, tasks, first_com(robot, gait, tasks), gait_with)


class _SolverTimes:
    """Times of every solver on one motion over several rounds."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.notes: dict[str, str] = {}
        self.iterations: dict[str, float] = {}  # mean number per sample
        self.singles: dict[str, list[Array]] = {}
        self.means: dict[str, list[float]] = {}
        self._todo: dict[str, Callable[[], None]] = {}
        for method in IK_SOLVERS.own:
            if method.startswith("ik"):
                for n in (FEW, MANY) if method in ITERATED else (1,):
                    label = f"{method}, n = {n}" if method in ITERATED else method
                    self.iterations[label] = _mean_iterations(case.run(method, n))
                    self.singles[label], self.means[label] = [], []
                    self._todo[label] = partial(self._add_singles, label, method, n)
            elif self._is_able(method):
                self.means[method] = []
                self._todo[method] = partial(self._add_whole, method)

    def _is_able(self, method: str) -> bool:
        """True if a solver accepts the motion; keeps a note of its refusal or its errors."""
        case = self.case
        solver = IK_SOLVERS.load(method).from_parameters(case.gait_with(method, FEW).ik)
        try:
            report = solver.solve(case.robot, case.tasks, case.com).report
        except MgsError as error:
            self.notes[method] = f"refuses: {str(error).partition(';')[0]}"
            return False
        errors = report.worst_errors if isinstance(report, PrioritizedReport) else {}
        missed = [f"{name} by {error:.2g}" for name, error in errors.items() if error > MISSED]
        if missed:
            self.notes[method] = f"misses {', '.join(missed)} [m, rad]"
        return True

    def add(self) -> None:
        for work in self._todo.values():
            work()

    def _add_singles(self, label: str, method: str, n: int) -> None:
        run, n_samples = self.case.run(method, n), self.case.tasks.n_samples
        stamps = np.empty(n_samples + 1, dtype=np.int64)
        stamps[0] = time.perf_counter_ns()
        for k in range(n_samples):
            run.step(k)
            stamps[k + 1] = time.perf_counter_ns()
        seconds = np.diff(stamps) * 1e-9
        self.singles[label].append(seconds)
        self.means[label].append(float(seconds.mean()))

    def _add_whole(self, method: str) -> None:
        case = self.case
        solver = IK_SOLVERS.load(method).from_parameters(case.gait_with(method, FEW).ik)
        start = time.perf_counter()
        solver.solve(case.robot, case.tasks, case.com)
        self.means[method].append((time.perf_counter() - start) / case.tasks.n_samples)

    def figures(self) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for label, means in self.means.items():
            singles = self.singles.get(label)
            found[label] = {
                "single": spread(np.ravel(singles)).to_dict() if singles else None,
                "run_mean": spread(means).to_dict(),
                "iterations": self.iterations.get(label),
            }
        return {"freedom": self.case.robot.model.nv, "times": found, "notes": self.notes}


def _mean_iterations(run: FarajiRun) -> float:
    with mock.patch.object(run, "_iterate", wraps=run._iterate) as iterate:
        for k in range(len(run.configurations)):
            run.step(k)
    return float(iterate.call_count / len(run.configurations))


class _SameProblem:
    """Single samples of ik4, solved alternately by mgs and by other solvers."""

    def __init__(self, case: Case) -> None:
        run = case.run("ik4", FEW)
        self.samples = _samples(run)
        self.problem = problem = Ik4Problem(run)
        ours = {OURS: _Ours(run), f"mgs ik4, n = {MANY}": _Ours(case.run("ik4", MANY))}
        self.counts = {
            name: [one.count(sample) for sample in self.samples] for name, one in ours.items()
        }
        self.ways: dict[str, Callable[[Sample], tuple[Array, int]]] = {
            **{name: one.solve for name, one in ours.items()},
            f"SLSQP, {FEW} iterations": Slsqp(problem, FEW, 1e-6).solve,
            "SLSQP, ftol 1e-6": Slsqp(problem, MAX_ITERATIONS, 1e-6).solve,
            "SLSQP, ftol 1e-10": Slsqp(problem, MAX_ITERATIONS, 1e-10).solve,
            "SLSQP, ftol 1e-10, intervals of mgs": Slsqp(
                problem, MAX_ITERATIONS, 1e-10, intervals=True
            ).solve,
            "SLSQP, ftol 1e-10, no Jacobians": Slsqp(
                problem, MAX_ITERATIONS, 1e-10, exact=False
            ).solve,
        }
        ipopt, self.missing = _imported("ipopt_side")
        if ipopt:
            self.ways["Ipopt"] = ipopt.Ipopt(problem).solve
        self.seconds: dict[str, list[Array]] = {name: [] for name in self.ways}
        self.iterations: dict[str, list[int]] = {}
        self.quality: dict[str, list[Quality]] = {}

    def add(self) -> None:
        for name, solve in self.ways.items():
            seconds, iterations, quality = np.empty(len(self.samples)), [], []
            for i, sample in enumerate(self.samples):
                start = time.perf_counter()
                dq, n = solve(sample)
                seconds[i] = time.perf_counter() - start
                self.problem.set(sample)
                iterations.append(n)
                quality.append(self.problem.quality(dq))
            self.seconds[name].append(seconds)
            self.iterations[name] = self.counts.get(name, iterations)
            self.quality[name] = quality

    def figures(self) -> dict[str, Any]:
        seconds = {name: np.array(times) for name, times in self.seconds.items()}
        rows = {
            name: np.array([q.to_list() for q in quality]) for name, quality in self.quality.items()
        }
        ways = {}
        for name, times in seconds.items():
            gap = rows[name][:, 0] - rows[OURS][:, 0]
            ways[name] = {
                "seconds": spread(times.ravel()).to_dict(),
                "ratio": float(np.median(times / seconds[OURS])),
                "ratio_of_best": float(np.median(times.min(axis=0) / seconds[OURS].min(axis=0))),
                "iterations": [float(np.median(self.iterations[name])), max(self.iterations[name])],
                "slack": float(np.median(rows[name][:, 0])),
                "gap": [float(x) for x in (gap.min(), np.median(gap), gap.max())],
                "hard_error": float(rows[name][:, 1].max()),
                "region_excess": float(max(rows[name][:, 2].max(), 0.0)),
            }
        return {
            "gait": SQUAT,
            "samples": len(self.samples),
            "stretched": sum(sample.is_stretched for sample in self.samples),
            "ways": ways,
            "missing": self.missing,
        }


class _Ours:
    """Solution of one sample by mgs from a given state."""

    def __init__(self, run: FarajiRun) -> None:
        self.run = run

    def solve(self, sample: Sample) -> tuple[Array, int]:
        run = self.run
        run.q = sample.q_prev
        run.step(sample.k)
        return pin.difference(run.robot.model, sample.q_prev, run.q), run.iterations

    def count(self, sample: Sample) -> int:
        """Number of iterations of a sample, at most n."""
        with mock.patch.object(self.run, "_iterate", wraps=self.run._iterate) as iterate:
            self.solve(sample)
        return int(iterate.call_count)


def _samples(run: FarajiRun) -> list[Sample]:
    """Samples spread over a run, and over its samples close to a stretched knee."""
    found: list[Sample] = []
    n = len(run.configurations)
    for k in range(n):
        q_prev = run.q.copy()
        joints = q_prev[FLOATING_BASE_NQ:]
        run.region.interval(joints, run.low, run.high)
        run._leave_singularity()
        guess = pin.difference(run.robot.model, q_prev, run.q)
        near = np.abs(joints[run.stretched] - run.stretched_at) < NEAR_STRETCHED
        found.append(Sample(k, q_prev, guess, bool(near.any())))
        run.q = q_prev
        run.step(k)
    if run.elastic or run.recovering:
        raise RuntimeError("safety region and hard rows contradict each other in some samples")
    stretched = [sample.k for sample in found if sample.is_stretched]
    chosen = {*np.linspace(1, n - 1, SPREAD_SAMPLES).astype(int).tolist()}
    chosen |= {
        stretched[i] for i in np.linspace(0, len(stretched) - 1, STRETCHED_SAMPLES).astype(int)
    }
    return [found[k] for k in sorted(chosen)]


class _Pink:
    """Times of pink on one motion over several rounds."""

    def __init__(self, case: Case, pink: Any) -> None:
        self.case = case
        run = case.run("ik4", FEW)
        self.side = pink.PinkSide(case.robot, case.tasks, case.com, run.q, run.region.speed_max)
        self.singles: list[Array] = []
        self.figures: dict[str, Any] = {}

    def add(self) -> None:
        self.last = self.side.run()
        self.singles.append(self.last.seconds)

    def compare(self, times: _SolverTimes) -> None:
        """Compute the ratios to the times of the mgs solvers in the same rounds."""
        means = np.mean(self.singles, axis=1)
        ours = {f"ik4, n = {FEW}": times.means[f"ik4, n = {FEW}"]}
        if "clik" in times.means:
            ours["clik"] = times.means["clik"]
        self.figures = {
            "version": self.side.version,
            "single": spread(np.ravel(self.singles)).to_dict(),
            "run_mean": spread(means).to_dict(),
            "ratio": {name: float(np.median(means / np.array(t))) for name, t in ours.items()},
            "sole_error": self.last.sole_error,
            "com_error": self.last.com_error,
        }


def _imported(name: str) -> tuple[Any, str]:
    """Module of this folder, or the reason why it cannot be imported."""
    try:
        return importlib.import_module(name), ""
    except ModuleNotFoundError as error:
        return None, f"{error.name} is not installed"


if __name__ == "__main__":
    main()
