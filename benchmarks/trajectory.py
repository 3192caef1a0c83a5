"""Comparison of the solver `trajectory` with closed-loop inverse kinematics on three motions.

    two steps       melson/walk_5cm
    30 steps        melson/walk_30_steps
    squat           squat after task B of Faraji and Ijspeert, at a height without stretched knees;
                    29 joints of COMAN (its legs alone have no null space), 0.51 m +- 30 mm at 1 Hz

H is the integral of 0.35 H_joint + 1.6 H_grav [s] over the whole motion, with the weight shared
between the soles as planned, for every solver. The closed-loop solver descends the same two costs
with the gains of scenario 3 of the article on Melson and with multiples of them; multiples that
violate joint limits are left out. `trajectory` starts in a free posture, or in the posture of the
closed-loop solver. Torques are computed by inverse dynamics. The time is the processor time of
stage 4, the minimum of several runs.

    python benchmarks/trajectory.py [squat]
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass

import numpy as np

from mgs.core.errors import MgsError
from mgs.gait import Gait, IkParameters, load_gait, parse_gait
from mgs.ik_solver import solve_ik
from mgs.ik_solver.whole_motion import Problem, TrajectoryIk
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot, load_robot

SQUAT = """
mgs: 1
robot: coman
motion: balance
dt: 0.01
balance:
  duration: 13.0
  com_height: 0.51
  channels:
    - {task: com_z, wave: sine, amplitude: 0.03, frequency: 1.0}
"""
GAMMA_JOINT, GAMMA_GRAV = 0.35, 1.6
MULTIPLES = (1, 5, 10, 15, 20, 30)
RUNS = 3


@dataclass(frozen=True)
class Row:
    """Results of one solver on one motion."""

    name: str
    cost: float  # integral of H [s]
    peak: float  # largest joint torque [N m]
    rms: float  # root mean square of the joint torques [N m]
    jerk: float  # root mean square of the joint jerks [rad/s^3]
    margin: float  # least distance of a joint from its limits [deg]
    miss: float  # largest distance of soles, hands and CoM from their references [m]
    time: float  # per sample [s]

    def __str__(self) -> str:
        """One line of the table."""
        return (
            f"| {self.name} | {self.cost:.3f} | {self.peak:.3f} | {self.rms:.4f} | "
            f"{self.jerk:.2f} | {self.margin:.1f} | {1e3 * self.miss:.4f} | "
            f"{1e3 * self.time:.3f} |"
        )


HEADER = """| solver | integral of H | peak torque [N m] | RMS torque [N m] | RMS jerk [rad/s^3] | \
limit margin [deg] | task error [mm] | time [ms/sample] |
| --- | --- | --- | --- | --- | --- | --- | --- |"""


def motions() -> dict[str, tuple[str, str]]:
    """Robot and gait of each motion; the gait of the squat is given as text."""
    return {
        "two steps": ("melson", "melson/walk_5cm"),
        "30 steps": ("melson", "melson/walk_30_steps"),
        "squat": ("coman", SQUAT),
    }


def gait_with(gait: str, *settings: str) -> Gait:
    """Load a shipped gait, or parse a gait that is given as text."""
    if "\n" in gait:
        return parse_gait(gait, "squat", settings)
    return load_gait(gait, settings)


def solvers() -> dict[str, tuple[str, ...]]:
    """Settings of each solver variant by name."""
    names: dict[str, tuple[str, ...]] = {}
    for scheme, text in (("off", "gravity off in double support"), ("shared", "shared")):
        for multiple in MULTIPLES:
            names[f"clik x{multiple}, {text}"] = (
                f"ik.gamma_joint={multiple * GAMMA_JOINT}",
                f"ik.gamma_grav={multiple * GAMMA_GRAV}",
                f"ik.double_support={scheme}",
            )
    for start in ("posture", "free"):
        names[f"trajectory, start: {start}"] = (
            "ik.solver=trajectory",
            f"ik.gamma_joint={GAMMA_JOINT}",
            f"ik.gamma_grav={GAMMA_GRAV}",
            f"ik.trajectory.start={start}",
        )
    return names


def measure(robot: Robot, stages: Stages, name: str) -> Row:
    """Results of one run; the time is the minimum of several runs."""
    motion, q = stages.motion, stages.joints.angles
    room = np.minimum(q - robot.lower, robot.upper - q)
    misses = (
        motion.com - motion.com_ref,
        motion.soles[..., :3] - motion.soles_ref[..., :3],
        motion.hands[..., :3] - motion.hands_ref,
    )
    return Row(
        name,
        cost_of(robot, stages),
        float(np.abs(motion.torque).max()),
        float(np.sqrt(np.mean(motion.torque**2))),
        float(np.sqrt(np.mean(np.diff(q, 3, axis=0) ** 2)) / motion.dt**3),
        float(np.degrees(room.min())),
        max(float(np.linalg.norm(miss, axis=-1).max()) for miss in misses),
        min(_solve_time(robot, stages) for _ in range(RUNS)) / len(q),
    )


def _solve_time(robot: Robot, stages: Stages) -> float:
    """Processor time of stage 4 [s]."""
    start = time.process_time()
    solve_ik(robot, stages.tasks, stages.com, stages.gait.ik)
    return time.process_time() - start


def cost_of(robot: Robot, stages: Stages) -> float:
    """Integral of 0.35 H_joint + 1.6 H_grav [s]; `trajectory` uses the same weights by default."""
    solver = TrajectoryIk.from_parameters(IkParameters())
    problem = Problem(solver, robot, stages.tasks, stages.com)
    return problem.cost(stages.joints.angles)


def table(robot: Robot, gait: str) -> list[Row]:
    """Rows of one motion: gains of the article, best multiples of both schemes, `trajectory`."""
    runs: dict[str, Stages] = {}
    for name, settings in solvers().items():
        try:
            runs[name] = run_stages(robot, gait_with(gait, *settings))
        except MgsError as error:
            sys.stderr.write(f"{name}: {error}\n")
    costs = {name: cost_of(robot, stages) for name, stages in runs.items()}
    closed_loop = [name for name in runs if name.startswith("clik")]
    best = [
        min((n for n in closed_loop if n.endswith(end)), key=costs.__getitem__)
        for end in ("double support", "shared")
    ]
    last = [name for name in runs if name not in closed_loop]
    chosen = dict.fromkeys([closed_loop[0], "clik x1, shared", *best, *last])
    return [measure(robot, runs[name], name) for name in chosen]


def main() -> None:
    """Print one table per motion; the arguments select motions."""
    for name, (robot, gait) in motions().items():
        if sys.argv[1:] and name not in sys.argv[1:]:
            continue
        rows = table(load_robot(robot), gait)
        sys.stdout.write(f"\n{name}\n\n{HEADER}\n" + "\n".join(map(str, rows)) + "\n")


if __name__ == "__main__":
    main()
