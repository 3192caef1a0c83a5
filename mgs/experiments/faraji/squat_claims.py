"""The claims on squats: tasks A to C, and what the region and gamma contribute (E and F)."""

from __future__ import annotations

import numpy as np

from mgs.experiments.claim import Claim
from mgs.experiments.faraji.runs import (
    BOUNDED,
    FEW,
    MANY,
    SQUAT,
    STRETCHED,
    TILTING,
    Key,
    Run,
    Study,
    escape_delay,
    hard_error,
    limit_excess_deg,
    rejoining_acceleration,
    report_of,
)
from mgs.experiments.faraji.thresholds import BROKEN_DEG, HARD, REGION

SPEED_MAX = 4.0  # [rad/s] limit of the joint speeds
IK2_GAIN, IK4_GAIN = 50.0, 30.0  # error of ik1 divided by the error of the method
LITTLE = 2.0  # largest ratio of the errors of ik4 with few and with many iterations
HEIGHT_RATIO, COM_RATIO = 0.7, 0.75  # largest ratio to the error of ik3
ACCELERATION_RATIO = 3.0
SNOPT = (
    "the claim depends on the limit of major iterations of the solver SNOPT; here each iteration "
    "is an exact QP, and {}"
)


def squat_claims(study: Study) -> list[Claim]:
    """Claims of task A: squat without singularity."""
    fine = {(m, n): mean_error(study[Key(SQUAT, m, n, "fine")]) for m, n in _all()}
    coarse = {(m, n): mean_error(study[Key(SQUAT, m, n)]) for m, n in _all()}
    gains = {m: fine["ik1", MANY] / fine[m, MANY] for m in ("ik2", "ik4", "ik5")}
    few = {m: fine[m, FEW] / fine[m, MANY] for m in ("ik2", "ik4", "ik5")}
    at_coarse = ", ".join(f"{m} {1e3 * coarse[m, MANY]:.3f}" for m in ("ik1", "ik2", "ik4", "ik5"))
    note = f"mean CoM error at dt 0.002: ik1 {1e3 * fine['ik1', MANY]:.3f} mm; "
    note += f"at dt 0.01: {at_coarse} mm, n = {MANY}"
    return [
        Claim(
            "A_ik2",
            f"squat without singularity: the error of ik1 is at least {IK2_GAIN:g} times that of "
            "ik2",
            f"{gains['ik2']:.0f} times",
            gains["ik2"] >= IK2_GAIN,
            note,
            {"ik2": gains["ik2"]},
        ),
        Claim(
            "A_ik4_ik5",
            f"squat without singularity: the error of ik1 is at least {IK4_GAIN:g} times those of "
            "ik4 and ik5",
            f"ik4 {gains['ik4']:.0f} times, ik5 {gains['ik5']:.0f} times",
            min(gains["ik4"], gains["ik5"]) >= IK4_GAIN,
            "the remaining error is of second order in the step: the gamma term is linearized",
            {"ik4": gains["ik4"], "ik5": gains["ik5"]},
        ),
        Claim(
            "A_few",
            f"with n = {FEW} instead of {MANY} the error of ik2 grows much, that of ik4 little",
            f"ik2 {few['ik2']:.1f} times, ik4 {few['ik4']:.2f} times",
            few["ik2"] > LITTLE >= few["ik4"],
            f"ik5 {few['ik5']:.0f} times: its weight relative to the damping is (1 + gamma) times "
            "smaller",
            few,
        ),
        Claim(
            "A_ik3_few",
            f"with n = {FEW} instead of {MANY} the error of ik3 grows",
            "ik3 solves one QP for any n",
            "not applicable",
            SNOPT.format("ik3 has a single iteration"),
        ),
    ]


def stretched_claims(study: Study) -> list[Claim]:
    """Claims of task B: squat above reach."""
    runs = {(m, n): study[Key(STRETCHED, m, n)] for m, n in _all()}
    speeds = {m: float(np.abs(runs[m, MANY].speeds()).max()) for m in ("ik1", "ik3", "ik4", "ik5")}
    delays = {m: escape_delay(study, runs[m, MANY]) for m in speeds}
    errors = {key: height_error(run) for key, run in runs.items()}
    ratios = {f"{m}, n = {n}": errors[m, n] / errors["ik3", MANY] for m, n in _iterated()}
    return [
        Claim(
            "B_speed",
            f"squat above reach: joint speeds of ik1 exceed {SPEED_MAX:g} rad/s, those of ik3 to "
            "ik5 do not",
            f"ik1 {speeds['ik1']:.2f}, ik3 {speeds['ik3']:.2f}, ik4 {speeds['ik4']:.2f} rad/s",
            speeds["ik1"] > SPEED_MAX >= max(speeds[m] for m in BOUNDED) - REGION,
            values=speeds,
        ),
        Claim(
            "B_late",
            "squat above reach: ik1 and ik3 leave the singular posture later than ik4 and ik5",
            ", ".join(f"{m} {1e3 * delay:.0f} ms" for m, delay in delays.items()),
            min(delays["ik1"], delays["ik3"]) > max(delays["ik4"], delays["ik5"]),
            "delay relative to the reference when the knee is bent by 15 deg",
            delays,
        ),
        Claim(
            "B_height",
            f"squat above reach: the mean height errors of ik4 and ik5 with n = {MANY} and {FEW} "
            f"are at most {HEIGHT_RATIO:g} of that of ik3",
            ", ".join(f"{label}: {ratio:.2f}" for label, ratio in ratios.items()),
            max(ratios.values()) <= HEIGHT_RATIO,
            f"mean height error of ik3 {1e3 * errors['ik3', MANY]:.1f} mm; all errors include the "
            "part of the reference that is out of reach",
            ratios,
        ),
    ]


