"""Repair of a motion: what it is to hold, the motion nearest to it that does, figures of both."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.errors import ConfigError, MgsError
from mgs.core.geometry import quat_xyzw_from_yaw
from mgs.core.progress import Progress
from mgs.core.short_repr import short_repr
from mgs.judge.audit import GivenMotion
from mgs.judge.audit.body import SMOOTHING_TIME, body_along
from mgs.judge.audit.contacts import find_contacts
from mgs.judge.audit.smoothness import noise
from mgs.motion.dynamics import place_on_soles
from mgs.robot import Robot, leg_length
from mgs.search.repair.band import smooth
from mgs.search.repair.constraints import Constraints
from mgs.search.repair.figures import Figures, figures_of, link_distance
from mgs.search.repair.ranges import bridged, clipped
from mgs.search.repair.solve import Point, Problem, solve
from mgs.search.repair.stances import Bools, Stances, planar_places, stances_of, standing_soles

LEAST_SAMPLES = 20
MOST_OFF = 0.1  # part of the time in which other parts than the soles may bear the robot
GOALS = {  # by the names of the figures, what a repaired motion has at most
    "penetration": 1e-3,
    "slip": 2e-3,
    "range_excess": 0.0,
    "speed_ratio": 1.0,
    "zmp_outside": 0.0,
}
NOISY = 5e-4  # [rad] and [m], noise from which a coordinate is smoothed
AWAY_FROM_PLACE = 5e-3  # [m]
CORRECTIONS = 4  # of the stances, by the contacts of what was found
BLUR = 0.15  # [s]
CUT_OFF = 5.0  # [Hz] above which a smoothed coordinate keeps less than half
# cut-off of the base where stances change [Hz], smoothness of joints [s^4]: near the given motion,
# and, if nothing is found so, smoother, as it takes where soles roll or land at speed
ATTEMPTS = ((5.0, 1e-5), (3.0, 1e-3))


@dataclass(frozen=True, eq=False)
class Repaired:
    """A motion that has been repaired, with figures of both."""

    motion: GivenMotion  # positions alone
    before: Figures
    after: Figures
    moved: float  # root mean square distance of all links from where they were [m]

    __repr__ = short_repr

    @property
    def left(self) -> tuple[str, ...]:
        """What does not hold yet, by the names of the figures."""
        after = vars(self.after)
        return tuple(name for name, limit in GOALS.items() if after[name] > limit)

    def to_dict(self) -> dict[str, object]:
        """The figures as plain data."""
        return {
            "before": self.before.to_dict(),
            "after": self.after.to_dict(),
            "goals": GOALS,
            "left": list(self.left),
            "moved": self.moved,
        }


def repair(given: GivenMotion, progress: Progress | None = None) -> Repaired:
    """The motion nearest to a given one that stands, walks and keeps its limits.

    Raises:
        ConfigError: the motion is too short.
        MgsError: it is not on its soles on a level floor, which is all that can be repaired.
    """
    if given.n_samples < LEAST_SAMPLES:
        raise ConfigError(
            "the motion", f"has {given.n_samples} samples; a repair needs {LEAST_SAMPLES}"
        )
    if given.scene.boxes:
        raise MgsError("the motion is on boxes; only motions on a level floor can be repaired")
    before = figures_of(given)
    if before.off_soles > MOST_OFF:
        raise MgsError(
            f"other parts than the soles bear the robot {100.0 * before.off_soles:.0f} % of the "
            "time; only motions on the soles can be repaired"
        )
    tried: list[Repaired] = []
    for cut_off, smoothness in ATTEMPTS:
        for calm in readings(given):
            for found in solutions(given, calm, cut_off, smoothness, progress):
                moved = link_distance(found, given)
                tried.append(Repaired(found, before, figures_of(found), moved))
                if not tried[-1].left:
                    break
        if not all(one.left for one in tried):
            break
    return min(tried, key=lambda one: (len(one.left), one.moved))


def readings(given: GivenMotion) -> list[GivenMotion]:
    """The motion without noise, read in two ways where joints were beyond their ranges."""
    found = [without_noise(given, clipped), without_noise(given, bridged)]
    return found[: 1 if np.array_equal(found[0].q, found[1].q) else 2]


def solutions(
    given: GivenMotion,
    calm: GivenMotion,
    cut_off: float,
    smoothness: float,
    progress: Progress | None = None,
) -> Iterator[GivenMotion]:
    """Repaired motions; after each one the stances are corrected by its contacts."""
    blur = BLUR if np.any(_noise(given) > NOISY) else 0.0
    body = body_along(calm, max(blur, SMOOTHING_TIME))
    stands = standing_soles(body, given.dt, leg_length(given.robot), blur)
    planar = planar_places(body.soles, body.turns)
    tried: list[Bools] = []
    while len(tried) <= CORRECTIONS and not any(np.array_equal(stands, t) for t in tried):
        tried.append(stands)
        stances = stances_of(stands, planar)
        reference = on_stances(calm, stances, cut_off)
        problem = Problem(Constraints(given.robot, stances, given.dt), reference, smoothness)
        point = solve(problem, reference.q, progress)
        yield point.given
        stands = corrected(stands, point)


def corrected(stands: Bools, point: Point) -> Bools:
    """Which soles (T, 2) stand, corrected by the motion that was found with them.

    One stands too that bears the robot in that motion. One does not that is far from its place
    there, since no motion near the given one has it stand, unless none else stands.
    """
    contacts = find_contacts(point.given, body_along(point.given))
    away = np.linalg.norm(point.residuals.pose, axis=-1) > AWAY_FROM_PLACE
    kept = stands & ~away
    kept[~kept.any(axis=1)] = stands[~kept.any(axis=1)]
    return np.asarray(kept | (contacts.bearing & ~away))


def smoothing_weight(dt: float, cut_off: float) -> float:
    """Weight of third differences that halves what is at `cut_off` [Hz]."""
    return float((2.0 * np.sin(np.pi * cut_off * dt)) ** -6.0)


def _noise(given: GivenMotion) -> Array:
    """Largest noise (7 + n,) of each coordinate over time."""
    return np.asarray(noise(np.diff(given.q, axis=0), given.dt).max(axis=0))


def without_noise(given: GivenMotion, reading: Callable[[Robot, Array], Array]) -> GivenMotion:
    """The motion with those coordinates smoothed that tremble, and its joints in their ranges."""
    q = given.q.copy()
    noisy = np.flatnonzero(_noise(given) > NOISY)
    if len(noisy):
        q[:, noisy] = smooth(q[:, noisy], smoothing_weight(given.dt, CUT_OFF))
        q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1, keepdims=True)
    q[:, 7:] = reading(given.robot, q[:, 7:])
    return dataclasses.replace(
        given, q=q, joint_velocity=None, base_linear=None, base_angular=None, links=None
    )


def on_stances(given: GivenMotion, stances: Stances, cut_off: float) -> GivenMotion:
    """The motion with its base where the soles that stand put it, smooth where they change."""
    soles = np.zeros((given.n_samples, 2, 7))
    soles[..., :2] = stances.places[..., :2]
    soles[..., 3:] = quat_xyzw_from_yaw(stances.places[..., 2])
    both = [place_on_soles(given.robot, given.joints, _root(given, side), soles) for side in Side]
    stands = stances.stands.astype(float)
    share = np.where(stands.any(axis=1), stands[:, 0] / np.maximum(stands.sum(axis=1), 1.0), np.nan)
    share = _filled(share)
    base = share[:, None] * both[0][:, :7] + (1.0 - share[:, None]) * _near(both[1], both[0])
    base = smooth(base, smoothing_weight(given.dt, cut_off))
    base[:, 3:] /= np.linalg.norm(base[:, 3:], axis=1, keepdims=True)
    q = given.q.copy()
    q[:, :7] = base
    return dataclasses.replace(given, q=q)


def _root(given: GivenMotion, side: Side) -> NDArray[np.int8]:
    return np.full(given.n_samples, side, dtype=np.int8)


def _near(q: Array, other: Array) -> Array:
    """Bases (T, 7) of q, their quaternions in the half space of those of `other`."""
    base = q[:, :7].copy()
    opposite = np.sum(base[:, 3:] * other[:, 3:7], axis=1) < 0.0
    base[opposite, 3:] *= -1.0
    return base


def _filled(values: Array) -> Array:
    known = np.flatnonzero(~np.isnan(values))
    if not len(known):
        return np.full_like(values, 0.5)
    return np.interp(np.arange(len(values)), known, values[known])
