"""Claims on gravity torques: figures 3 and 4 of the article, and its conclusion."""

from __future__ import annotations

import numpy as np

from mgs.core.contact import Side
from mgs.experiments.claim import Claim
from mgs.experiments.melson.runs import (
    SHORT,
    Study,
    Walks,
    peak,
    peak_time,
    rms,
    support_costs,
)
from mgs.experiments.melson.text import below, show, show_below
from mgs.experiments.melson.thresholds import SIGNIFICANT

ALL = ("S1", "S2", "S3")
WHOLE = (
    "largest magnitude over the whole motion, by inverse dynamics of the whole robot, with the "
    "weight shared between the soles as the ZMP demands in double support"
)


def leg_claims(study: Study) -> list[Claim]:
    """Claims on hip and knee of the left leg, which the article plots."""
    return [
        _leg_claim(study, Side.LEFT, "hip_roll", "peak"),
        _leg_claim(study, Side.LEFT, "hip_roll", "rms"),
        _whole_claim(study, "hip_roll"),
        _leg_claim(study, Side.LEFT, "knee_pitch", "peak"),
        _whole_claim(study, "knee_pitch"),
    ]


def _words(joint: str) -> tuple[str, str, float]:
    """What the article says about a joint, where, and the reduction that this means."""
    if joint == "hip_roll":
        return (
            "for the hip about x, torque has been significantly reduced in scenario 3",
            "Section 5, Fig. 3",
            SIGNIFICANT,
        )
    return "for the knee, peak torque has been reduced in scenario 3", "Section 5, Fig. 4", 0.0


def _reduced(values: dict[str, float], least: float) -> bool:
    """Whether S3 is below S1 and S2, by `least` at least."""
    worst = min(below(values).values())
    return bool(worst >= least if least else worst > 0.0)


def _leg_claim(study: Study, side: Side, joint: str, kind: str) -> Claim:
    words, source, least = _words(joint)
    series = {name: walk.support_torque(side, joint) for name, walk in study.short.items()}
    values = {name: (peak if kind == "peak" else rms)(x) for name, x in series.items()}
    measure = "largest magnitude" if kind == "peak" else "root mean square"
    note = f"{measure} in {side.label} single support: {show_below(values)}"
    note += f"; {100 * least:.0f} % needed" if least else ""
    if kind == "peak" and np.abs(series["S3"]).argmax() == 0:
        note += (
            ". The peak of S3 is at the first sample of single support, when the gain gamma_grav "
            "is still near zero and the posture results from the double support before"
        )
    return Claim(
        f"{side.label}_{joint}_{kind}_torque",
        f"{words} ({'peak' if kind == 'peak' else 'RMS'}, {side.label} leg)",
        show(values, "N m"),
        _reduced(values, least),
        note,
        values,
        source,
        ALL,
    )


def _whole_claim(study: Study, joint: str) -> Claim:
    words, source, least = _words(joint)
    torques = {
        name: walk.stages.motion.torque[:, walk.column(Side.LEFT, joint)]
        for name, walk in study.short.items()
    }
    values = {name: peak(torque) for name, torque in torques.items()}
    note = f"{WHOLE}: {show_below(values)}"
    note += f"; {100 * least:.0f} % needed" if least else ""
    note += f". The peak of S3 is at {peak_time(study.short['S3'], torques['S3'])}"
    return Claim(
        f"left_{joint}_whole_torque",
        f"{words} (peak over the whole motion, left leg)",
        show(values, "N m"),
        _reduced(values, least),
        note,
        values,
        source,
        ALL,
    )


def conclusion_claims(study: Study) -> list[Claim]:
    """Claims on the conclusion that the method reduces torques during single support phases."""
    return [
        _cost_claim(study),
        _every_support(study, "hip_roll"),
        _every_support(study, "knee_pitch"),
    ]


def _cost_claim(study: Study) -> Claim:
    costs = {n: {name: support_costs(w) for name, w in walks.items()} for n, walks in _both(study)}
    lower = [
        all(below(dict(zip(ALL, column, strict=True)))[name] > 0.0 for name in ("S1", "S2"))
        for by_name in costs.values()
        for column in zip(*(by_name[name] for name in ALL), strict=True)
    ]
    means = {name: float(np.mean(costs[SHORT][name])) for name in ALL}
    return Claim(
        "single_support_cost",
        "the method permits to reduce gravity-related joint torques during single support phases "
        "(cost H_grav)",
        f"lower in {sum(lower)} of {len(lower)} phases; two steps: {show(means, '(N m)^2')}",
        all(lower),
        "mean of H_grav with W = 1 over all joints, S3 against S1 and S2, in each single support "
        f"phase of the walks of two and of eight steps; two steps: {show_below(means)}",
        means,
        "Sections 4.2 and 6",
        ALL,
    )


def _both(study: Study) -> list[tuple[int, Walks]]:
    return [(len(walks["S1"].supports), walks) for walks in (study.short, study.longer)]


def _every_support(study: Study, joint: str) -> Claim:
    """Peak torque of the support leg in every single support: lower in S3."""
    rows = []
    for _, walks in _both(study):
        for phase, (side, samples) in enumerate(walks["S1"].supports):
            peaks = {n: peak(w.gravity[samples, w.column(side, joint)]) for n, w in walks.items()}
            rows.append((f"{side.label} {phase + 1}/{len(walks['S1'].supports)}", peaks))
    lower = [_reduced(peaks, 0.0) for _, peaks in rows]
    changes = [f"{name} {-100.0 * min(below(p).values()):+.1f}" for name, p in rows]
    words = joint.replace("_", " ")
    return Claim(
        f"{joint}_every_support",
        "the method permits to reduce gravity-related joint torques during single support phases "
        f"(peak of the {words} of the support leg, both legs, in every phase)",
        f"lower in {sum(lower)} of {len(lower)} phases",
        all(lower),
        f"walks of two and of eight steps; change [%] against the lower one of S1 and S2, by "
        f"support side and number of the phase: {', '.join(changes)}. H_grav is the sum over all "
        "joints, so that the torque of a single joint may rise",
        dict(zip([name for name, _ in rows], [-min(below(p).values()) for _, p in rows],
                 strict=True)),
        "Section 6",
        ALL,
    )  # fmt: skip
