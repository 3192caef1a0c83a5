"""Sentences of Faraji and Ijspeert that this experiment cannot test, with the reason."""

from __future__ import annotations

from mgs.experiments.claim import Claim
from mgs.experiments.faraji.measures import mean_seconds, region_excess, report_of
from mgs.experiments.faraji.runs import BOUNDED, FEW, MANY, TILTING, Key, Study

REGION = 1e-9  # tolerance of joint limits [rad] and region [-]


ROWS = (  # id, sentence, reason, source
    (
        "minor_iterations",
        "Most of the work is done in minor iterations of the first quadratic program of SNOPT",
        "it concerns the inner iterations of SNOPT, a commercial solver that is not used here",
        "FI Fig. 1",
    ),
    (
        "robot",
        "Demonstrations on the real robot prove that the method is applicable and reduces the "
        "power consumption",
        "there is no robot; G_power and G_line use inverse dynamics and a model of the motors",
        "FI abstract, III-F, III-G; FI-abstract 1, 5",
    ),
    (
        "electronics",
        "Electronics take about 108 W, quiet stance on stretched legs about 10 W",
        "measured on the robot; the model has no electronics, and quiet stance is subtracted from "
        "both postures as in the paper",
        "FI Fig. 7",
    ),
    (
        "acceleration_limits",
        "Limits of the accelerations might add oscillations and do not help to leave the "
        "singularity faster",
        "an argument of the paper about constraints that neither it nor mgs implements",
        "FI III-F",
    ),
    (
        "crouched_hardware",
        "Crouched postures caused higher torques, less precise tracking, lasting deflections of "
        "springs, backlash and heat",
        "experience with the robot that the paper reports without figures; G_knee has the torques",
        "FI I; FI-abstract 1, 2",
    ),
    (
        "balance_endangered",
        "Hip angles of ik2 that the robot cannot reach might endanger the balance, as the "
        "accompanying video shows",
        "shown by a video; D_ik1_ik2 measures by how much the limit is violated",
        "FI III-D",
    ),
    (
        "mechanics",
        "Stretched legs protect actuators from long-term damage and look more human-like",
        "an expectation on hardware and appearance without a measurement in the paper",
        "FI I, IV; FI-abstract 5",
    ),
)


def untested_claims(study: Study) -> list[Claim]:
    """Claim on the safety region, which is tested, and sentences that are not."""
    found = {k: region_excess(study, run) for k, run in study.runs.items() if k.method in BOUNDED}
    worst = max(found.values())
    recovering = sum(report_of(study[k]).recovering_samples for k in found)
    times = {n: 1e3 * mean_seconds(study[Key(TILTING, "ik4", n)]) for n in (MANY, FEW)}
    return [
        Claim(
            "region",
            "The inequality constraints of ik3, ik4 and ik5 make sure that the motion is feasible",
            f"violated by {max(worst, 0.0):.1e} in {len(found)} runs",
            worst <= REGION and recovering == 0,
            "joint limits [rad] and safety region by eq. (6), at all samples, with a tolerance of "
            "1e-9",
            {"worst": worst},
            "FI II-E",
            BOUNDED,
        ),
        Claim(
            "time",
            "ik4 with few iterations costs around 2 ms, which is affordable online with 18 degrees "
            "of freedom",
            f"{times[FEW]:.2f} ms with n = {FEW}, {times[MANY]:.2f} ms with n = {MANY}",
            "not applicable",
            "the figure belongs to C++, SNOPT and a Core i5 with 1.7 GHz; ours is the median time "
            f"of task C on this machine, {times[FEW]:.2f} ms with n = {FEW}, in Python with the "
            "quadratic programs in C",
            {f"n = {n}": t for n, t in times.items()},
            "FI III-C, IV; FI-abstract 5",
            ("ik4",),
        ),
        *_untested(),
    ]


def _untested() -> list[Claim]:
    return [
        Claim(name, claim, "not measured", "not applicable", reason, source=source)
        for name, claim, reason, source in ROWS
    ]
