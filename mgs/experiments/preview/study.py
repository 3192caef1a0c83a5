"""Servos, their responses, and the claims about them; see the package."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.com_generator import generate_com
from mgs.com_generator.preview import follow_zmp
from mgs.core.arrays import Array
from mgs.core.constants import GRAVITY
from mgs.core.contact import Support
from mgs.core.progress import Progress
from mgs.experiments.claim import Claim
from mgs.experiments.preview.servo import (
    Servo,
    iterated_feedback,
    lqr_feedback,
    register_gains,
    riccati_residual,
    simulate,
    step_reference,
)
from mgs.gait import ComParameters, WalkGait, load_gait
from mgs.motion_planner.walk import plan_walk
from mgs.robot import load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories

GAIT = "melson/walk_5cm"
FAST = ("walk.n_steps=10", "walk.single_support=0.4", "walk.double_support=0.1")  # 0.5 s per step
SOFT, STIFF = 1e-6, 1e-8  # weights of the jerk that are compared

STEP = 0.1  # [m] height of the step of the reference
STEP_BEFORE, STEP_AFTER = 300, 400  # numbers of samples before and after the step
SETTLED_AFTER = 50  # number of samples after which the response has settled
AGREEMENT = 1e-6  # largest relative difference
OVERSHOOT, SETTLED = 0.05, 1e-3  # largest overshoot and remaining error, as parts of the step
END_ERROR = 1e-6  # [m] largest error at the end
WINDOW_END = 1e-3  # largest ratio of the last preview gain to the largest one
SIMULATION_GAP = 1e-9  # [m] largest difference between two simulations
SOFT_RMS, STIFF_RMS = (2e-3, 5e-3), 0.5e-3  # [m] expected RMS errors on fast steps


@dataclass(frozen=True, eq=False)
class Study:
    """Servos with both weights, a step with its responses, and fast steps with their responses."""

    soft: Servo
    stiff: Servo
    step: Array  # (N,) reference [m]
    answers: dict[float, Array]  # weight -> ZMP (N,) [m]
    com: Array  # (N,) CoM of the soft servo [m]
    fast: TaskTrajectory
    fast_zmp: dict[float, Array]  # weight -> ZMP (M, 2) [m]


def solve(progress: Progress | None = None) -> Study:
    """Compute all responses; `progress` is called once, at the end."""
    robot, gait = load_robot("melson"), load_gait(GAIT)
    fast_gait = load_gait(GAIT, FAST)
    assert isinstance(gait, WalkGait) and isinstance(fast_gait, WalkGait)
    com_height = plan_walk(robot, gait).com_height
    servos = {
        weight: Servo(gait.dt, com_height, ComParameters(weight_jerk=weight))
        for weight in (SOFT, STIFF)
    }
    step = step_reference(STEP_BEFORE, STEP_AFTER, STEP)
    answers = {weight: follow(servo, step) for weight, servo in servos.items()}
    fast = plan_trajectories(plan_walk(robot, fast_gait))
    fast_zmp = {
        weight: generate_com(robot, fast, servo.parameters).zmp for weight, servo in servos.items()
    }
    zmps = {weight: zmp for weight, (zmp, _) in answers.items()}
    if progress is not None:
        progress(1, 1)
    return Study(servos[SOFT], servos[STIFF], step, zmps, answers[SOFT][1], fast, fast_zmp)


def follow(servo: Servo, zmp_ref: Array) -> tuple[Array, Array]:
    """ZMP and CoM (N,) [m] by mgs for a reference (N,) [m]."""
    both = np.column_stack([zmp_ref, np.zeros_like(zmp_ref)])
    height = np.full(len(zmp_ref), servo.com_height)
    com = follow_zmp(both, height, servo.dt, servo.parameters)
    return com.zmp[:, 0], com.position[:, 0]


def stability_claim(study: Study) -> Claim:
    """Claim: the closed loop is stable."""
    poles = np.abs(study.soft.closed_loop().poles())
    natural = float(np.exp(-study.soft.dt * np.sqrt(GRAVITY / study.soft.com_height)))
    return Claim(
        "stable",
        "the closed loop is stable: its largest pole is inside the unit circle",
        float(poles.max()),
        bool(poles.max() < 1.0),
        f"weight_jerk {SOFT:g}; in the limit of zero weight two poles are at exp(-omega dt) = "
        f"{natural:.6f}: the stable zero of the cart-table and the mirror image of the unstable "
        "one",
        {"largest pole": float(poles.max()), "exp(-omega dt)": natural},
    )


def lqr_claim(study: Study) -> Claim:
    """Claim: the feedback gains agree with python-control."""
    gap = max(
        _relative(lqr_feedback(servo)[0], servo.feedback) for servo in (study.soft, study.stiff)
    )
    return Claim(
        "gains_lqr",
        f"relative differences of feedback gains to dlqr of python-control are below {AGREEMENT:g}",
        gap,
        gap < AGREEMENT,
        "python-control may use the Riccati solver of SciPy; the next claim is independent of it",
    )


def riccati_claim(study: Study) -> Claim:
    """Claim: the feedback gains agree with the Riccati recursion."""
    servos = (study.soft, study.stiff)
    residual = max(riccati_residual(servo, lqr_feedback(servo)[1]) for servo in servos)
    gap = max(_relative(iterated_feedback(servo), servo.feedback) for servo in servos)
    return Claim(
        "gains_recursion",
        "relative differences of feedback gains to the Riccati recursion from zero are below "
        f"{AGREEMENT:g}",
        gap,
        gap < AGREEMENT and residual < AGREEMENT,
        f"relative residual of the Riccati equation for the solution of dlqr {residual:.0e}",
        {"gap": gap, "residual": residual},
    )


def preview_claim(study: Study) -> Claim:
    """Claim: the preview gains agree with LQR for a plant that includes the future."""
    feedback, future = register_gains(study.soft)
    gains = study.soft.gains
    scale = np.abs(gains.G_p).max()
    gap = max(
        _relative(feedback, study.soft.feedback),
        float(np.abs(future - gains.G_p).max() / scale),
    )
    return Claim(
        "gains_preview",
        "relative differences of preview gains to LQR for a plant that includes the known future "
        f"are below {AGREEMENT:g}",
        gap,
        gap < AGREEMENT,
        f"dlqr of order {4 + len(future)} without a formula for preview gains; differences "
        "relative to the largest gain",
    )


def window_claim(study: Study) -> Claim:
    """Claim: the preview window is long enough."""
    G_p = np.abs(study.soft.gains.G_p)
    ratio = float(G_p[-1] / G_p.max())
    return Claim(
        "window",
        f"the gain at the end of the preview window is below {WINDOW_END:g} of the largest gain",
        ratio,
        ratio < WINDOW_END,
        f"window {study.soft.parameters.preview:g} s, largest gain at "
        f"{(int(G_p.argmax()) + 1) * study.soft.dt:g} s ahead",
    )


def simulation_claim(study: Study) -> Claim:
    """Claim: the responses of mgs agree with the simulation of python-control."""
    gap = max(
        float(np.abs(simulate(servo, study.step) - study.answers[weight]).max())
        for weight, servo in ((SOFT, study.soft), (STIFF, study.stiff))
    )
    return Claim(
        "simulation",
        "the ZMP by mgs and by the simulation of python-control differ by less than "
        f"{SIMULATION_GAP:g} m",
        gap,
        gap < SIMULATION_GAP,
        f"step of {STEP:g} m that is known in advance, with both weights",
    )


def step_claim(study: Study) -> Claim:
    """Claim: the ZMP converges to a step that is known in advance."""
    error = (study.answers[SOFT] - study.step) / STEP
    overshoot, undershoot = float(error[STEP_BEFORE:].max()), float(-error[:STEP_BEFORE].min())
    settled = float(np.abs(error[STEP_BEFORE + SETTLED_AFTER :]).max())
    end = float(np.abs(error[-1])) * STEP
    return Claim(
        "step",
        "the ZMP converges to a step that is known in advance: overshoot below "
        f"{100 * OVERSHOOT:g} %, error below {100 * SETTLED:g} % after "
        f"{SETTLED_AFTER * study.soft.dt:g} s, final error below {END_ERROR:g} m",
        f"overshoot {100 * overshoot:.2f} %, error {100 * settled:.1e} %, final error {end:.1e} m",
        overshoot < OVERSHOOT and settled < SETTLED and end < END_ERROR,
        f"weight_jerk {SOFT:g}; before the step the ZMP undershoots by {100 * undershoot:.2f} %",
        {"overshoot": overshoot, "undershoot": undershoot, "settled": settled, "end": end},
    )


def weight_claim(study: Study) -> Claim:
    """Claim: with a small weight of the jerk the ZMP follows fast steps."""
    values = {f"{weight:g}": fast_rms(study, weight) for weight in (SOFT, STIFF)}
    soft, stiff = values.values()
    return Claim(
        "weight_jerk",
        f"on steps of 0.5 s the RMS error of the ZMP is {1e3 * SOFT_RMS[0]:g} to "
        f"{1e3 * SOFT_RMS[1]:g} mm with weight_jerk {SOFT:g} and below {1e3 * STIFF_RMS:g} mm with "
        f"weight_jerk {STIFF:g}",
        f"{1e3 * soft:.2f} and {1e3 * stiff:.2f} mm",
        SOFT_RMS[0] <= soft <= SOFT_RMS[1] and stiff < STIFF_RMS,
        "ten steps of 5 cm, double support 0.1 s; ZMP of the cart-table, from the first weight "
        "shift to the last",
        values,
    )


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


def _relative(found: Array, expected: Array) -> float:
    return float(np.abs(found / expected - 1.0).max())


def all_claims(study: Study) -> list[Claim]:
    """All claims of the study."""
    return [
        stability_claim(study),
        lqr_claim(study),
        riccati_claim(study),
        preview_claim(study),
        window_claim(study),
        simulation_claim(study),
        step_claim(study),
        weight_claim(study),
    ]
