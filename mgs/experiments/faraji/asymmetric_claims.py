"""Claims of task C, FI III-C and figure 3, and of the conclusion of FI that rest on it."""

from __future__ import annotations

import numpy as np

from mgs.experiments.claim import Claim
from mgs.experiments.faraji.measures import (
    hard_error,
    horizontal_error,
    limit_excess_deg,
    mean_error,
    mean_seconds,
    report_of,
    survival,
)
from mgs.experiments.faraji.runs import (
    FEW,
    MANY,
    SQUAT,
    STRETCHED,
    TILTING,
    Key,
    Study,
    methods,
)
from mgs.experiments.faraji.squat_claims import ALL
from mgs.experiments.faraji.thresholds import CONSIDERABLE, FASTER, HARD, NOT_ALTERED

FEASIBLE = (
    "fails: a joint limit by more than 0.5 deg, feet or torso by more than 1 mm (mrad), or the CoM "
    "outside the soles"
)
OWN_IK5 = (
    "each iteration is an exact quadratic program here, and the iterations start from bent knees; "
    "the freezing of the paper's ik5 comes with the limit of major iterations of SNOPT"
)


def asymmetric_claims(study: Study) -> list[Claim]:
    """Claims on feasibility and times of the squat with roll and pitch of the torso."""
    return [
        *_survival_claims(study),
        *_limit_claims(study),
        *_time_claims(study),
        *_conclusion_claims(study),
        *_reserve_claims(study),
    ]


def _survival_claims(study: Study) -> list[Claim]:
    found = {key: survival(study, study[Key(TILTING, *key)]) for key in methods()}
    bent = survival(study, study[Key(TILTING, "ik2", MANY, "bent")])
    gradients = survival(study, study[Key(TILTING, "ik2", MANY, "gradients")])
    few, many = found["ik5", FEW], found["ik5", MANY]
    return [
        Claim(
            "C_fail",
            "In asymmetric tasks ik1, ik2 and ik3 fail: they freeze or lead to falling",
            ", ".join(f"{m}: {found[m, MANY]}" for m in ("ik1", "ik2", "ik3")),
            not any(found[m, MANY].survives for m in ("ik1", "ik2", "ik3")),
            f"{FEASIBLE}. ik2 from bent knees: {bent}; ik2 by conjugate gradients: {gradients}",
            source="FI III-C, Fig. 3, IV",
            methods=("ik1", "ik2", "ik3"),
        ),
        Claim(
            "C_survive",
            f"ik5 (n = {MANY}) and ik4 survive the motion",
            f"ik4: {found['ik4', MANY]}, n = {FEW}: {found['ik4', FEW]}; ik5: {many}",
            found["ik4", MANY].survives and found["ik4", FEW].survives and many.survives,
            f"{FEASIBLE}. The paper says that only these survive: see C_fail and C_ik5_few",
            source="FI III-C, Fig. 3",
            methods=("ik4", "ik5"),
        ),
        Claim(
            "C_ik5_few",
            f"ik5 freezes with n = {FEW} iterations, while ik4 survives with few iterations",
            f"ik5: {few}, mean CoM error "
            f"{1e3 * mean_error(study[Key(TILTING, 'ik5', FEW)]):.1f} mm, with n = {MANY} "
            f"{1e3 * mean_error(study[Key(TILTING, 'ik5', MANY)]):.1f} mm",
            not few.survives and found["ik4", FEW].survives,
            OWN_IK5,
            source="FI III-C, Fig. 3",
            methods=("ik4", "ik5"),
        ),
    ]


def _limit_claims(study: Study) -> list[Claim]:
    knees = study.joint("KneeSag")
    excess = {
        f"{m}, {name}": limit_excess_deg(study[Key(gait, m)], study.robot, knees)
        for m in ("ik1", "ik2")
        for name, gait in (("B", STRETCHED), ("C", TILTING))
    }
    symmetric = survival(study, study[Key(STRETCHED, "ik3")])
    asymmetric = survival(study, study[Key(TILTING, "ik3")])
    return [
        Claim(
            "C_limits",
            "ik1 and ik2 produce infeasible knee angles here, unlike in the symmetric case",
            ", ".join(f"{name} {max(0.0, value):.0f} deg" for name, value in excess.items()),
            all((value > 0.5) == name.endswith("C") for name, value in excess.items()),
            "violation of the knee limits",
            excess,
            "FI III-C, Fig. 3",
            ("ik1", "ik2"),
        ),
        Claim(
            "C_ik3",
            "ik3 handles the symmetric singularity within its limits, but not the asymmetric one",
            f"B: {symmetric}; C: {asymmetric}",
            symmetric.survives and not asymmetric.survives,
            f"{FEASIBLE}. At {report_of(study[Key(TILTING, 'ik3')]).elastic_samples} samples of "
            "task C its only quadratic program is infeasible",
            source="FI III-C",
            methods=("ik3",),
        ),
    ]


