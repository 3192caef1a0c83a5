"""The servos, what they are put through, and what is claimed of them; see the package."""

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
FAST = ("walk.n_steps=10", "walk.single_support=0.4", "walk.double_support=0.1")  # 0.5 s a step
SOFT, STIFF = 1e-6, 1e-8  # weights of the jerk that are compared

STEP = 0.1  # [m]
STEP_BEFORE, STEP_AFTER = 300, 400  # samples
SETTLED_AFTER = 50  # samples
AGREEMENT = 1e-6  # relative
OVERSHOOT, SETTLED = 0.05, 1e-3  # of the step
END_ERROR = 1e-6  # [m]
WINDOW_END = 1e-3  # last preview gain, relative to the largest
SIMULATION_GAP = 1e-9  # [m]
SOFT_RMS, STIFF_RMS = (2e-3, 5e-3), 0.5e-3  # [m] expected on fast steps


@dataclass(frozen=True, eq=False)
class Study:
    """Servos with either weight, the step and its answers, and fast steps with their answers."""

    soft: Servo
    stiff: Servo
    step: Array  # (N,) reference [m]
    answers: dict[float, Array]  # weight -> ZMP (N,) [m]
    com: Array  # (N,) of the soft servo [m]
    fast: TaskTrajectory
    fast_zmp: dict[float, Array]  # weight -> ZMP (M, 2) [m]


def solve(progress: Progress | None = None) -> Study:
    """Everything that the claims and figures are about; `progress` is told once, at the end."""
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
    """ZMP and CoM (N,) [m] of mgs along a reference (N,) [m]."""
    both = np.column_stack([zmp_ref, np.zeros_like(zmp_ref)])
    height = np.full(len(zmp_ref), servo.com_height)
    com = follow_zmp(both, height, servo.dt, servo.parameters)
    return com.zmp[:, 0], com.position[:, 0]


def stability_claim(study: Study) -> Claim:
    """The closed loop is stable."""
    poles = np.abs(study.soft.closed_loop().poles())
    natural = float(np.exp(-study.soft.dt * np.sqrt(GRAVITY / study.soft.com_height)))
    return Claim(
        "stable",
        "the closed loop is stable: its largest pole lies inside the unit circle",
        float(poles.max()),
        bool(poles.max() < 1.0),
        f"weight_jerk {SOFT:g}; as that goes to zero, a double pole goes to exp(-omega dt) = "
        f"{natural:.6f}, the cart-table's stable zero and the mirror image of its unstable one",
        {"largest pole": float(poles.max()), "exp(-omega dt)": natural},
    )


def lqr_claim(study: Study) -> Claim:
    """Feedback gains agree with python-control."""
    gap = max(
        _relative(lqr_feedback(servo)[0], servo.feedback) for servo in (study.soft, study.stiff)
    )
    return Claim(
        "gains_lqr",
        f"feedback gains agree with python-control's dlqr within {AGREEMENT:g} relatively",
        gap,
        gap < AGREEMENT,
        "python-control may call the same Riccati solver of SciPy that mgs calls; the next claim "
        "does not rest on it",
    )


def riccati_claim(study: Study) -> Claim:
    """The Riccati solution is one, and is found by plain recursion too."""
    servos = (study.soft, study.stiff)
    residual = max(riccati_residual(servo, lqr_feedback(servo)[1]) for servo in servos)
    gap = max(_relative(iterated_feedback(servo), servo.feedback) for servo in servos)
    return Claim(
        "gains_recursion",
        f"feedback gains agree with the Riccati recursion run from zero within {AGREEMENT:g}",
        gap,
        gap < AGREEMENT and residual < AGREEMENT,
        f"dlqr's Riccati solution, put back into its equation, leaves {residual:.0e} relatively",
        {"gap": gap, "residual": residual},
    )


