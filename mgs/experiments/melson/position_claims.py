"""Claims on the position peaks of the left leg: figures 3, 4 and 5 of the article."""

from __future__ import annotations

from mgs.core.contact import Side, Support
from mgs.experiments.claim import Claim
from mgs.experiments.melson.runs import Study, Walk, peak, peak_time
from mgs.experiments.melson.text import below, show, show_below
from mgs.experiments.melson.thresholds import SIGNIFICANT

SENTENCES = {
    "hip_roll": ("position peaks of the hip about x have increased in scenario 3", "Fig. 3"),
    "knee_pitch": ("the position peak of the knee has slightly increased in scenario 3", "Fig. 4"),
    "ankle_roll": ("the position peak of the ankle about x is lower in scenario 3", "Fig. 5"),
}


def position_claims(study: Study) -> dict[str, Claim]:
    """Claims by joint."""
    return {joint: _claim(study, joint) for joint in SENTENCES}


def is_so(joint: str, values: dict[str, float]) -> bool:
    """Whether position peaks of the scenarios are as the article says of a joint."""
    change = below(values)
    if joint == "ankle_roll":
        return all(part > 0.0 for part in change.values())
    rises = all(part < 0.0 for part in change.values())
    return rises and (joint == "hip_roll" or min(change.values()) > -SIGNIFICANT)


def _claim(study: Study, joint: str) -> Claim:
    values = {name: _peak(walk, joint) for name, walk in study.short.items()}
    inside = {name: _peak(walk, joint, inside=True) for name, walk in study.short.items()}
    sentence, figure = SENTENCES[joint]
    note = f"largest magnitude over the whole motion, as the figure shows it: {show_below(values)}"
    if joint == "knee_pitch":
        note += f"; slightly: by less than {100 * SIGNIFICANT:.0f} %"
    told = [
        f"{name} at {peak_time(walk, walk.angles[:, walk.column(Side.LEFT, joint)])}"
        for name, walk in study.short.items()
    ]
    note += f". Peaks: {'; '.join(told)}"
    note += f". Left single support alone: {show(inside, 'deg', 2)}, {show_below(inside)}"
    return Claim(
        f"left_{joint}_position_peak",
        f"{sentence} (left leg)",
        show(values, "deg", 2),
        is_so(joint, values),
        note,
        values,
        f"Section 5, {figure}",
        ("S1", "S2", "S3"),
    )


def _peak(walk: Walk, joint: str, *, inside: bool = False) -> float:
    """Position peak [deg] of a joint of the left leg, on request in left single support only."""
    angle = walk.angles[:, walk.column(Side.LEFT, joint)]
    return peak(angle[walk.stages.tasks.support == Support.LEFT] if inside else angle)
