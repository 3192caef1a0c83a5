"""What `mgs optimize` saves, and its objective against that of Crocoddyl: docs/optimize.md.

    python benchmarks/whole_body.py [--work WEIGHT] [--distance WEIGHT] [GAIT ...]
    python benchmarks/whole_body.py --straight [ROBOT_FOLDER ...] [--distance WEIGHT] [--margin M]

With --straight, walks of COMAN and Melson, or generic/walk of robot folders, are optimised with a
weight of the work and the ZMP margin of the plan. They are replayed in both engines with
ideal, modelled and PD servos.

With --referee PYTHON, an interpreter that has Crocoddyl (a virtual environment of its own: `pip
install crocoddyl==3.2.1 pin==4.0.0`), three problems are also solved by its FDDP: a squat, a sway
and a kick, at every fourth sample. Both results are put into the same sum of the same terms.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import mgs
from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, GRAVITY
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.judge.motion_checks import check_motion
from mgs.motion import Motion
from mgs.motion.joint_load import step_speeds
from mgs.robot.limbs import leg_joints
from mgs.search.whole_body import Weights, default_hands, optimise
from mgs.search.whole_body.dynamics import offsets, soles_of
from mgs.search.whole_body.problem import Problem, bearing
from mgs.search.whole_body.run import figures_of
from mgs.search.whole_body.solve import solve

GAITS = ("melson/walk_practical", "melson/walk_arc", "melson/kick", "coman/walk", "coman/kick")
PROBLEMS = (("melson", "melson/squat"), ("coman", "coman/sway"), ("melson", "melson/kick"))
EVERY = 4  # samples of a motion make one of a problem of the referee
SCALE = 1e4  # of the objective for Crocoddyl, whose regularisation is absolute
PENALTY, ITERATIONS = 1e3, 300
LOW = {"walk.step_height": 0.025, "walk.landing": 0.2}  # knees bend less for such a swing
Walk = tuple[str, str, dict[str, Any]]  # robot, gait, settings
STRAIGHT: list[Walk] = [
    ("coman", "coman/walk", LOW), ("melson", "melson/walk_practical", {})
]  # fmt: skip
STRAIGHT_DISTANCE = 0.001
ENGINES, SERVOS = ("mujoco", "pybullet"), ("ideal", "model", "pd")


def main() -> None:
    """Print two tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("gaits", nargs="*", default=GAITS)
    parser.add_argument(
        "--straight", nargs="*", metavar="ROBOT_FOLDER", help="walks; default: COMAN, Melson"
    )
    parser.add_argument("--referee", type=Path, help="Python interpreter that has Crocoddyl")
    parser.add_argument("--work", type=float, default=0.0, help="weight")
    parser.add_argument(
        "--distance", type=float, help="weight; default: 0.01, or 0.001 with --straight"
    )
    parser.add_argument(
        "--margin", type=float, help="with --straight [m]; default: the least margin of the plan"
    )
    given = parser.parse_args()
    if given.straight is not None:
        others: list[Walk] = [(folder, "generic/walk", {}) for folder in given.straight]
        straight_table(others or STRAIGHT, given.distance or STRAIGHT_DISTANCE, given.margin)
        return
    if given.referee is not None:
        referee_table(given.referee)
    if given.gaits:
        savings_table(given.gaits, given.work, given.distance or 0.01)


def savings_table(gaits: list[str], work: float, distance: float) -> None:
    """What is saved, for each gait."""
    print("| motion | samples | RMS torque [N m] | of the knees | cost of transport | ZMP margin [mm] | steps | CPU [s] |")  # noqa: E501  # fmt: skip
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name in gaits:
        motion = mgs.generate(None, name)
        weights = Weights(work=work, distance=distance, hands=default_hands(motion))
        start = time.process_time()
        found = optimise(motion, weights)
        cpu = time.process_time() - start
        a, b = found.before, found.after
        knees = [knee_figures(each)[1] for each in (motion, found.motion)]
        cost = "" if a.cost_of_transport is None else (
            f"{a.cost_of_transport:.3f} -> {b.cost_of_transport:.3f}")  # fmt: skip
        print(
            f"| {name} | {motion.n_samples} | {a.torque_rms:.3f} -> {b.torque_rms:.3f} "
            f"({100 * (b.torque_rms / a.torque_rms - 1):+.0f} %) | "
            f"{knees[0]:.3f} -> {knees[1]:.3f} | {cost} | "
            f"{1e3 * a.zmp_margin:.1f} -> {1e3 * b.zmp_margin:.1f} | "
            f"{len(found.solution.objective) - 1} | {cpu:.0f} |"
            + ("" if found.holds else " a limit is violated"),
            flush=True,
        )


def straight_table(walks: list[Walk], distance: float, margin: float | None) -> None:
    """Walks before and after, at the same speed on the same floor, and how they are replayed."""
    print("| walk | knees [deg] | knee torque [N m] | cost of transport | knee speed | replays |")
    print("| --- | ---: | ---: | ---: | ---: | --- |")
    for robot, gait, settings in walks:
        motion = mgs.generate(robot, gait, **settings)
        weights = Weights(work=1.0, distance=distance)
        least = figures_of(motion).zmp_margin if margin is None else margin
        found = optimise(motion, weights, margin=least)
        before, after = knee_figures(motion), knee_figures(found.motion)
        angles, speeds = (f"{before[i]:.0f} -> {after[i]:.0f}" for i in (0, 2))
        costs = [figures.cost_of_transport or 0.0 for figures in (found.before, found.after)]
        saved = [
            f"{a:.3g} -> {b:.3g} ({100 * (b / a - 1):+.0f} %)"
            for a, b in ((before[1], after[1]), costs)
        ]
        told = replays(found.motion) + ([] if found.holds else ["a limit is violated"])
        print(
            f"| {Path(robot).name}, {gait} | {angles} | {' | '.join(saved)} | {speeds} % | "
            f"{'; '.join(told)} |",
            flush=True,
        )


def knee_figures(motion: Motion) -> tuple[float, float, float]:
    """Mean angle [deg], RMS torque [N m] and largest speed of the knees [% of the limit]."""
    robot = motion.robot
    legs = [[joint - 2 for joint in leg_joints(robot, side)] for side in Side]  # 1 is the base
    knees = [max(leg, key=lambda joint: abs(robot.posture[joint])) for leg in legs]
    speeds = step_speeds(motion)[:, knees] / robot.speed_limit[knees]
    return (
        float(np.degrees(np.abs(motion.q[:, FLOATING_BASE_NQ:][:, knees]).mean())),
        float(np.sqrt(np.mean(motion.torque[:, knees] ** 2))),
        100.0 * float(speeds.max()),
    )


def replays(motion: Motion) -> list[str]:
    """What each engine says with each kind of servos, and static checks that fail."""
    told = [f"{check.name} fails" for check in check_motion(motion) if not check.ok]
    for engine in ENGINES:
        for servo in SERVOS:
            try:
                verdict = mgs.validate(motion, physics=engine, servo=servo)
            except ConfigError:  # no stiffness is known
                told.append(f"{engine}, {servo}: no model")
                continue
            failed = [c.name for c in verdict.checks if not c.ok and c.name.startswith(engine)]
            told.append(f"{engine}, {servo}: {', '.join(failed) or 'passes'}")
            print(told[-1], file=sys.stderr, flush=True)
    return told


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
