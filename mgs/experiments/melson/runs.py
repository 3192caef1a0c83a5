"""Runs of the Melson experiments, and measurements on them; see the package."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.geometry import polygon_margins
from mgs.core.progress import Progress
from mgs.core.spans import spans
from mgs.experiments.melson.gravity import gravity_cost, gravity_torques
from mgs.experiments.variant import BASE, Variant
from mgs.gait import WalkGait, load_gait
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot, load_robot
from mgs.robot.support_polygon import support_polygon

GAITS = {"S1": "melson/s1", "S2": "melson/s2", "S3": "melson/s3"}
SHORT, LONGER, LONG = 2, 8, 30  # numbers of steps; the article has 2 and 30
LONG_RUNS = ("S1", "S2")  # of the walk of 30 steps, as in the article


@dataclass(frozen=True, eq=False)
class Walk:
    """One run with the measurements that several claims need."""

    robot: Robot
    stages: Stages

    @cached_property
    def gravity(self) -> Array:
        """Gravity torques (N, n) [N m] in single support, as `gravity_torques` gives them."""
        return gravity_torques(self.robot, self.stages)

    @cached_property
    def angles(self) -> Array:
        """Joint angles (N, n) [deg]."""
        return np.asarray(np.degrees(self.stages.joints.angles))

    @property
    def supports(self) -> list[tuple[Side, slice]]:
        """Support side and samples of each single support phase, in the order of time."""
        support = self.stages.tasks.support
        return [
            (side, slice(start, end))
            for start, end in spans(support)
            for side in Side
            if support[start] == Support.single(side)
        ]

    def column(self, side: Side, joint: str) -> int:
        """Column of a joint such as "hip_roll" of one leg."""
        return self.robot.joint_names.index(f"{side.label}_{joint}")

    def support_torque(self, side: Side, joint: str) -> Array:
        """Gravity torque (m,) [N m] of a support-leg joint in all single supports on one side."""
        window = self.stages.tasks.support == Support.single(side)
        return np.asarray(self.gravity[window, self.column(side, joint)])


Walks = dict[str, Walk]  # by scenario


@dataclass(frozen=True, eq=False)
class Study:
    """All runs by scenario: two steps, eight steps, and thirty steps of S1 and S2."""

    robot: Robot
    short: Walks
    longer: Walks
    long: Walks

    @property
    def all_walks(self) -> list[Walk]:
        """All runs of the study."""
        return [*self.short.values(), *self.longer.values(), *self.long.values()]


def solve(progress: Progress | None = None, variant: Variant | None = None) -> Study:
    """Generate all runs, with one setting changed if a variant is given."""
    variant = variant or BASE
    robot = variant.robot(load_robot("melson"))
    jobs = [(n_steps, name) for n_steps in (SHORT, LONGER) for name in GAITS]
    jobs += [(LONG, name) for name in LONG_RUNS]
    done: dict[tuple[int, str], Walk] = {}
    for i, (n_steps, name) in enumerate(jobs):
        gait = load_gait(GAITS[name], settings_of(GAITS[name], n_steps, variant))
        done[n_steps, name] = Walk(robot, run_stages(robot, gait, GAITS[name]))
        if progress is not None:
            progress(i + 1, len(jobs))
    short, longer = ({name: done[n, name] for name in GAITS} for n in (SHORT, LONGER))
    return Study(robot, short, longer, {name: done[LONG, name] for name in LONG_RUNS})


def settings_of(name: str, n_steps: int, variant: Variant) -> tuple[str, ...]:
    """Settings that turn a shipped scenario into a run: number of steps, then the variant."""
    gait = load_gait(name)
    assert isinstance(gait, WalkGait)
    walk, ik = gait.walk, gait.ik
    # the article has no limits but the null-space motion, and a claim measures whether it suffices
    settings = [f"walk.n_steps={n_steps}", "ik.on_limit=record"]
    if variant.amplitude != 1.0:
        settings.append(f"walk.step_length={variant.amplitude * walk.step_length}")
    if variant.speed != 1.0:
        settings.append(f"walk.double_support={walk.double_support / variant.speed}")
        settings.append(f"walk.single_support={walk.single_support / variant.speed}")
    if variant.gains != 1.0:
        settings.append(f"ik.gamma_joint={variant.gains * ik.gamma_joint}")
        settings.append(f"ik.gamma_grav={variant.gains * ik.gamma_grav}")
    return (*settings, *variant.settings)


def peak_time(walk: Walk, values: Array) -> str:
    """Time and phase of the largest magnitude of values (N,), such as "6.41 s, double support"."""
    k = int(np.nanargmax(np.abs(values)))
    phase = Support(walk.stages.tasks.support[k]).name.lower()
    single = "" if phase == "double" else "single "
    return f"{walk.stages.motion.times[k]:.2f} s, {phase} {single}support"


def peak(values: Array) -> float:
    """Largest magnitude of an array."""
    return float(np.abs(values).max())


def rms(values: Array) -> float:
    """Root mean square of an array."""
    return float(np.sqrt(np.mean(values**2)))


def limit_distance(walk: Walk) -> tuple[float, str]:
    """Least distance of a joint from its limits [deg], and the name of the joint."""
    angles, robot = walk.stages.joints.angles, walk.robot
    distance = np.minimum(angles - robot.lower, robot.upper - angles).min(axis=0)
    worst = int(distance.argmin())
    return float(np.degrees(distance[worst])), robot.joint_names[worst]


def joint_cost(walk: Walk) -> float:
    """Mean over the motion of H_joint, eq. (12) of the article."""
    robot = walk.robot
    middle, width = 0.5 * (robot.upper + robot.lower), robot.upper - robot.lower
    return float(np.mean(0.5 * np.sum(((walk.stages.joints.angles - middle) / width) ** 2, axis=1)))


def support_costs(walk: Walk) -> list[float]:
    """Mean of H_grav [(N m)^2] in each single support phase."""
    cost = gravity_cost(walk.gravity)
    return [float(cost[samples].mean()) for _, samples in walk.supports]


def zmp_margin(walk: Walk) -> float:
    """Least distance of the ZMP of the whole robot from the edge of the support polygon [m]."""
    motion = walk.stages.motion
    margins = [
        polygon_margins(
            motion.zmp[start:end],
            support_polygon(motion.robot, motion.soles[start], Support(motion.support[start])),
        ).min()
        for start, end in spans(motion.support)
    ]
    return float(min(margins))


def tracking_errors(walk: Walk) -> Array:
    """Largest position error (N,) of soles, hands and CoM [m] in each sample.

    The errors are computed with the floating-base model, which the solver does not use.
    """
    motion = walk.stages.motion
    gaps = [
        np.linalg.norm(motion.soles[..., :3] - motion.soles_ref[..., :3], axis=-1).max(axis=1),
        np.linalg.norm(motion.hands[..., :3] - motion.hands_ref, axis=-1).max(axis=1),
        np.linalg.norm(motion.com - motion.com_ref, axis=-1),
    ]
    return np.asarray(np.max(gaps, axis=0))


def stride_poses(walk: Walk) -> Array:
    """Joint angles (n_steps / 2, n) [deg] at the starts of left single supports.

    There is one sample every two steps, at equal phases of the walk.
    """
    starts = [samples.start for side, samples in walk.supports if side == Side.LEFT]
    return np.asarray(walk.angles[starts])
