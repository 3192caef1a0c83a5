"""Runs of the Melson experiments, and measurements on them; see the package."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.geometry import rotation_angles
from mgs.core.progress import Progress
from mgs.experiments.melson.gravity import gravity_torques
from mgs.gait import load_gait
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot, load_robot

WALK, LONG_WALK = "melson/walk_5cm", "melson/walk_30_steps"
SCENARIOS = {"S1": (0.0, 0.0), "S2": (1.0, 0.0), "S3": (0.35, 1.6)}  # gamma_joint, gamma_grav
DRIFT_RUNS = {"gamma_joint 0": (0.0, 0.0), "gamma_joint 1": (1.0, 0.0)}
DRIFT_JOINT = "right_hip_roll"


@dataclass(frozen=True, eq=False)
class Study:
    """All runs, and the gravity torques (N, n) [N m] of the scenarios."""

    robot: Robot
    scenarios: dict[str, Stages]
    torques: dict[str, Array]
    drift: dict[str, Stages]


def solve(progress: Progress | None = None) -> Study:
    """Generate all runs."""
    robot = load_robot("melson")
    jobs = [(WALK, name, gains) for name, gains in SCENARIOS.items()]
    jobs += [(LONG_WALK, name, gains) for name, gains in DRIFT_RUNS.items()]
    done: dict[str, Stages] = {}
    for i, (gait, name, (gamma_joint, gamma_grav)) in enumerate(jobs):
        settings = (
            f"ik.gamma_joint={gamma_joint}",
            f"ik.gamma_grav={gamma_grav}",
            "ik.iterations=0",
            "com.passes=0",  # the dynamic filter would change the CoM task of each run
            "ik.double_support=off",  # this setting and the next one are those of the article
            "walk.zmp_offset=[0, 0]",
        )
        done[name] = run_stages(robot, load_gait(gait, settings), gait)
        if progress is not None:
            progress(i + 1, len(jobs))
    scenarios = {name: done[name] for name in SCENARIOS}
    torques = {name: gravity_torques(robot, stages) for name, stages in scenarios.items()}
    return Study(robot, scenarios, torques, {name: done[name] for name in DRIFT_RUNS})


def is_same_task(a: Stages, b: Stages) -> bool:
    """True if two runs have the same task trajectory, bit by bit."""
    products = ((a.tasks, b.tasks), (a.com, b.com))
    return all(
        np.array_equal(getattr(x, field.name), getattr(y, field.name))
        for x, y in products
        for field in dataclasses.fields(x)
    )


def tracking_errors(stages: Stages) -> tuple[float, float]:
    """Largest position error of soles, hands and CoM [m], largest rotation error of soles [rad].

    The errors are computed with the floating-base model, which the solver does not use.
    """
    motion = stages.motion
    gaps = [
        motion.soles[..., :3] - motion.soles_ref[..., :3],
        motion.hands[..., :3] - motion.hands_ref,
        motion.com - motion.com_ref,
    ]
    turns = rotation_angles(motion.soles[..., 3:], motion.soles_ref[..., 3:])
    return max(float(np.linalg.norm(gap, axis=-1).max()) for gap in gaps), float(turns.max())


def single_support(study: Study, side: Side) -> NDArray[np.bool_]:
    """Mask (N,) of the samples of the scenarios in single support on one side."""
    return study.scenarios["S1"].tasks.support == Support.single(side)


def peak(values: Array) -> float:
    """Largest magnitude of an array."""
    return float(np.abs(values).max())


def rms(values: Array) -> float:
    """Root mean square of an array."""
    return float(np.sqrt(np.mean(values**2)))


def torque_of(study: Study, side: Side, joint: str) -> dict[str, Array]:
    """Gravity torque (m,) [N m] of a support-leg joint in single support, by scenario."""
    i = study.robot.joint_names.index(f"{side.label}_{joint}")
    window = single_support(study, side)
    return {name: torques[window, i] for name, torques in study.torques.items()}


def angle_of(study: Study, joint: str) -> dict[str, Array]:
    """Angle (N,) [deg] of a joint of the left leg over the whole motion, by scenario."""
    i = study.robot.joint_names.index(f"left_{joint}")
    return {name: np.degrees(s.joints.angles[:, i]) for name, s in study.scenarios.items()}


def stride_poses(stages: Stages) -> Array:
    """Joint angles (n_steps / 2, n) [deg] at the starts of left single supports.

    There is one sample every two steps, at equal phases of the walk.
    """
    left = stages.tasks.support == Support.LEFT
    starts = np.flatnonzero(left[1:] & ~left[:-1]) + 1
    return np.asarray(np.degrees(stages.joints.angles[starts]))


def drift_series(study: Study) -> dict[str, Array]:
    """Angle (n_steps / 2,) [deg] of the drifting joint once every two steps, by gain."""
    i = study.robot.joint_names.index(DRIFT_JOINT)
    return {name: stride_poses(stages)[:, i] for name, stages in study.drift.items()}
