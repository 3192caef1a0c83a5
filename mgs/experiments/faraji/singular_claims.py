"""Claims of task B: squat above reach, FI III-B and figure 2; dt 0.01 s."""

from __future__ import annotations

from mgs.experiments.claim import Claim
from mgs.experiments.faraji.measures import (
    escape_delay,
    height_error,
    mean_iterations,
    peak_speed,
    reversals,
)
from mgs.experiments.faraji.runs import BOUNDED, FEW, MANY, STRETCHED, Key, Study, methods
from mgs.experiments.faraji.squat_claims import ALL, ONE_QP
from mgs.experiments.faraji.thresholds import CONSIDERABLE, FASTER, VIBRATION

SPEED_MAX = 4.0  # [rad/s] largest joint speed of Table I
DELAY = "delay of the knee at 15 deg relative to the reference; slower means by 10 % at least"


def singular_claims(study: Study) -> list[Claim]:
    """Claims on approach, escape and iterations of the squat above reach."""
    return [
        _vibration_claim(study),
        *_escape_claims(study),
        *_speed_claims(study),
        *_iteration_claims(study),
    ]


def _vibration_claim(study: Study) -> Claim:
    turns = {m: reversals(study, study[Key(STRETCHED, m)]) for m in ALL}
    return Claim(
        "B_vibration",
        "All methods go to the singular posture without vibration and come out of it",
        ", ".join(f"{m} {value:.1f}" for m, value in turns.items()),
        max(turns.values()) <= VIBRATION,
        "reversals of the knee per period, less the two of a smooth squat; at most one in two "
        "periods. The caption of figure 2 excepts ik3, the text of III-B does not",
        turns,
        "FI III-B, Fig. 2",
        ALL,
    )


def _escape_claims(study: Study) -> list[Claim]:
    delays = {m: escape_delay(study, study[Key(STRETCHED, m)]) for m in ALL}
    text = (
        "The integrating methods ik1 and ik3 leave the singular posture slower, the direct methods "
        "ik2, ik4 and ik5 faster"
    )
    claims = []
    for name, variant, note in (
        ("B_escape", "", "ik2 by damped Gauss-Newton steps from the last solution"),
        ("B_escape_bent", "bent", "ik2 starts its iterations from bent knees, as ik4 and ik5 do"),
        ("B_escape_gradients", "gradients", "ik2 by conjugate gradients, from the last solution"),
    ):
        found = {**delays, "ik2": escape_delay(study, study[Key(STRETCHED, "ik2", MANY, variant)])}
        slow, fast = [found[m] for m in ("ik1", "ik3")], [found[m] for m in ("ik2", "ik4", "ik5")]
        claims.append(
            Claim(
                name,
                text,
                _milliseconds(found),
                min(slow) >= FASTER * max(fast),
                f"{DELAY}. {note}",
                found,
                "FI III-B, Fig. 2; FI-abstract 3" if variant == "bent" else "FI III-B, Fig. 2",
                ALL,
            )
        )
    stuck = {m: delays[m] for m in ("ik1", "ik2", "ik3")}
    claims.append(
        Claim(
            "B_frozen",
            "Integration of velocities from damped least squares gives almost frozen knees, so "
            "that the escape is delayed or impossible",
            _milliseconds(stuck),
            min(delays["ik1"], delays["ik3"]) >= FASTER * delays["ik4"],
            f"{DELAY}; compared with ik4, {1e3 * delays['ik4']:.0f} ms",
            stuck,
            "FI-abstract 2, FI I, FI IV",
            ("ik1", "ik3"),
        )
    )
    return claims


def _milliseconds(delays: dict[str, float]) -> str:
    return ", ".join(f"{m} {1e3 * delay:.0f} ms" for m, delay in delays.items())


def _speed_claims(study: Study) -> list[Claim]:
    peaks = {m: peak_speed(study[Key(STRETCHED, m)]) for m in ALL}
    figure = ", ".join(f"{m} {peak:.2f}" for m, peak in peaks.items()) + " rad/s"
    return [
        Claim(
            "B_infeasible",
            "The motion of ik1 exceeds qdot_max, since no bound is imposed",
            f"{peaks['ik1']:.2f} rad/s of {SPEED_MAX:g} rad/s",
            peaks["ik1"] > SPEED_MAX,
            f"ik3 to ik5: at most {max(peaks[m] for m in BOUNDED):.2f} rad/s",
            {"ik1": peaks["ik1"]},
            "FI III-B",
            ("ik1",),
        ),
        Claim(
            "B_catch_up",
            "ik1 and ik3 need large, often infeasible velocities afterwards to catch up",
            figure,
            min(peaks["ik1"], peaks["ik3"]) >= FASTER * max(peaks["ik4"], peaks["ik5"]),
            "largest joint speed, compared with ik4 and ik5. The safety region bounds ik3 to "
            "qdot_max, and ik4 and ik5 use all of qdot_max too",
            peaks,
            "FI Fig. 2",
            ("ik1", "ik3", "ik4", "ik5"),
        ),
    ]


def _iteration_claims(study: Study) -> list[Claim]:
    errors = {key: height_error(study[Key(STRETCHED, *key)]) for key in methods()}
    few = {m: errors[m, FEW] / errors[m, MANY] for m in ("ik2", "ik4", "ik5")}
    gradients = [height_error(study[Key(STRETCHED, "ik2", n, "gradients")]) for n in (FEW, MANY)]
    figure = ", ".join(f"{m} {value:.2f} times" for m, value in few.items())
    delays = {n: escape_delay(study, study[Key(STRETCHED, "ik2", n)]) for n in (MANY, FEW)}
    counts = {m: mean_iterations(study[Key(STRETCHED, m)]) for m in ("ik4", "ik5")}
    note = f"mean height error with n = {FEW} divided by that with n = {MANY}"
    return [
        Claim(
            "B_extra",
            "ik4 and ik5 are less sensitive to the number of iterations; extra iterations do not "
            "improve the precision considerably",
            figure,
            max(few["ik4"], few["ik5"]) <= min(CONSIDERABLE, few["ik2"]),
            f"{note}; at most 10 %, and less than ik2",
            few,
            "FI III-B, Fig. 2",
            ("ik2", "ik4", "ik5"),
        ),
        Claim(
            "B_few",
            "With fewer iterations ik2 and ik3 are very sensitive, often introducing large delays",
            f"ik2: error {few['ik2']:.2f} times, delay {1e3 * delays[MANY]:.0f} ms with n = {MANY} "
            f"and {1e3 * delays[FEW]:.0f} ms with n = {FEW}",
            few["ik2"] >= FASTER and delays[FEW] >= FASTER * delays[MANY],
            f"{note}; by conjugate gradients {gradients[0] / gradients[1]:.2f} times. {ONE_QP}",
            {"error": few["ik2"], "many": delays[MANY], "few": delays[FEW]},
            "FI III-B, Fig. 2",
            ("ik2", "ik3"),
        ),
        Claim(
            "B_iterations",
            "ik4 requires more iterations than ik5 on average",
            f"ik4 {counts['ik4']:.2f}, ik5 {counts['ik5']:.2f} iterations",
            counts["ik4"] >= FASTER * counts["ik5"],
            f"mean number until a step is below 1e-7, at most {MANY}. In ik5 the damping R weighs "
            "(1 + gamma) times as much relative to the soft rows, which slows its iterations; the "
            "paper counts major iterations of SNOPT, whose steps are not damped by R",
            counts,
            "FI Fig. 2, II-E",
            ("ik4", "ik5"),
        ),
    ]