def preview_claim(study: Study) -> Claim:
    """Preview gains agree with those of a plant that holds the future as states."""
    feedback, future = register_gains(study.soft)
    gains = study.soft.gains
    scale = np.abs(gains.G_p).max()
    gap = max(
        _relative(feedback, study.soft.feedback),
        float(np.abs(future - gains.G_p).max() / scale),
    )
    return Claim(
        "gains_preview",
        f"preview gains agree within {AGREEMENT:g} with plain LQR on a plant whose states hold "
        "the known future",
        gap,
        gap < AGREEMENT,
        f"dlqr of order {4 + len(future)}, no formula for preview; differences relative to the "
        "largest gain",
    )


def window_claim(study: Study) -> Claim:
    """The window is long enough."""
    G_p = np.abs(study.soft.gains.G_p)
    ratio = float(G_p[-1] / G_p.max())
    return Claim(
        "window",
        f"at the end of the preview window the gain is below {WINDOW_END:g} of the largest",
        ratio,
        ratio < WINDOW_END,
        f"window {study.soft.parameters.preview:g} s, largest gain "
        f"{(int(G_p.argmax()) + 1) * study.soft.dt:g} s ahead",
    )


def simulation_claim(study: Study) -> Claim:
    """The banded solver of mgs and python-control's simulation agree."""
    gap = max(
        float(np.abs(simulate(servo, study.step) - study.answers[weight]).max())
        for weight, servo in ((SOFT, study.soft), (STIFF, study.stiff))
    )
    return Claim(
        "simulation",
        f"ZMP of mgs and of python-control's simulation of the loop differ by less than "
        f"{SIMULATION_GAP:g} m",
        gap,
        gap < SIMULATION_GAP,
        f"a step of {STEP:g} m, known in advance, both weights",
    )


def step_claim(study: Study) -> Claim:
    """The ZMP converges onto a step that it knows of."""
    error = (study.answers[SOFT] - study.step) / STEP
    overshoot, undershoot = float(error[STEP_BEFORE:].max()), float(-error[:STEP_BEFORE].min())
    settled = float(np.abs(error[STEP_BEFORE + SETTLED_AFTER :]).max())
    end = float(np.abs(error[-1])) * STEP
    return Claim(
        "step",
        f"the ZMP converges onto a preview-fed step: overshoot below {100 * OVERSHOOT:g} %, within "
        f"{100 * SETTLED:g} % after {SETTLED_AFTER * study.soft.dt:g} s, final error below "
        f"{END_ERROR:g} m",
        f"overshoot {100 * overshoot:.2f} %, {100 * settled:.1e} %, {end:.1e} m",
        overshoot < OVERSHOOT and settled < SETTLED and end < END_ERROR,
        f"weight_jerk {SOFT:g}; before the step it draws back by {100 * undershoot:.2f} %",
        {"overshoot": overshoot, "undershoot": undershoot, "settled": settled, "end": end},
    )


def weight_claim(study: Study) -> Claim:
    """A small weight of the jerk makes the ZMP follow fast steps."""
    values = {f"{weight:g}": fast_rms(study, weight) for weight in (SOFT, STIFF)}
    soft, stiff = values.values()
    return Claim(
        "weight_jerk",
        f"on steps of 0.5 s weight_jerk {SOFT:g} leaves {1e3 * SOFT_RMS[0]:g} to "
        f"{1e3 * SOFT_RMS[1]:g} mm RMS of ZMP error and {STIFF:g} under {1e3 * STIFF_RMS:g} mm",
        f"{1e3 * soft:.2f} and {1e3 * stiff:.2f} mm",
        SOFT_RMS[0] <= soft <= SOFT_RMS[1] and stiff < STIFF_RMS,
        "ten steps of 5 cm, double support 0.1 s; ZMP of the cart-table, from the first weight "
        "shift to the last",
        values,
    )


def stepping(study: Study) -> NDArray[np.bool_]:
    """Samples (M,) from the first weight shift to the end of the last."""
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
    """Every claim."""
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
