"""The claims on every run: safety region, hard constraints and time of a solve."""

from __future__ import annotations

from mgs.experiments.claim import Claim
from mgs.experiments.faraji.runs import (
    BOUNDED,
    FEW,
    STRETCHED,
    Study,
    hard_error,
    region_excess,
    report_of,
)
from mgs.experiments.faraji.thresholds import HARD, REGION


def region_claim(study: Study) -> Claim:
    """Claim on joint limits and safety region, for all samples of all runs of ik3 to ik5."""
    found = {k: region_excess(study, run) for k, run in study.runs.items() if k.method in BOUNDED}
    worst = max(found.values())
    recovering = sum(report_of(study[k]).recovering_samples for k in found)
    return Claim(
        "region",
        "ik3 to ik5 keep joint limits and safety region at all samples of all runs, with a "
        "tolerance of 1e-9",
        f"{max(worst, 0.0):.1e} in {len(found)} runs",
        worst <= REGION and recovering == 0,
        "limits in rad, region by eq. (6)",
        {"worst": worst},
    )


def hard_claim(study: Study) -> Claim:
    """Claim on the hard rows of ik4; the note lists runs with infeasible QPs."""
    runs = {k: run for k, run in study.runs.items() if k.method == "ik4"}
    worst = max(runs, key=lambda k: hard_error(runs[k]))
    elastic = {
        f"{k.gait} {k.label} {k.variant}".strip(): report_of(run).elastic_samples
        for k, run in runs.items()
    }
    named = ", ".join(f"{name}: {count}" for name, count in elastic.items() if count)
    return Claim(
        "hard",
        "the hard-row errors of ik4 stay below 0.1 mm in all runs",
        f"{1e3 * hard_error(runs[worst]):.1e} mm ({worst.gait})",
        hard_error(runs[worst]) <= HARD,
        f"number of samples whose last QP was infeasible and solved elastically: {named or 'none'}",
    )


def time_claim(study: Study) -> Claim:
    """Mean time of a solve; the benchmarks measure it more precisely."""
    times = {
        run.stages.gait.ik.solver + f", n = {k.n}": 1e6 * run.seconds_per_solve
        for k, run in study.runs.items()
        if k.gait == STRETCHED and not k.variant
    }
    ik4 = times[f"ik4, n = {FEW}"]
    return Claim(
        "time",
        "ik4 with n = 3 needs about 2 ms per solve (C++, SNOPT, 1.7 GHz)",
        f"{ik4:.0f} us",
        "not applicable",
        "solver, language and machine differ from the paper; mean time per sample of task B [us]: "
        + ", ".join(f"{label}: {t:.0f}" for label, t in times.items()),
        times,
    )
