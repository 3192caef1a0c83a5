"""Runs of the preview control study; see the package."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.com_generator import generate_com
from mgs.com_generator.preview import follow_zmp
from mgs.core.arrays import Array
from mgs.core.contact import Support
from mgs.core.progress import Progress
from mgs.experiments.preview.cart import Cart
from mgs.experiments.preview.servo import Servo, step_reference
from mgs.experiments.variant import BASE, Variant
from mgs.gait import ComParameters, WalkGait, load_gait
from mgs.motion_planner.walk import plan_walk
from mgs.pipeline import run_stages
from mgs.robot import load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories

GAIT = "melson/walk_5cm"
FAST = ("walk.n_steps=10", "walk.single_support=0.4", "walk.double_support=0.1")  # 0.5 s per step
FILTERED = ("melson/walk_practical", "coman/walk")
SOFT, STIFF = 1e-6, 1e-8  # weights of the jerk that are compared
SHORT_PREVIEW = 0.8  # [s]

STEP = 0.1  # [m] height of the step of the reference
STEP_BEFORE, STEP_AFTER = 300, 400  # numbers of samples before and after the step


@dataclass(frozen=True, eq=False)
class Study:
    """The example of the paper, walks with one pass of the dynamic filter, and servos of Melson."""

    cart: Cart
    filtered: dict[str, tuple[float, float]]  # gait -> mean ZMP error before, after one pass [m]
    soft: Servo
    stiff: Servo
    step: Array  # (N,) reference [m]
    answers: dict[float, Array]  # weight -> ZMP (N,) [m]
    com: Array  # (N,) CoM of the soft servo [m]
    fast: TaskTrajectory
    fast_zmp: dict[float, Array]  # weight -> ZMP (M, 2) [m]

    @property
    def short_cart(self) -> Cart:
        """Example with half the preview window."""
        return dataclasses.replace(self.cart, preview=SHORT_PREVIEW)


def solve(progress: Progress | None = None, variant: Variant | None = None) -> Study:
    """Compute all responses, with one setting changed if a variant is given."""
    variant = variant or BASE
    filtered = {}
    for i, name in enumerate(FILTERED):
        filtered[name] = one_pass(name, variant)
        if progress is not None:
            progress(i + 1, len(FILTERED))
    robot, gait = load_robot("melson"), load_gait(GAIT)
    fast_gait = load_gait(GAIT, FAST)
    assert isinstance(gait, WalkGait) and isinstance(fast_gait, WalkGait)
    com_height = plan_walk(robot, gait).com_height
    servos = {
        weight: Servo(gait.dt, com_height, ComParameters(generator="preview", weight_jerk=weight))
        for weight in (SOFT, STIFF)
    }
    step = step_reference(STEP_BEFORE, STEP_AFTER, STEP)
    answers = {weight: follow(servo, step) for weight, servo in servos.items()}
    fast = plan_trajectories(plan_walk(robot, fast_gait))
    fast_zmp = {
        weight: generate_com(robot, fast, servo.parameters).zmp for weight, servo in servos.items()
    }
    return Study(
        cart=Cart().changed(variant),
        filtered=filtered,
        soft=servos[SOFT],
        stiff=servos[STIFF],
        step=step,
        answers={weight: zmp for weight, (zmp, _) in answers.items()},
        com=answers[SOFT][1],
        fast=fast,
        fast_zmp=fast_zmp,
    )


def one_pass(name: str, variant: Variant) -> tuple[float, float]:
    """Mean distance of the ZMP of the whole robot from its plan [m], before and after one pass."""
    gait = load_gait(name, ("com.passes=1", "com.zmp_tolerance=1e-9", "ik.on_limit=record"))
    assert isinstance(gait, WalkGait) and gait.robot is not None
    walk = gait.walk
    settings = []
    if variant.amplitude != 1.0:
        settings.append(f"walk.step_length={variant.amplitude * walk.step_length}")
    if variant.speed != 1.0:
        settings.append(f"walk.single_support={walk.single_support / variant.speed}")
        settings.append(f"walk.double_support={walk.double_support / variant.speed}")
    robot = variant.robot(load_robot(gait.robot))
    report = run_stages(robot, load_gait(gait, tuple(settings)), name).motion.provenance.zmp_error
    assert report is not None
    return report.before.mean, report.after.mean


def follow(servo: Servo, zmp_ref: Array) -> tuple[Array, Array]:
    """ZMP and CoM (N,) [m] by mgs for a reference (N,) [m]."""
    both = np.column_stack([zmp_ref, np.zeros_like(zmp_ref)])
    height = np.full(len(zmp_ref), servo.com_height)
    com = follow_zmp(both, height, servo.dt, servo.parameters)
    return com.zmp[:, 0], com.position[:, 0]


def stepping(study: Study) -> NDArray[np.bool_]:
    """Mask (M,) of the samples from the first weight shift to the end of the last one."""
    single = np.flatnonzero(study.fast.support != Support.DOUBLE)
    shift = round(0.1 / study.fast.dt)
    k = np.arange(study.fast.n_samples)
    return np.asarray((k >= single[0] - shift) & (k <= single[-1] + shift))


def fast_rms(study: Study, weight: float) -> float:
    """RMS distance of the ZMP from its reference on fast steps [m]."""
    gap = np.linalg.norm(study.fast_zmp[weight] - study.fast.zmp_ref, axis=1)[stepping(study)]
    return float(np.sqrt(np.mean(gap**2)))