def tilting_claims(study: Study) -> list[Claim]:
    """Claims of task C: squat above reach with roll and pitch of the torso."""
    runs = {(m, n): study[Key(TILTING, m, n)] for m, n in _all()}
    knees = study.joint("KneeSag")
    broken = {m: limit_excess_deg(runs[m, MANY], study.robot, knees) for m in ("ik1", "ik2")}
    hard = {n: hard_error(runs["ik4", n]) for n in (MANY, FEW)}
    errors = {key: mean_error(run) for key, run in runs.items()}
    ratios = {n: errors["ik4", n] / errors["ik3", MANY] for n in (MANY, FEW)}
    elastic = report_of(runs["ik3", MANY]).elastic_samples
    return [
        Claim(
            "C_limits",
            "squat with torso roll and pitch: ik1 and ik2 violate the knee limits by more than "
            f"{BROKEN_DEG:g} deg",
            ", ".join(f"{m} {excess:.0f} deg" for m, excess in broken.items()),
            min(broken.values()) > BROKEN_DEG,
            values=broken,
        ),
        Claim(
            "C_hard",
            "squat with torso roll and pitch: the hard-row errors of ik4 stay below 0.1 mm with "
            f"n = {MANY} and n = {FEW}",
            f"{1e3 * hard[MANY]:.1e} and {1e3 * hard[FEW]:.1e} mm",
            max(hard.values()) <= HARD,
            values={f"n = {n}": value for n, value in hard.items()},
        ),
        Claim(
            "C_com",
            "squat with torso roll and pitch: the mean CoM error of ik4 is at most "
            f"{COM_RATIO:g} of that of ik3",
            f"{ratios[MANY]:.2f} with n = {MANY}, {ratios[FEW]:.2f} with n = {FEW}",
            max(ratios.values()) <= COM_RATIO,
            f"mean CoM error of ik3 {1e3 * errors['ik3', MANY]:.0f} mm; at {elastic} samples its "
            "only QP is infeasible, and the CoM deviates so that the errors of the feet stay as "
            "small as possible; with equal weights of CoM and feet at these samples the error "
            "would be 30 mm and the ratio 0.6",
            {f"n = {n}": ratio for n, ratio in ratios.items()},
        ),
        Claim(
            "C_ik5_few",
            f"squat with torso roll and pitch: ik5 stops moving with n = {FEW}",
            f"mean CoM error {1e3 * errors['ik5', FEW]:.1f} mm, {1e3 * errors['ik5', MANY]:.1f} mm "
            f"with n = {MANY}",
            "not applicable",
            SNOPT.format("ik5 has the same solution as ik4 and keeps moving"),
        ),
    ]


def polygon_claim(study: Study) -> Claim:
    """Claim of task E: shape of the safety region."""
    runs = {
        "ellipse": study[Key(STRETCHED, "ik4")],
        "polygon": study[Key(STRETCHED, "ik4", MANY, "polygon")],
    }
    delays = {name: escape_delay(study, run, 30.0) for name, run in runs.items()}
    errors = {name: height_error(run) for name, run in runs.items()}
    return Claim(
        "E_polygon",
        "with a polygon as safety region the robot leaves the singularity later than with the "
        "ellipse",
        f"delay {1e3 * delays['polygon']:.0f} ms with the polygon, "
        f"{1e3 * delays['ellipse']:.0f} ms with the ellipse",
        delays["polygon"] > delays["ellipse"],
        "delay relative to the reference when the knee is bent by 30 deg; mean height errors "
        f"{1e3 * errors['polygon']:.1f} and {1e3 * errors['ellipse']:.1f} mm",
        delays,
    )


def gamma_claims(study: Study) -> list[Claim]:
    """Claims of task F: gamma = 0 compared with gamma = 10."""
    runs = {
        "gamma 10": study[Key(STRETCHED, "ik4")],
        "gamma 0": study[Key(STRETCHED, "ik4", MANY, "gamma 0")],
    }
    delays = {name: escape_delay(study, run) for name, run in runs.items()}
    peaks = {name: rejoining_acceleration(study, run) for name, run in runs.items()}
    ratio = peaks["gamma 0"] / peaks["gamma 10"]
    return [
        Claim(
            "F_escape",
            "with gamma = 0 the robot leaves the singularity later than with gamma = 10",
            f"{1e3 * delays['gamma 0']:.0f} ms and {1e3 * delays['gamma 10']:.0f} ms",
            delays["gamma 0"] > delays["gamma 10"],
            "delay relative to the reference when the knee is bent by 15 deg",
            delays,
        ),
        Claim(
            "F_acceleration",
            "with gamma = 0 the knee returns to its reference with at least "
            f"{ACCELERATION_RATIO:g} times the acceleration",
            f"{ratio:.1f} times: {peaks['gamma 0']:.0f} and {peaks['gamma 10']:.0f} rad/s^2",
            ratio >= ACCELERATION_RATIO,
            "largest acceleration with the knee bent by more than 30 deg",
            peaks,
        ),
    ]


def mean_error(run: Run) -> float:
    """Mean distance of the CoM from its reference in the window [m]."""
    return float(np.linalg.norm(run.com_error(), axis=1).mean())


def height_error(run: Run) -> float:
    """Mean height error of the CoM in the window [m]."""
    return float(np.abs(run.com_error()[:, 2]).mean())


def _all() -> list[tuple[str, int]]:
    iterated = [(m, n) for m in ("ik2", "ik4", "ik5") for n in (MANY, FEW)]
    return [("ik1", MANY), ("ik3", MANY), *iterated]


def _iterated() -> list[tuple[str, int]]:
    return [(m, n) for m in ("ik4", "ik5") for n in (MANY, FEW)]
