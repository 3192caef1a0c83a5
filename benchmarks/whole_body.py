"""What `mgs optimize` saves, and its objective against that of Crocoddyl: docs/optimize.md.

    python benchmarks/whole_body.py [--referee PYTHON] [GAIT ...]

With --referee PYTHON, an interpreter that has Crocoddyl (a virtual environment of its own: `pip
install crocoddyl==3.2.1 pin==4.0.0`), three problems are also solved by its FDDP: a squat, a sway
and a kick, at every fourth sample. Both results are put into the same sum of the same terms.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import pinocchio as pin

import mgs
from mgs.core.arrays import Array
from mgs.core.constants import GRAVITY
from mgs.core.contact import Side
from mgs.search.whole_body import Weights, optimise
from mgs.search.whole_body.dynamics import offsets, soles_of
from mgs.search.whole_body.problem import Problem, bearing
from mgs.search.whole_body.solve import solve

GAITS = ("melson/walk_practical", "melson/walk_arc", "melson/kick", "coman/walk", "coman/kick")
PROBLEMS = (("melson", "melson/squat"), ("coman", "coman/sway"), ("melson", "melson/kick"))
EVERY = 4  # samples of a motion make one of a problem of the referee
SCALE = 1e4  # of the objective for Crocoddyl, whose regularisation is absolute
PENALTY, ITERATIONS = 1e3, 300


def main() -> None:
    """Print two tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("gaits", nargs="*", default=GAITS)
    parser.add_argument("--referee", type=Path, help="Python interpreter that has Crocoddyl")
    given = parser.parse_args()
    if given.referee is not None:
        referee_table(given.referee)
    if given.gaits:
        savings_table(given.gaits)


def savings_table(gaits: list[str]) -> None:
    """What is saved, for each gait."""
    print("| motion | samples | RMS torque [N m] | cost of transport | ZMP margin [mm] | steps | CPU [s] |")  # noqa: E501  # fmt: skip
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name in gaits:
        motion = mgs.generate(None, name)
        start = time.process_time()
        found = optimise(motion)
        cpu = time.process_time() - start
        a, b = found.before, found.after
        cost = "" if a.cost_of_transport is None else (
            f"{a.cost_of_transport:.3f} -> {b.cost_of_transport:.3f}")  # fmt: skip
        print(
            f"| {name} | {motion.n_samples} | {a.torque_rms:.3f} -> {b.torque_rms:.3f} "
            f"({100 * (b.torque_rms / a.torque_rms - 1):+.0f} %) | {cost} | "
            f"{1e3 * a.zmp_margin:.1f} -> {1e3 * b.zmp_margin:.1f} | "
            f"{len(found.solution.objective) - 1} | {cpu:.0f} |",
            flush=True,
        )


def referee_table(python: Path) -> None:
    """Our objective and that of Crocoddyl, for each problem."""
    print("| problem | samples | plan | mgs | Crocoddyl | ratio | mgs, Crocoddyl [s] |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |")
    for robot, gait in PROBLEMS:
        problem = problem_of(robot, gait)
        start = time.process_time()
        solution = solve(problem, 40)
        cpu = time.process_time() - start
        ours = value(problem, solution.point.q, solution.point.torque)
        q, torque, seconds, note = ask(python, problem)
        theirs = value(problem, q, torque)
        print(
            f"| {gait} | {problem.n_samples} | {solution.objective[0]:.5f} | {ours:.5f} | "
            f"{theirs:.5f} | {ours / theirs:.4f} | {cpu:.1f}, {seconds:.1f} |  {note}",
            flush=True,
        )


def problem_of(robot: str, gait: str) -> Problem:
    """A problem for both sides."""
    motion = mgs.generate(robot, gait)
    chosen = slice(0, motion.n_samples, EVERY)
    return Problem(
        motion.robot, EVERY * motion.dt, motion.q[chosen], motion.soles[chosen],
        bearing(motion.support[chosen]), Weights(), margin=0.0,
    )  # fmt: skip


def value(problem: Problem, q: Array, torque: Array) -> float:
    """The objective without the last sample, which Crocoddyl has no torque for."""
    joints, torso, _ = offsets(problem, q)
    weights, last = problem.weights, len(q) - 1
    return problem.h * float(
        0.5 * problem.weight_torque * np.sum(torque[:last] ** 2)
        + 0.5 * weights.distance * np.sum(joints[:last] ** 2)
        + 0.5 * weights.upright * np.sum(torso[:last] ** 2)
    )


def ask(python: Path, problem: Problem) -> tuple[Array, Array, float, str]:
    """Configurations, torques, CPU time and a note of Crocoddyl's solution."""
    robot = problem.robot
    frames = [robot.model.frames[i] for i in (*robot.sole_frames, robot.torso_frame)]
    torsos = [pin.SE3ToXYZQUAT(place) for place in problem.references[0]]
    specs = [robot.sole_spec(side) for side in Side]
    with tempfile.TemporaryDirectory() as folder:
        asked, told = Path(folder) / "problem.npz", Path(folder) / "solution.npz"
        np.savez(
            asked, urdf=robot.urdf, joints=np.array(robot.joint_names), armature=robot.armature,
            parents=[frame.parentJoint for frame in frames],
            placements=[pin.SE3ToXYZQUAT(frame.placement) for frame in frames],
            plan=problem.plan, soles=problem.soles, bears=problem.bears, torso=torsos,
            boxes=[[s.length - 2 * problem.margin, s.width - 2 * problem.margin] for s in specs],
            lower=robot.lower, upper=robot.upper, friction=problem.friction, h=problem.h,
            weight=robot.mass * GRAVITY, weight_torque=SCALE * problem.weight_torque,
            weight_distance=SCALE * problem.weights.distance,
            weight_upright=SCALE * problem.weights.upright,
            penalty=SCALE * PENALTY, iterations=ITERATIONS,
        )  # fmt: skip
        side = Path(__file__).with_name("crocoddyl_side.py")
        start = time.perf_counter()
        subprocess.run(
            [python, side, asked, told], check=True, env=os.environ | {"OMP_NUM_THREADS": "1"}
        )
        seconds = time.perf_counter() - start
        found = np.load(told)
        q, torque = found["q"], found["torque"]
        off = np.abs(soles_of(problem, q)[0])
        note = (
            f"{found['iterations']} iterations, converged {bool(found['converged'])}; soles off by "
            f"{1e3 * off[problem.bears].max():.2f} mm, in the air "
            f"{1e3 * off[~problem.bears].max(initial=0.0):.2f} mm"
        )
        return q, torque, seconds, note


if __name__ == "__main__":
    main()
