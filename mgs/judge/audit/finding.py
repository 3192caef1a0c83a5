"""A finding of the audit: what does not hold, from when to when, by how much, and where."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.spans import spans

MERGE_TIME = 0.1  # [s] spans with a shorter pause between them are one finding
KINDS = {
    "quaternion_order": "the base quaternion is read in the wrong order",
    "clock": "the clock of the file is not the one of its positions",
    "velocity": "stated velocities are not the derivative of the positions",
    "velocity_end": "the first or last stated velocity is not one of the motion",
    "angular_frame": "angular velocities are stated in another frame than the layout says",
    "link_point": "link velocities are stated for another point than the layout says",
    "jump": "a coordinate jumps between two samples",
    "jitter": "a coordinate trembles from sample to sample",
    "penetration": "a part of the robot is below the floor",
    "float": "nothing touches the floor, although the floor must bear the robot",
    "slip": "a sole that bears the robot moves along the floor",
    "joint_position": "a joint is outside its range",
    "joint_speed": "a joint is faster than its servo",
    "joint_torque": "a joint needs more torque than its servo has at this speed",
    "self_collision": "links touch that must not",
    "zmp": "the zero-moment point is outside the soles in contact",
}


@dataclass(frozen=True)
class Finding:
    """One defect of a motion."""

    kind: str  # a key of `KINDS`
    start: float  # [s]
    end: float  # [s] of the last sample of it
    time: float  # [s] of the worst sample
    amount: float  # there
    limit: float
    unit: str
    where: str  # joint, link or sole; empty: the whole robot

    def to_dict(self) -> dict[str, object]:
        """The finding as plain data."""
        return {**asdict(self), "text": KINDS[self.kind]}


def findings_where(
    kind: str,
    amount: Array,
    limit: float | Array,
    dt: float,
    unit: str,
    where: str | Callable[[int], str],
    bad: NDArray[np.bool_] | None = None,
    least_time: float = 0.0,
) -> list[Finding]:
    """One finding for each span of samples whose amount exceeds its limit.

    Args:
        kind: a key of `KINDS`.
        amount: (T,) the figures.
        limit: their limit, or (T,) limits.
        dt: sampling period [s].
        unit: of amount and limit.
        where: what is meant, or a function that tells it for the worst sample.
        bad: (T,) samples that count; None: those where the amount exceeds the limit.
        least_time: spans shorter than this are left out [s].
    """
    limits = np.broadcast_to(np.asarray(limit, dtype=float), amount.shape)
    bad = amount > limits if bad is None else bad
    if not bad.any():
        return []
    excess = np.where(bad, amount - limits, -np.inf)
    found = []
    for start, end in _merged(bad, round(MERGE_TIME / dt)):
        if np.count_nonzero(bad[start:end]) * dt < least_time - 1e-9:
            continue
        k = start + int(np.argmax(excess[start:end]))
        place = where(k) if callable(where) else where
        times = (start * dt, (end - 1) * dt, k * dt)
        found.append(Finding(kind, *times, float(amount[k]), float(limits[k]), unit, place))
    return found


def _merged(bad: NDArray[np.bool_], pause: int) -> list[tuple[int, int]]:
    """Spans of true samples (T,), those joined that at most `pause` samples separate."""
    merged: list[tuple[int, int]] = []
    for start, end in spans(bad):
        if not bad[start]:
            continue
        if merged and start - merged[-1][1] <= pause:
            merged[-1] = (merged[-1][0], end)
        else:
            merged.append((start, end))
    return merged


def annotation(finding: Finding, file: str) -> str:
    """A finding as a workflow command of GitHub Actions, which shows it beside the file."""
    title = f"mgs audit: {finding.kind}"
    return f"::error file={_property(file)},title={_property(title)}::{_data(sentence(finding))}"


def sentence(finding: Finding) -> str:
    """A finding in words: what, where, how much, when."""
    where = f" ({finding.where})" if finding.where else ""
    unit = f" {finding.unit}" if finding.unit else ""
    span = f"{finding.start:.2f} to {finding.end:.2f} s"
    return (
        f"{KINDS[finding.kind]}{where}: {finding.amount:.4g}{unit} at {finding.time:.2f} s, "
        f"limit {finding.limit:.4g}{unit}; {span}"
    )


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
