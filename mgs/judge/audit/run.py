"""The audit: all findings on one motion."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mgs.core.errors import ConfigError
from mgs.core.progress import Progress
from mgs.judge.audit.balance import judged_samples, zmp_findings
from mgs.judge.audit.body import body_along
from mgs.judge.audit.collisions import collision_findings
from mgs.judge.audit.contacts import Contacts, find_contacts
from mgs.judge.audit.finding import Finding
from mgs.judge.audit.given import GivenMotion, given_by
from mgs.judge.audit.ground import ground_findings
from mgs.judge.audit.joints import joint_findings
from mgs.judge.audit.orientation import order_findings
from mgs.judge.audit.smoothness import smoothness_findings
from mgs.judge.audit.velocities import velocity_findings
from mgs.motion import Motion
from mgs.motion_file import read_motion

LEAST_SAMPLES = 6  # the noise on five steps is the first that can be told
SHARES = ("left", "right", "double", "other", "none")


@dataclass(frozen=True)
class Audit:
    """All findings on one motion, in the order of time within each kind."""

    file: str
    findings: tuple[Finding, ...]
    contacts: dict[str, float]  # [s] with contact of which soles; `other`: of other parts too
    balance_judged: float  # [s] in which the ZMP had a support polygon to be in
    duration: float  # [s]

    @property
    def clean(self) -> bool:
        """Whether there is no finding."""
        return not self.findings

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of the findings, each once."""
        return tuple(dict.fromkeys(finding.kind for finding in self.findings))

    def to_dict(self) -> dict[str, object]:
        """The audit as plain data, in the shape that `mgs audit --json` prints."""
        return {
            "file": self.file,
            "verdict": "clean" if self.clean else "findings",
            "findings": [finding.to_dict() for finding in self.findings],
            "contacts": self.contacts,
            "balance_judged": self.balance_judged,
            "duration": self.duration,
        }


def audit(
    motion: GivenMotion | Motion | str | Path,
    progress: Progress | None = None,
    *,
    name: str = "",
) -> Audit:
    """Look for defects of a motion, whoever made it.

    Where the quaternions of the base are in the wrong order, this is the only finding: all others
    would follow from it.

    Args:
        motion: a motion as somebody gives it, a motion of mgs or the path of a motion file.
        progress: called with samples done and samples in all.
        name: of the file in the result and in messages; empty: that of the path.

    Raises:
        MotionFileError: the motion file is missing or damaged.
        ConfigError: the motion is too short, or has numbers that are not finite.
        TypeError: `motion` is of another type.
    """
    file = name or (str(motion) if isinstance(motion, str | Path) else "")
    given = motion if isinstance(motion, GivenMotion) else given_by(read_motion(motion))
    _check(given, file or "the motion")
    end = given.dt * (given.n_samples - 1)
    if wrong := order_findings(given):
        return Audit(file, tuple(wrong), {}, 0.0, end)
    body = body_along(given)
    contacts = find_contacts(given, body)
    found = [
        *velocity_findings(given, body),
        *smoothness_findings(given, body),
        *ground_findings(given, body, contacts),
        *joint_findings(given, body, contacts),
        *collision_findings(given, progress),
        *zmp_findings(given, body, contacts),
    ]
    judged = float(np.count_nonzero(judged_samples(contacts)) * given.dt)
    return Audit(file, tuple(found), _shares(contacts, given.dt), judged, end)


def _check(given: GivenMotion, source: str) -> None:
    if given.n_samples < LEAST_SAMPLES:
        raise ConfigError(
            source, f"has {given.n_samples} samples; an audit needs at least {LEAST_SAMPLES}"
        )
    if not np.isfinite(given.q).all():
        k = int(np.argwhere(~np.isfinite(given.q))[0, 0])
        raise ConfigError(source, f"its positions are not finite at t = {k * given.dt:.3f} s")


def _shares(contacts: Contacts, dt: float) -> dict[str, float]:
    """Time [s] in each state of contact."""
    left, right = contacts.soles.T
    other = contacts.others
    masks = (left & ~right, right & ~left, left & right, other, ~left & ~right & ~other)
    return {
        name: float(np.count_nonzero(mask) * dt) for name, mask in zip(SHARES, masks, strict=True)
    }