def _time_claims(study: Study) -> list[Claim]:
    times = {key: mean_seconds(study[Key(TILTING, *key)]) for key in methods()}
    easy = {key: mean_seconds(study[Key(SQUAT, *key, "fine")]) for key in methods()}
    many = {m: times[m, MANY] for m in ALL}
    labels = ", ".join(f"{m} {1e6 * t:.0f}" for m, t in many.items())
    same = times["ik5", MANY] / times["ik4", MANY]
    ratios = {
        "A": easy["ik5", MANY] / easy["ik4", MANY],
        "B": mean_seconds(study[Key(STRETCHED, "ik5")])
        / mean_seconds(study[Key(STRETCHED, "ik4")]),
    }
    return [
        Claim(
            "C_cost",
            "ik4 and ik5 cost more computation time (n = 15), but guarantee a feasible motion",
            f"{labels} us",
            min(many["ik4"], many["ik5"]) >= FASTER * max(many[m] for m in ("ik1", "ik2", "ik3"))
            and all(survival(study, study[Key(TILTING, m)]).survives for m in ("ik4", "ik5")),
            "median CPU time of a solve, compared with ik1, ik2 and ik3; ik2 uses all of its "
            "iterations here, because damped steps shrink slowly",
            {m: 1e6 * t for m, t in many.items()},
            "FI III-C",
            ALL,
        ),
        Claim(
            "C_ik5_faster",
            "ik5 is generally faster than ik4, but behaves similarly",
            f"time of ik5 / time of ik4: task A {ratios['A']:.2f}, task B {ratios['B']:.2f}",
            max(ratios.values()) * FASTER <= 1.0,
            "median CPU time of a solve, n = 15. In our solver the second slack variable adds "
            "rows, and the damping R slows the iterations of ik5 more than those of ik4; in SNOPT "
            "it decouples two nonlinear equations",
            ratios,
            "FI II-E, IV",
            ("ik4", "ik5"),
        ),
        Claim(
            "C_ik5_same",
            "Over asymmetric tasks ik5 requires the same computation times as ik4",
            f"{same:.2f} times",
            1.0 / FASTER <= same <= FASTER,
            "median CPU time of a solve, task C, n = 15, within 10 %",
            {"ratio": same},
            "FI IV",
            ("ik4", "ik5"),
        ),
    ]


def _conclusion_claims(study: Study) -> list[Claim]:
    errors = {key: mean_error(study[Key(TILTING, *key)]) for key in methods()}
    few = {m: errors[m, FEW] / errors[m, MANY] for m in ("ik4", "ik5")}
    alike = errors["ik5", MANY] / errors["ik4", MANY]
    best = min(error for key, error in errors.items() if key[0] != "ik4")
    return [
        Claim(
            "C_ik5_sensitive",
            "Over asymmetric tasks ik5 is more sensitive to the number of iterations than ik4",
            ", ".join(f"{m} {value:.2f} times" for m, value in few.items()),
            few["ik5"] >= FASTER * few["ik4"],
            f"mean CoM error with n = {FEW} divided by that with n = {MANY}. {OWN_IK5}",
            few,
            "FI IV",
            ("ik4", "ik5"),
        ),
        Claim(
            "C_alike",
            "The behaviour of ik5 is the same as that of ik4",
            f"mean CoM error of ik5 / that of ik4: {alike:.2f}",
            1.0 / CONSIDERABLE <= alike <= CONSIDERABLE,
            "task C, n = 15, within 10 %",
            {"ratio": alike},
            "FI II-E",
            ("ik4", "ik5"),
        ),
        Claim(
            "C_best",
            "ik4 outperforms all other methods, even with fewer iterations",
            ", ".join(f"{m} (n = {n}) {1e3 * e:.1f}" for (m, n), e in errors.items()) + " mm",
            FASTER * max(errors["ik4", MANY], errors["ik4", FEW]) <= best,
            "mean CoM error, task C. ik1 and ik2 are nearer to the reference because they violate "
            "joint limits (C_limits), and ik5 behaves as ik4 does",
            {f"{m}, n = {n}": error for (m, n), error in errors.items()},
            "FI IV",
            ALL,
        ),
    ]


def _reserve_claims(study: Study) -> list[Claim]:
    found = {}
    for dt in ("10", "5", "2"):
        for more in ("", ", reserve"):
            variant = "" if dt == "10" else f"{dt} ms{more}"
            run = study[Key(TILTING, "ik4", MANY, variant)]
            found[f"{dt} ms{more}"] = (horizontal_error(run), hard_error(run))
    held = [v for name, v in found.items() if "reserve" in name]
    bare = [v for name, v in found.items() if "reserve" not in name]

    def met(values: list[tuple[float, float]]) -> bool:
        return bool(np.all(np.array(values) <= [NOT_ALTERED, HARD]))

    figure = ", ".join(
        f"{name}: CoM {1e3 * a:.1f} mm, hard rows {1e3 * b:.1g} mm"
        for name, (a, b) in found.items()
    )
    return [
        Claim(
            "C_dt_paper",
            "ik4 as the paper prints it holds in task C at dt 10, 5 and 2 ms",
            figure,
            met(bare),
            "horizontal CoM within 5 mm, hard rows within 0.1 mm. At its limit a knee leaves the "
            "safety region slowly; ik4 looks one sample ahead and stretches both knees, after "
            "which no step inside the region follows the roll of the torso. At 10 ms gamma dt = "
            "0.1 s looks far enough ahead, at 2 ms it does not",
            kind="ours",
            methods=("ik4",),
        ),
        Claim(
            "C_dt_reserve",
            "With the reserve of mgs (knees that bend ahead of such a sample) ik4 holds in task C "
            "at dt 10, 5 and 2 ms",
            figure,
            met(held),
            "see ik.faraji.reserve; without a missed sample the reserve changes nothing",
            kind="ours",
            methods=("ik4",),
        ),
    ]
