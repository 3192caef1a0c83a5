"""Claims of task A: squat without singularity, FI III-A and figure 1; dt 0.002 s."""

from __future__ import annotations

from mgs.experiments.claim import Claim
from mgs.experiments.faraji.measures import mean_error, mean_seconds, ratio
from mgs.experiments.faraji.runs import FEW, MANY, SQUAT, Key, Study, methods
from mgs.experiments.faraji.thresholds import CONSIDERABLE, FASTER, FEW_MILLIMETRES, TWO_ORDERS

ALL = ("ik1", "ik2", "ik3", "ik4", "ik5")
ONE_QP = (
    "ik3 is one exact quadratic program per sample, so it has no number of iterations; in the "
    "paper its nonlinear inequality takes major iterations of SNOPT"
)
IK5_SLOW = (
    "ik5 with few iterations converges slowly: the weight of its soft rows relative to the damping "
    "R is (1 + gamma) times smaller than in ik4"
)


def squat_claims(study: Study) -> list[Claim]:
    """Claims on errors and times of the squat without singularity."""
    errors = {key: mean_error(study[Key(SQUAT, *key, "fine")]) for key in methods()}
    return [*_error_claims(study, errors), *_iteration_claims(study, errors), _time_claim(study)]


def _error_claims(study: Study, errors: dict[tuple[str, int], float]) -> list[Claim]:
    best = {n: max(errors[m, n] for m in ("ik4", "ik5")) for n in (MANY, FEW)}
    others = {
        n: min(errors["ik1", MANY], errors["ik2", n], errors["ik3", MANY]) for n in (MANY, FEW)
    }
    gains = {m: errors["ik1", MANY] / errors[m, MANY] for m in ("ik2", "ik4", "ik5")}
    gradients = mean_error(study[Key(SQUAT, "ik2", MANY, "fine, gradients")])
    millimetres = {f"{m}, n = {n}": 1e3 * error for (m, n), error in errors.items()}
    coarse = ", ".join(
        f"{m} {1e3 * mean_error(study[Key(SQUAT, m)]):.3g}" for m in ("ik1", "ik2", "ik4", "ik5")
    )
    return [
        Claim(
            "A_average",
            "On average, ik4 and ik5 are better than the other methods, even with fewer iterations",
            ", ".join(f"{label}: {error:.3g}" for label, error in millimetres.items()) + " mm",
            all(FASTER * best[n] <= others[n] for n in (MANY, FEW)),
            "mean CoM error; ik4 and ik5 with ik2 at the same n, and with ik1 and ik3",
            millimetres,
            "FI III-A",
            ALL,
        ),
        Claim(
            "A_orders",
            "ik2, ik4 and ik5 perform roughly 2 orders of magnitude better (than ik1)",
            ", ".join(f"{m} {gain:.0f} times" for m, gain in gains.items()),
            min(gains.values()) >= TWO_ORDERS,
            f"mean CoM error of ik1 divided by that of the method, n = {MANY}; at least 10^1.5. "
            f"ik2 by conjugate gradients: {ratio(errors['ik1', MANY], gradients):.2g} times. "
            f"Errors at dt 0.01: {coarse} mm",
            gains,
            "FI Fig. 1",
            ("ik1", "ik2", "ik4", "ik5"),
        ),
        Claim(
            "A_millimetres",
            "All methods provide convincing tracking down to few millimetres",
            f"at most {max(millimetres.values()):.2f} mm",
            max(errors.values()) <= FEW_MILLIMETRES,
            "mean CoM error of every method and n, at most 5 mm",
            {"worst": max(millimetres.values())},
            "FI Fig. 1",
            ALL,
        ),
    ]


def _iteration_claims(study: Study, errors: dict[tuple[str, int], float]) -> list[Claim]:
    few = {m: errors[m, FEW] / errors[m, MANY] for m in ("ik2", "ik4", "ik5")}
    gradients = [mean_error(study[Key(SQUAT, "ik2", n, "fine, gradients")]) for n in (FEW, MANY)]
    figure = ", ".join(f"{m} {value:.3g} times" for m, value in few.items())
    note = f"mean CoM error with n = {FEW} divided by that with n = {MANY}. {ONE_QP}"
    return [
        Claim(
            "A_sensitive",
            "ik2 and ik3 are more sensitive to the number of iterations than ik4 and ik5",
            figure,
            few["ik2"] >= FASTER * max(few["ik4"], few["ik5"]),
            f"{note}. ik2 by conjugate gradients: {1e3 * gradients[0]:.2g} mm with n = {FEW}, "
            f"{1e3 * gradients[1]:.1g} mm with n = {MANY}. {IK5_SLOW}",
            few,
            "FI III-A",
            ("ik2", "ik3", "ik4", "ik5"),
        ),
        Claim(
            "A_extra",
            "Extra iterations of ik4 and ik5 do not improve the error considerably",
            figure,
            max(few["ik4"], few["ik5"]) <= CONSIDERABLE,
            f"at most 10 %. {IK5_SLOW}",
            few,
            "FI III-A",
            ("ik4", "ik5"),
        ),
        Claim(
            "A_few",
            "With fewer iterations ik2 and ik3 perform worse, while ik4 slightly loses precision",
            figure,
            few["ik2"] >= FASTER and few["ik4"] <= CONSIDERABLE,
            f"{note}; tested for ik2 and ik4",
            few,
            "FI Fig. 1",
            ("ik2", "ik3", "ik4"),
        ),
    ]


def _time_claim(study: Study) -> Claim:
    times = {key: mean_seconds(study[Key(SQUAT, *key, "fine")]) for key in methods()}
    errors = {key: mean_error(study[Key(SQUAT, *key, "fine")]) for key in methods()}
    rest = [key for key in times if key[0] != "ik1"]
    first = ("ik1", MANY)
    fastest = FASTER * times[first] <= min(times[key] for key in rest)
    precise = errors[first] >= FASTER * max(errors[m, MANY] for m in ("ik2", "ik4", "ik5"))
    return Claim(
        "A_fastest",
        "The fastest method is ik1 in this simple test, but it is less precise",
        ", ".join(f"{m} (n = {n}) {1e6 * t:.0f}" for (m, n), t in times.items()) + " us",
        fastest and precise,
        "median CPU time of a solve, by 10 % at least; less precise than ik2, ik4 and ik5. Both "
        "ik1 and ik3 solve one problem per sample: ik1 its closed form in Python, ik3 a quadratic "
        "program in C, which take the same time",
        {f"{m}, n = {n}": 1e6 * t for (m, n), t in times.items()},
        "FI III-A, Fig. 1",
        ALL,
    )
